/* Forcelayer for C, and for every language that can call C.
 *
 *   forcelayer_options options;
 *   forcelayer_default_options(&options);
 *   forcelayer_runtime* run = forcelayer_open("scene.vox", "part.pshell", &options, error, size);
 *   forcelayer_start(run, NULL, NULL, &reading, error, size);
 *   once a period, on the servo thread:
 *     forcelayer_step(run, &reading, &result);     give result.force_n to the motors
 *   forcelayer_close(run);
 *
 * Units are SI, frames right-handed. A pose is x y z (m) and a unit quaternion qw qx qy qz.
 * Pointers must not be NULL unless it says so. A function that fails writes one line into `error`
 * (NULL: nowhere), at most `error_bytes` with the final zero: where, what is wrong and how to mend
 * it. */
#ifndef FORCELAYER_H
#define FORCELAYER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#ifdef __GNUC__
#pragma GCC visibility push(default) /* all that libforcelayer.so exports */
#endif

typedef struct forcelayer_runtime forcelayer_runtime;

/* Which dynamic model moves the part. */
enum {
  FORCELAYER_MODEL_DEFAULT = 0, /* implicit, guarded, at rest when the hand rests */
  FORCELAYER_MODEL_PAPER = 1    /* the method of 1999 to the letter: a yardstick, without a guard */
};

/* Begin with forcelayer_default_options(): the default model and a device of 15 N and 0.1 N m at
 * 1 kHz. */
typedef struct forcelayer_options {
  int model;                       /* FORCELAYER_MODEL_DEFAULT, ... */
  double rate_hz;                  /* at which forcelayer_step() is called */
  double max_force_n;              /* rating of the device: never exceeded; 0: no motors */
  double max_torque_nm;            /* the same for torque */
  double max_stiffness_n_per_m;    /* rating; 0: not known */
  double max_stiffness_nm_per_rad; /* the same for rotation */
  double damping_ns_per_m;         /* physical damping of the device */
  double damping_nms_per_rad;      /* the same for rotation */
  double delay_s;                  /* from sensing to force, beside the period */
  double workspace_radius_m;       /* about the device's origin; 0: unbounded */
  int senses_velocity;             /* 1: the readings hold velocities; 0: they are estimated */
  double world_from_device[7];     /* where the device stands in the scene */
  double motion_scale;             /* scene meters a meter of the device */
  double stale_s;                  /* silence of device or caller that trips the output; of the
                                    * device's never more than 0.05 */
  double max_speed_mps;            /* of the handle at the device: faster trips the output; to 10 */
  double max_turn_radps;           /* the same for its rotation; to 100 */
  int without_guarantee;           /* 1: open also files without a guarantee of separation */
  const char* expected_sha256;     /* SHA-256 of the files that may be opened, 64 hexadecimal digits
                                    * each, with commas between them: scene and part must both be
                                    * among them. NULL: any file */
} forcelayer_options;

/* One reading of the device. */
typedef struct forcelayer_reading {
  double device_from_handle[7];
  double linear_mps[3];    /* of the handle's origin, device axes; where sensed */
  double angular_radps[3]; /* device axes; where sensed */
  uint32_t buttons;        /* bit n: button n; none has an effect: forcelayer_set_clutch() */
  int fresh;               /* 1: a new reading since the last step */
  int present;             /* 1: the device answers */
  int calibrated;          /* 1: its poses can be trusted */
} forcelayer_reading;

/* States of the output. */
enum {
  FORCELAYER_WAITING = 0, /* zero: not armed yet */
  FORCELAYER_ARMED = 1,   /* ramping in, or in full */
  FORCELAYER_TRIPPED = 2  /* zero until the clutch is pressed and released */
};

/* How the clearance, the distance between the surfaces of part and scene, is known. */
enum {
  FORCELAYER_CLEARANCE_NONE = 0,     /* nothing */
  FORCELAYER_CLEARANCE_AT_LEAST = 1, /* no point is near enough to the scene to be measured */
  FORCELAYER_CLEARANCE_PROVEN = 2    /* measured, by the stored distances */
};

/* The outcome of one period. */
typedef struct forcelayer_result {
  double force_n[3];         /* for the motors: device axes */
  double torque_nm[3];       /* about the handle's origin, device axes */
  double world_from_part[7]; /* the part's frame is its mesh's */
  uint32_t output;           /* FORCELAYER_WAITING, ... */
  uint32_t contacts;         /* points with depth in the force layer */
  uint32_t interior;         /* points in the interior. 0 is not yet a guarantee: there are other
                              * premises (forcelayer_last_state()) */
  uint32_t clearance;        /* FORCELAYER_CLEARANCE_NONE, ... */
  uint32_t nearest_object;   /* number of the nearest object; 0: not known */
  double clearance_m;        /* a lower bound; 0 where nothing is known */
} forcelayer_result;

/* Bits of forcelayer_state.faults. The part stays where it was, and the output is zero. */
enum {
  FORCELAYER_FAULT_INVALID_INPUT = 1,    /* no reading that could be used */
  FORCELAYER_FAULT_NON_FINITE_INPUT = 2, /* an invalid pose */
  FORCELAYER_FAULT_NON_FINITE_STATE = 4  /* the motion overflowed */
};

/* The guarantee in the last step, and why it does not hold. Later versions may append fields. */
typedef struct forcelayer_state {
  double guaranteed_m;  /* the exact surfaces of part and scene were at least so far apart; 0:
                         * nothing is guaranteed in this step. Where clutch or fault hold the part,
                         * of the place where they hold it */
  uint32_t outside_map; /* 1: a point lay beyond a side at which the scene was cropped */
  uint32_t barred;      /* points nearer than the guard allows */
  uint32_t seat_open;   /* 1: the part has not left its seat: it may touch the objects there */
  uint32_t seated;      /* points nearer to those than is allowed elsewhere */
  uint32_t faults;      /* FORCELAYER_FAULT_... bits */
  uint32_t tested;      /* 0: clutch or fault held the part, and all counts are 0 */
} forcelayer_state;

/* Fills all options. */
void forcelayer_default_options(forcelayer_options* options);

/* Maps both files, checks them, every checksum and all that the step trusts too, and derives the
 * physical parameters. NULL on failure: an unusable file, an option out of its range, or two files
 * without a guarantee of separation (unless the options allow that). */
forcelayer_runtime* forcelayer_open(const char* scene, const char* part,
                                    const forcelayer_options* options, char* error,
                                    size_t error_bytes);

/* Registers the part at rest, before the first step, or to begin anew. `first` is where the handle
 * is now. `world_from_part` places the part, `handle_from_part` is the grip; either may be NULL.
 *   neither:    the part's frame is the handle's
 *   grip alone: the part is where the grip has it
 *   place alone: the hand holds the part there, without stretch
 *   both:       the handle pulls the part from its place to where the grip has it, and the output
 *               arms once the part is free of contact
 * 0 on success; not 0 for an invalid pose, and for a first reading that cannot be used. */
int forcelayer_start(forcelayer_runtime* runtime, const double world_from_part[7],
                     const double handle_from_part[7], const forcelayer_reading* first, char* error,
                     size_t error_bytes);

/* One period, from the servo thread alone. Never blocks, allocates, locks or logs. A fault of the
 * reading gives zero in the same call; a fault that lasts, and a call that comes late by more than
 * the stale limit, trips the output. Returns 0; before forcelayer_start() the result is zero and
 * the return is not 0. */
int forcelayer_step(forcelayer_runtime* runtime, const forcelayer_reading* reading,
                    forcelayer_result* result);

/* More of the last step, from the servo thread: fills `state_bytes` (sizeof *state), and what this
 * version does not know with zeros. Before the first step all is 0. Never blocks or allocates. */
void forcelayer_last_state(const forcelayer_runtime* runtime, forcelayer_state* state,
                           size_t state_bytes);

/* The proven separation of the two files: in every step in which its premises hold, and on the way
 * from one to the next, where no point of the part travels more than half a voxel. 0: none. */
void forcelayer_guarantee(const forcelayer_runtime* runtime, double* tested_m, double* swept_m);

/* Warnings of forcelayer_open(), such as a device without motors or units that do not fit: a
 * sentence for each index from 0 on, NULL beyond the last. Valid until swapped or closed. */
const char* forcelayer_warning(const forcelayer_runtime* runtime, uint32_t index);

/* The clutch, from any thread. Pressed (1): the output fades to zero and the part stays where it
 * is. Released (0): the hand holds it anew, without stretch, and the output ramps in. To press and
 * release it is also how a tripped output is armed again. */
void forcelayer_set_clutch(forcelayer_runtime* runtime, int pressed);

/* The name of an object of the scene, by its number in a result; "" for any other number. From the
 * servo thread. The text is valid until the scene is swapped or closed. */
const char* forcelayer_object_name(const forcelayer_runtime* runtime, uint32_t object);

/* Why the output tripped last, as text; "none". From the servo thread. The text is constant. */
const char* forcelayer_last_trip(const forcelayer_runtime* runtime);

/* Replaces scene and part while the loop runs, from one thread other than the servo's. Opens both,
 * lets the output fade, registers the part as forcelayer_start() does (with both a place and a
 * grip, the place counts: it is gripped there without stretch) and ramps in. Returns when the servo
 * thread has taken them: 0. Not 0: the files so far stay in use; where the servo thread did not
 * come within `timeout_s`, the new ones follow when it does. */
int forcelayer_swap(forcelayer_runtime* runtime, const char* scene, const char* part,
                    const double world_from_part[7], const double handle_from_part[7],
                    double timeout_s, char* error, size_t error_bytes);

/* After the last step. NULL does nothing. */
void forcelayer_close(forcelayer_runtime* runtime);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
