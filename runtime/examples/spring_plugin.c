/* A device plugin to begin with: a handle of 0.3 kg that a soft hand (400 N/m) moves up and down,
 * simulated where a real plugin calls its SDK. It needs one header and nothing else:
 *   cc -shared -fPIC spring_plugin.c -o spring_plugin.so -lm    (in the source tree: -I runtime)
 *   voxrun scene.vox part.pshell --device plugin:library=./spring_plugin.so
 * with ,args=depth=0.03 behind it for a hand that goes 30 mm down. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "forcelayer/plugin.h"

#define RATE_HZ 1000.0

struct device {
  double depth_m; /* how far the hand goes down */
  double time_s;
  double position_m[3], velocity_mps[3], force_n[3];
};

/* The SDK's "connect". Its ratings go into the handshake, converted to SI units. */
static int open_device(const char* arguments, forcelayer_plugin_info* info, void** out, char* error,
                       size_t error_bytes) {
  double depth_m = 0.03;
  if (arguments[0] != 0 && (sscanf(arguments, "depth=%lf", &depth_m) != 1 || !(depth_m >= 0))) {
    snprintf(error, error_bytes, "the argument is depth=METRES, not '%s'", arguments);
    return 1;
  }
  struct device* device = calloc(1, sizeof *device);
  if (device == NULL) {
    snprintf(error, error_bytes, "out of memory");
    return 1;
  }
  device->depth_m = depth_m;
  info->abi = FORCELAYER_PLUGIN_ABI;
  info->si_units = FORCELAYER_PLUGIN_SI_UNITS;
  info->right_handed = FORCELAYER_PLUGIN_RIGHT_HANDED;
  snprintf(info->name, sizeof info->name, "spring example");
  info->sensed_axes = 63;  /* all six */
  info->actuated_axes = 7; /* forces, no torques */
  info->senses_velocity = 1;
  info->rate_hz = RATE_HZ;
  info->max_force_n = 8;
  info->damping_ns_per_m = 2;
  info->delay_s = 0.001;
  info->workspace_radius_m = 0.2;
  info->watchdog_s = 0.02; /* this one dies with its process */
  *out = device;
  return 0;
}

/* The SDK's "get position", in meters and as a unit quaternion. */
static int read_device(void* opaque, forcelayer_plugin_reading* reading) {
  struct device* d = opaque;
  const double dt_s = 1 / RATE_HZ, mass_kg = 0.3, damping = 10, stiffness = 400;
  const double wanted_m[3] = {0, 0, -d->depth_m * 0.5 * (1 - cos(3.14159265 * d->time_s))};
  for (int axis = 0; axis < 3; ++axis) {
    const double pull_n = stiffness * (wanted_m[axis] - d->position_m[axis]);
    d->velocity_mps[axis] = (mass_kg * d->velocity_mps[axis] + dt_s * (pull_n + d->force_n[axis])) /
                            (mass_kg + dt_s * damping);
    d->position_m[axis] += dt_s * d->velocity_mps[axis];
  }
  d->time_s += dt_s;
  memset(reading, 0, sizeof *reading);
  memcpy(reading->position_m, d->position_m, sizeof d->position_m);
  memcpy(reading->linear_mps, d->velocity_mps, sizeof d->velocity_mps);
  reading->orientation_wxyz[0] = 1;
  reading->status = FORCELAYER_PLUGIN_CALIBRATED;
  return 1;
}

/* The SDK's "set force", in newtons. */
static int write_device(void* opaque, const forcelayer_plugin_wrench* wrench) {
  struct device* d = opaque;
  memcpy(d->force_n, wrench->force_n, sizeof d->force_n);
  return 0;
}

static void close_device(void* opaque) { free(opaque); }

const forcelayer_plugin* forcelayer_plugin_entry(uint32_t host_abi) {
  static const forcelayer_plugin plugin = {open_device, read_device, write_device, NULL,
                                           close_device};
  return host_abi == FORCELAYER_PLUGIN_ABI ? &plugin : NULL;
}
