/* A haptic device as a plugin: the C interface through which a vendor's SDK is attached to voxrun.
 *
 * A plugin is a shared library that exports forcelayer_plugin_entry(). voxrun loads it in a child
 * process of its own (voxrun-plugin), so that its crash cannot take the loop along, and exchanges
 * readings and wrenches with it through shared memory. How to attach an SDK: runtime/devices/plugin
 * in the source tree; a plugin to begin with: runtime/examples/spring_plugin.c.
 *
 * Everything is in SI units (meters, radians, seconds, newtons, newton meters) and right-handed
 * frames: the plugin converts what its SDK has, and says in its handshake that it did.
 * All functions are called on one thread of the child process. */
#ifndef FORCELAYER_PLUGIN_H
#define FORCELAYER_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define FORCELAYER_PLUGIN_ABI 1u
#define FORCELAYER_PLUGIN_SI_UNITS 0x5349u     /* "everything I give and take is in SI units" */
#define FORCELAYER_PLUGIN_RIGHT_HANDED 0x5248u /* "my frames are right-handed" */

/* The device's description: the handshake. Zeroed before open(), which fills it in. A field left
 * zero says "none" or "not known", and what must be known (abi, si_units, right_handed,
 * sensed_axes, rate_hz, limits of force and torque where axes are actuated) is refused as zero. */
typedef struct forcelayer_plugin_info {
  uint32_t abi;          /* FORCELAYER_PLUGIN_ABI that the plugin was built with */
  uint32_t si_units;     /* FORCELAYER_PLUGIN_SI_UNITS */
  uint32_t right_handed; /* FORCELAYER_PLUGIN_RIGHT_HANDED */
  uint32_t sensed_axes;  /* bits 0-5: x y z, rotation about x y z, device frame */
  uint32_t actuated_axes;
  uint32_t senses_velocity;        /* 1: linear_mps and angular_radps are filled in */
  char name[64];                   /* zero-terminated */
  double rate_hz;                  /* of readings; in pull mode also how often the host calls */
  double max_force_n;              /* rated, magnitude: never exceeded */
  double max_torque_nm;            /* the same */
  double max_stiffness_n_per_m;    /* rated; 0: not known */
  double max_stiffness_nm_per_rad; /* the same */
  double damping_ns_per_m;         /* physical, of the mechanics */
  double damping_nms_per_rad;      /* the same */
  double delay_s;                  /* from sensing to force */
  double workspace_radius_m;       /* about the device frame's origin; 0: unbounded */
  double watchdog_s;               /* the device's own: its motors go to zero when the driver is
                                      silent for so long, crash included; 0: it has none */
} forcelayer_plugin_info;

enum {
  FORCELAYER_PLUGIN_CALIBRATED = 1, /* poses can be trusted */
  FORCELAYER_PLUGIN_MOTORS_OFF = 2  /* the device keeps its motors at zero, whatever is written */
};

/* A reading: the handle's pose in the device's base frame. */
typedef struct forcelayer_plugin_reading {
  double position_m[3];
  double orientation_wxyz[4]; /* unit quaternion, device_from_handle */
  double linear_mps[3];       /* of the handle's origin, device axes; where sensed */
  double angular_radps[3];    /* device axes; where sensed */
  uint32_t buttons;           /* bit n: button n */
  uint32_t status;            /* FORCELAYER_PLUGIN_* bits */
} forcelayer_plugin_reading;

/* The wrench that the hand shall feel: about the handle's origin, device axes. */
typedef struct forcelayer_plugin_wrench {
  double force_n[3];
  double torque_nm[3];
} forcelayer_plugin_wrench;

/* For push mode: hands over a reading and takes the wrench for the motors. Never blocks. Not 0: end
 * run() soon; the wrench is zero from then on. `reading` NULL: the device is lost. */
typedef struct forcelayer_plugin_host {
  void* context;
  int (*exchange)(void* context, const forcelayer_plugin_reading* reading,
                  forcelayer_plugin_wrench* wrench);
} forcelayer_plugin_host;

typedef struct forcelayer_plugin {
  /* Connects. `arguments` is what the user gave with args= of --device, never NULL. 0, and *device
   * for the other calls; else not 0 and a line in `error` that says what is wrong. */
  int (*open)(const char* arguments, forcelayer_plugin_info* info, void** device, char* error,
              size_t error_bytes);

  /* Pull mode, both or none, `rate_hz` times a second. read: 1 and a new reading; 0, none;
   * negative, the device is lost. write: 0; negative, the device is lost. Neither may block for
   * long. */
  int (*read)(void* device, forcelayer_plugin_reading* reading);
  int (*write)(void* device, const forcelayer_plugin_wrench* wrench);

  /* Push mode, instead of the two, for SDKs that own the servo thread: start it, call
   * host->exchange() once a servo tick, and return once that says so. Where it is given, the two
   * are not called. */
  int (*run)(void* device, const forcelayer_plugin_host* host);

  /* The motors to zero, and disconnects. */
  void (*close)(void* device);
} forcelayer_plugin;

/* The one exported function. `host_abi` is the version that the host speaks; NULL where the plugin
 * cannot. The result lives as long as the library. */
const forcelayer_plugin* forcelayer_plugin_entry(uint32_t host_abi);
typedef const forcelayer_plugin* (*forcelayer_plugin_entry_function)(uint32_t host_abi);

#ifdef __cplusplus
}
#endif
#endif
