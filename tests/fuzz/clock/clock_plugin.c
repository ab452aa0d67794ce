/* The device of fault_clock: a hand that wanders in and out of contact, readings that fail on
 * order, and motors that judge what they get by what the loop wrote (truth.h).
 * Arguments: truth=FILE seed=N velocity=0|1 */
#define _GNU_SOURCE
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include "forcelayer/plugin.h"
#include "tests/fuzz/clock/truth.h"
#include "tests/support/wild_write.h"

static const double kForceN = 10, kTorqueNm = 0.1;
static const double kStaleNs = 5e6, kGrace = 0.4; /* output_watch.h */
static const double kDt = 0.001;

struct device {
  struct truth* truth;
  uint64_t random;
  double hand_m[3], goal_m[3], turn, goal_turn, velocity_mps[3], turn_radps;
  uint64_t ticks;
  uint32_t fault, left;
  int given;           /* a reading, in this iteration */
  int bad;             /* it must be refused */
  int64_t read_ns;     /* when the last read ended: the host asks for the wrench after that */
  int must_be_zero;    /* the loop was silent for too long, and has not written a zero since */
  uint64_t zero_after; /* number of the write after which it must */
};

static int64_t now_ns(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static uint64_t dice(struct device* d) { /* xorshift64 */
  d->random ^= d->random << 13;
  d->random ^= d->random >> 7;
  d->random ^= d->random << 17;
  return d->random;
}

static double between(struct device* d, double low, double high) {
  return low + (high - low) * (double)(dice(d) >> 11) * 0x1p-53;
}

static void breaks(struct device* d, const char* what) {
  if (__atomic_fetch_add(&d->truth->broken, 1, __ATOMIC_RELAXED) == 0) {
    snprintf(d->truth->what, sizeof d->truth->what, "motors: %s", what);
  }
}

/* The hand turns about x alone. */
static void move_hand(struct device* d) {
  if (d->ticks++ % 250 == 0) {
    d->goal_turn = between(d, -0.8, 0.8);
    const double part[3] = {between(d, 0.05, 0.18), between(d, 0.05, 0.18),
                            between(d, 0.015, 0.045)};
    const double* g = d->truth->grip_m;
    const double c = cos(d->goal_turn), s = sin(d->goal_turn);
    d->goal_m[0] = part[0] - g[0];
    d->goal_m[1] = part[1] - (c * g[1] - s * g[2]);
    d->goal_m[2] = part[2] - (s * g[1] + c * g[2]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double step_m = 0.01 * (d->goal_m[axis] - d->hand_m[axis]);
    d->hand_m[axis] += step_m;
    d->velocity_mps[axis] = step_m / kDt;
  }
  const double step = 0.01 * (d->goal_turn - d->turn);
  d->turn += step;
  d->turn_radps = step / kDt;
}

static void sleep_ms(long ms) {
  const struct timespec t = {ms / 1000, ms % 1000 * 1000000};
  nanosleep(&t, NULL);
}

static void take_order(struct device* d) {
  const uint32_t order = __atomic_load_n(&d->truth->order, __ATOMIC_ACQUIRE);
  if (d->left > 0 && d->fault < FAULT_FOR_GOOD) --d->left;
  if (d->left == 0) d->fault = FAULT_NONE;
  if (order == FAULT_NONE || order >= FAULT_KINDS) return;
  d->fault = order;
  d->left = d->truth->order_readings;
  __atomic_store_n(&d->truth->order, FAULT_NONE, __ATOMIC_RELEASE);
  ++d->truth->faults;
}

static int read_device(void* opaque, forcelayer_plugin_reading* reading) {
  struct device* d = opaque;
  take_order(d);
  if (d->fault == FAULT_HANG) {
    sleep_ms(d->left);
    d->left = 0;
  }
  move_hand(d);
  for (int axis = 0; axis < 3; ++axis) {
    reading->position_m[axis] = d->hand_m[axis];
    reading->linear_mps[axis] = d->velocity_mps[axis];
  }
  reading->orientation_wxyz[0] = cos(d->turn / 2);
  reading->orientation_wxyz[1] = sin(d->turn / 2);
  reading->angular_radps[0] = d->turn_radps;
  reading->status = FORCELAYER_PLUGIN_CALIBRATED;
  switch (d->fault) {
    case FAULT_NAN:
      (dice(d) & 1 ? reading->position_m : reading->orientation_wxyz)[1] =
          dice(d) & 2 ? NAN : INFINITY;
      break;
    case FAULT_NO_ROTATION:
      reading->orientation_wxyz[0] = dice(d) & 1 ? 3 : 1e-300;
      reading->orientation_wxyz[1] = 0;
      break;
    case FAULT_FAR:
      reading->position_m[1] += dice(d) & 1 ? 100 : 1e300;
      break;
    case FAULT_UNCALIBRATED:
      reading->status = 0;
      break;
    case FAULT_JUMP:
      reading->position_m[2] += dice(d) & 1 ? 0.1 : -0.1;
      break;
    case FAULT_TURN:
      reading->orientation_wxyz[0] = 0;
      reading->orientation_wxyz[1] = 1;
      break;
    case FAULT_CLAIM:
      reading->angular_radps[2] += dice(d) & 1 ? 1000 : 1e300;
      reading->linear_mps[2] -= dice(d) & 1 ? 4 : 0;
      break;
    case FAULT_MOTORS_OFF:
      reading->status |= FORCELAYER_PLUGIN_MOTORS_OFF;
      break;
    case FAULT_CRASH:
      abort();
    case FAULT_WILD:
    case FAULT_WILD_INDEX:
      write_wildly(d->fault == FAULT_WILD_INDEX ? WILD_INDICES : WILD_ALL);
      break;
    default:
      break;
  }
  d->given = d->fault != FAULT_SILENT && d->fault != FAULT_UNPLUG;
  d->bad = d->given && d->fault != FAULT_NONE && d->fault <= FAULT_BAD_READINGS;
  if (d->given && !d->bad) __atomic_store_n(&d->truth->bad_since, 0, __ATOMIC_RELEASE);
  d->read_ns = now_ns();
  return d->fault == FAULT_UNPLUG ? -1 : d->given;
}

/* Whether `w` is `entry` times 0 to `largest`. */
static int is_fraction(const forcelayer_plugin_wrench* w, const struct truth_write* entry,
                       double largest) {
  double along = 0, own = 0;
  for (int axis = 0; axis < 3; ++axis) { /* torques count 100 times: of the size of forces */
    along += w->force_n[axis] * entry->force_n[axis];
    own += entry->force_n[axis] * entry->force_n[axis];
    along += 1e4 * w->torque_nm[axis] * entry->torque_nm[axis];
    own += 1e4 * entry->torque_nm[axis] * entry->torque_nm[axis];
  }
  if (!(own > 0)) return 0;
  const double fraction = along / own, rounding = 1e-9 * sqrt(own);
  if (!(fraction >= 0 && fraction <= largest + 1e-9)) return 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (fabs(w->force_n[axis] - fraction * entry->force_n[axis]) > rounding) return 0;
    if (fabs(w->torque_nm[axis] - fraction * entry->torque_nm[axis]) > rounding) return 0;
  }
  return 1;
}

static double length(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* The host asked for this wrench after read_ns. So it is of the newest write that was done by then,
 * or of a later one; it is no older than the stale limit, faded by its age, and after a longer
 * silence of the loop it is zero until the loop wrote a zero. */
static void judge_motors(struct device* d, const forcelayer_plugin_wrench* w) {
  struct truth* truth = d->truth;
  const double force_n = length(w->force_n), torque_nm = length(w->torque_nm);
  const int zero = force_n == 0 && torque_nm == 0;
  if (!(force_n <= kForceN * (1 + 1e-9) && torque_nm <= kTorqueNm * (1 + 1e-9))) {
    breaks(d, "a wrench beyond the ratings");
  }
  const uint64_t writes = __atomic_load_n(&truth->writes, __ATOMIC_ACQUIRE);
  int ours = zero, newest_done = 0;
  for (uint64_t n = writes; n-- > 0 && writes - n < 200 && !newest_done;) {
    const struct truth_write* entry = &truth->write[n % TRUTH_WRITES];
    const int64_t done_ns = __atomic_load_n(&entry->done_ns, __ATOMIC_ACQUIRE);
    const int entry_zero = length(entry->force_n) == 0 && length(entry->torque_nm) == 0;
    if (d->must_be_zero && entry_zero && n >= d->zero_after) d->must_be_zero = 0;
    newest_done = done_ns != 0 && done_ns <= d->read_ns;
    double largest = 1;
    if (newest_done) {
      const double age = (double)(d->read_ns - done_ns) / kStaleNs;
      largest = age <= kGrace ? 1 : age < 1 ? (1 - age) / (1 - kGrace) : 0;
      if (age > 1 && n + 1 == writes && !d->must_be_zero) {
        d->must_be_zero = 1;
        d->zero_after = writes;
      }
    }
    if (!ours && largest > 0 && is_fraction(w, entry, largest)) ours = 1;
  }
  if (now_ns() - d->read_ns > 100000000) return; /* asleep meanwhile: the entries are others now */
  if (!ours) breaks(d, "a wrench that the loop did not write, or one that is too old");
  if (d->must_be_zero && !zero) breaks(d, "a force after a silence, before a zero");
}

static int write_device(void* opaque, const forcelayer_plugin_wrench* wrench) {
  struct device* d = opaque;
  struct truth* truth = d->truth;
  const uint64_t given = truth->readings + (d->given ? 1 : 0);
  __atomic_store_n(&truth->readings, given, __ATOMIC_RELEASE);
  if (d->bad && truth->bad_since == 0) {
    __atomic_store_n(&truth->bad_since, (int64_t)given, __ATOMIC_RELEASE);
  }
  judge_motors(d, wrench);
  ++truth->motor_writes;
  truth->motor_forces += length(wrench->force_n) > 0;
  return 0;
}

static int open_device(const char* arguments, forcelayer_plugin_info* info, void** out, char* error,
                       size_t error_bytes) {
  static struct device device;
  char path[400] = "";
  unsigned long seed = 1;
  unsigned velocity = 0;
  if (sscanf(arguments, "truth=%399s seed=%lu velocity=%u", path, &seed, &velocity) != 3) {
    snprintf(error, error_bytes, "needs truth=FILE seed=N velocity=0|1");
    return 1;
  }
  const int file = open(path, O_RDWR | O_CLOEXEC);
  device.truth = mmap(NULL, sizeof(struct truth), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (device.truth == MAP_FAILED) {
    snprintf(error, error_bytes, "cannot map %s", path);
    return 1;
  }
  device.random = seed * 0x9e3779b97f4a7c15u + 1;
  device.hand_m[0] = device.hand_m[1] = 0.1;
  device.hand_m[2] = 0.05;
  device.truth->process = getpid();
  info->abi = FORCELAYER_PLUGIN_ABI;
  info->si_units = FORCELAYER_PLUGIN_SI_UNITS;
  info->right_handed = FORCELAYER_PLUGIN_RIGHT_HANDED;
  info->sensed_axes = info->actuated_axes = 63;
  info->senses_velocity = velocity;
  snprintf(info->name, sizeof info->name, "clock");
  info->rate_hz = 1000;
  info->max_force_n = kForceN;
  info->max_torque_nm = kTorqueNm;
  info->damping_ns_per_m = 2;
  info->damping_nms_per_rad = 0.005;
  info->delay_s = 0.001;
  info->workspace_radius_m = 0.5;
  info->watchdog_s = 0.02;
  *out = &device;
  return 0;
}

static void close_device(void* opaque) { (void)opaque; }

static const forcelayer_plugin kPlugin = {open_device, read_device, write_device, NULL,
                                          close_device};

const forcelayer_plugin* forcelayer_plugin_entry(uint32_t host_abi) {
  return host_abi == FORCELAYER_PLUGIN_ABI ? &kPlugin : NULL;
}
