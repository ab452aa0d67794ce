/* The ABI of libforcelayer.so.0: where programs that were compiled with an earlier header look. A
 * line that fails here means that such programs break: the library needs another number, or the
 * change another way (a new function). */
#include <assert.h>
#include <forcelayer/forcelayer.h>

#define SIZE(type, bytes) static_assert(sizeof(type) == (bytes), #type)
#define AT(type, field, bytes) static_assert(offsetof(type, field) == (bytes), #type "." #field)

SIZE(forcelayer_options, 192);
AT(forcelayer_options, model, 0);
AT(forcelayer_options, rate_hz, 8);
AT(forcelayer_options, max_force_n, 16);
AT(forcelayer_options, max_torque_nm, 24);
AT(forcelayer_options, max_stiffness_n_per_m, 32);
AT(forcelayer_options, max_stiffness_nm_per_rad, 40);
AT(forcelayer_options, damping_ns_per_m, 48);
AT(forcelayer_options, damping_nms_per_rad, 56);
AT(forcelayer_options, delay_s, 64);
AT(forcelayer_options, workspace_radius_m, 72);
AT(forcelayer_options, senses_velocity, 80);
AT(forcelayer_options, world_from_device, 88);
AT(forcelayer_options, motion_scale, 144);
AT(forcelayer_options, stale_s, 152);
AT(forcelayer_options, max_speed_mps, 160);
AT(forcelayer_options, max_turn_radps, 168);
AT(forcelayer_options, without_guarantee, 176);
AT(forcelayer_options, expected_sha256, 184);

SIZE(forcelayer_reading, 120);
AT(forcelayer_reading, device_from_handle, 0);
AT(forcelayer_reading, linear_mps, 56);
AT(forcelayer_reading, angular_radps, 80);
AT(forcelayer_reading, buttons, 104);
AT(forcelayer_reading, fresh, 108);
AT(forcelayer_reading, present, 112);
AT(forcelayer_reading, calibrated, 116);

SIZE(forcelayer_result, 136);
AT(forcelayer_result, force_n, 0);
AT(forcelayer_result, torque_nm, 24);
AT(forcelayer_result, world_from_part, 48);
AT(forcelayer_result, output, 104);
AT(forcelayer_result, contacts, 108);
AT(forcelayer_result, interior, 112);
AT(forcelayer_result, clearance, 116);
AT(forcelayer_result, nearest_object, 120);
AT(forcelayer_result, clearance_m, 128);

SIZE(forcelayer_state, 32); /* fields may be appended: the caller says how large its own is */
AT(forcelayer_state, guaranteed_m, 0);
AT(forcelayer_state, outside_map, 8);
AT(forcelayer_state, barred, 12);
AT(forcelayer_state, seat_open, 16);
AT(forcelayer_state, seated, 20);
AT(forcelayer_state, faults, 24);
AT(forcelayer_state, tested, 28);

static_assert(FORCELAYER_MODEL_DEFAULT == 0 && FORCELAYER_MODEL_PAPER == 1, "models");
static_assert(FORCELAYER_WAITING == 0 && FORCELAYER_ARMED == 1 && FORCELAYER_TRIPPED == 2,
              "output");
static_assert(FORCELAYER_CLEARANCE_NONE == 0 && FORCELAYER_CLEARANCE_AT_LEAST == 1 &&
                  FORCELAYER_CLEARANCE_PROVEN == 2,
              "clearance");

static_assert(FORCELAYER_FAULT_INVALID_INPUT == 1 && FORCELAYER_FAULT_NON_FINITE_INPUT == 2 &&
                  FORCELAYER_FAULT_NON_FINITE_STATE == 4,
              "faults");

/* Each function by its type. */
void (*const default_options)(forcelayer_options*) = forcelayer_default_options;
forcelayer_runtime* (*const open_runtime)(const char*, const char*, const forcelayer_options*,
                                          char*, size_t) = forcelayer_open;
int (*const start)(forcelayer_runtime*, const double*, const double*, const forcelayer_reading*,
                   char*, size_t) = forcelayer_start;
int (*const step)(forcelayer_runtime*, const forcelayer_reading*,
                  forcelayer_result*) = forcelayer_step;
void (*const last_state)(const forcelayer_runtime*, forcelayer_state*,
                         size_t) = forcelayer_last_state;
void (*const guarantee)(const forcelayer_runtime*, double*, double*) = forcelayer_guarantee;
const char* (*const warning)(const forcelayer_runtime*, uint32_t) = forcelayer_warning;
void (*const set_clutch)(forcelayer_runtime*, int) = forcelayer_set_clutch;
const char* (*const object_name)(const forcelayer_runtime*, uint32_t) = forcelayer_object_name;
const char* (*const last_trip)(const forcelayer_runtime*) = forcelayer_last_trip;
int (*const swap)(forcelayer_runtime*, const char*, const char*, const double*, const double*,
                  double, char*, size_t) = forcelayer_swap;
void (*const close_runtime)(forcelayer_runtime*) = forcelayer_close;
