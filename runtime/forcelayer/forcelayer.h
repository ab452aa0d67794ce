/* Forcelayer for C, and for everything that can call C: open two files, and call
 * forcelayer_step() once a period of your servo loop.
 *
 * Units are SI, frames right-handed. A pose is x y z (m) and a unit quaternion qw qx qy qz.
 * Functions that can fail return a handle or 0 for success, and else write a line that says what,
 * where and how to mend it into `error`. */
#ifndef FORCELAYER_H
#define FORCELAYER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct forcelayer_runtime forcelayer_runtime;

/* Begin with forcelayer_default_options(): a paper-like device of 15 N and 0.1 N m at 1 kHz. */
typedef struct forcelayer_options {
  double rate_hz;                  /* at which forcelayer_step() is called */
  double max_force_n;              /* rating of the device: never exceeded */
  double max_torque_nm;            /* the same */
  double max_stiffness_n_per_m;    /* rating; 0: not known */
  double max_stiffness_nm_per_rad; /* the same */
  double damping_ns_per_m;         /* physical damping of the device */
  double damping_nms_per_rad;      /* the same */
  double delay_s;                  /* from sensing to force */
  double workspace_radius_m;       /* about the device's origin; 0: unbounded */
  int senses_velocity;             /* 1: the readings hold velocities */
  double world_from_device[7];     /* where the device stands in the scene */
  double motion_scale;             /* scene metres a metre of the device */
  double stale_s;                  /* silence of device or caller that takes the output to zero */
  double max_speed_mps;            /* of the handle: faster trips the output */
  int without_guarantee;           /* 1: open also files that guarantee no separation */
} forcelayer_options;

typedef struct forcelayer_reading {
  double device_from_handle[7];
  double linear_mps[3];    /* of the handle's origin, device axes; where sensed */
  double angular_radps[3]; /* device axes; where sensed */
  uint32_t buttons;        /* bit n: button n */
  int fresh;               /* 1: a new reading since the last step */
  int present;             /* 1: the device answers */
  int calibrated;          /* 1: its poses can be trusted */
} forcelayer_reading;

enum { FORCELAYER_WAITING = 0, FORCELAYER_ARMED = 1, FORCELAYER_TRIPPED = 2 };

typedef struct forcelayer_result {
  double force_n[3];         /* for the motors: device axes */
  double torque_nm[3];       /* about the handle's origin, device axes */
  double world_from_part[7]; /* the part's frame is its mesh's */
  uint32_t output;           /* FORCELAYER_WAITING, ... */
  uint32_t contacts;         /* points with depth in the force layer */
  uint32_t interior;         /* points in the interior: the guarantee does not hold in this frame */
} forcelayer_result;

void forcelayer_default_options(forcelayer_options* options);

/* Maps and checks both files, every checksum too, and derives the physical parameters. NULL on
 * failure, and, as voxrun does, where the two files guarantee no separation (options). */
forcelayer_runtime* forcelayer_open(const char* scene, const char* part,
                                    const forcelayer_options* options, char* error,
                                    size_t error_bytes);

/* Registers the part, before the first step; again, to begin anew. The handle is where `first` has
 * it. `world_from_part` is the part's place in the scene, NULL: where the grip has it.
 * `handle_from_part` is the grip, NULL: whatever holds the part without stretch, and the identity
 * where no place is given either. With both, the handle pulls the part to where the grip has it,
 * and the output arms once the part is free of contact. What is wrong with the device trips it even
 * before, and then only the clutch, or beginning anew, arms it. (voxrun's --start and --grip; its
 * --world-from-device and --motion-scale are in the options.) 0 on success. */
int forcelayer_start(forcelayer_runtime* runtime, const double world_from_part[7],
                     const double handle_from_part[7], const forcelayer_reading* first, char* error,
                     size_t error_bytes);

/* One period, from the servo thread alone. Never blocks, allocates, locks or logs. 0 on success;
 * without forcelayer_start() the result is zero and the return is not 0. */
int forcelayer_step(forcelayer_runtime* runtime, const forcelayer_reading* reading,
                    forcelayer_result* result);

/* The clutch, from any thread. Pressed (1): the output fades to zero and the part stays where it
 * is. Released (0): the hand holds it anew, without stretch, and the output ramps in. Pressing and
 * releasing it is also how a tripped output is armed again. */
void forcelayer_set_clutch(forcelayer_runtime* runtime, int pressed);

/* Why the output tripped last, as text; "none". From the servo thread. */
const char* forcelayer_last_trip(const forcelayer_runtime* runtime);

/* Swaps scene and part while the loop runs, from one other thread than the servo's: loads both,
 * lets the output fade, registers the part as forcelayer_start() does (with both a place and a
 * grip, the place counts: it is gripped there without stretch) and ramps in. Returns when that is
 * done. Not 0: the files so far go on, and where the servo thread did not come within `timeout_s`,
 * the new ones follow when it does. */
int forcelayer_swap(forcelayer_runtime* runtime, const char* scene, const char* part,
                    const double world_from_part[7], const double handle_from_part[7],
                    double timeout_s, char* error, size_t error_bytes);

/* A baked file must not be written to while it is in use: bake into a new file, as the commands
 * do. Where one is cut short all the same, the kernel answers a read beyond its new end with
 * SIGBUS, and the process ends with a force on the hand. After this call a SIGBUS in a baked file
 * is answered instead: the step goes on, harmless, the output trips in it and stays at zero until
 * whole files are opened anew, or swapped in and armed by the clutch. Any other SIGBUS goes to
 * whoever handled it before. For the whole process; call it once, after handlers of your own are
 * in place. */
void forcelayer_contain_map_loss(void);

/* Asks the system whether the files in use still are as they were opened, and counts those that
 * are not; the next step of a runtime that uses one trips its output. So a file that is written to
 * in place is noticed too. From any thread but the servo's, best every few milliseconds; takes
 * microseconds and reads nothing of the files. */
int forcelayer_check_files(void);

/* After the last step. NULL is fine. */
void forcelayer_close(forcelayer_runtime* runtime);

#ifdef __cplusplus
}
#endif
#endif
