#include "haptic_firmware.h"

#include <string.h>

const uint8_t kHapticReportDescriptor[HAPTIC_REPORT_DESCRIPTOR_BYTES] = {
    0x06, 0x46, 0xff, /* Usage Page (vendor-defined 0xff46) */
    0x09, 0x01,       /* Usage (1): six-axis haptic device */
    0xa1, 0x01,       /* Collection (Application) */
    0x15, 0x00,       /*   Logical Minimum (0) */
    0x26, 0xff, 0x00, /*   Logical Maximum (255) */
    0x75, 0x08,       /*   Report Size (8) */
    0x95, 0x40,       /*   Report Count (64) */
    0x09, 0x02,       /*   Usage (2) */
    0x81, 0x02,       /*   Input (Data, Variable, Absolute): state, capabilities */
    0x95, 0x40,       /*   Report Count (64) */
    0x09, 0x03,       /*   Usage (3) */
    0x91, 0x02,       /*   Output (Data, Variable, Absolute): command, hello */
    0xc0,             /* End Collection */
};

enum { VERSION = 1, CHECKSUM_AT = 62 };
enum { KIND_STATE = 0x01, KIND_CAPABILITIES = 0x02, KIND_COMMAND = 0x81, KIND_HELLO = 0x82 };
enum { COMMAND_MOTORS_ON = 1, COMMAND_FADED = 2, VELOCITY_SENSED = 1 };
enum {
  STATUS_CALIBRATED = 1,
  STATUS_WATCHDOG = 2,
  STATUS_FAULT = 4,
  STATUS_MOTORS_ON = 8,
  STATUS_LIMITED = 16
};

static uint16_t get16(const uint8_t* p) { return (uint16_t)(p[0] | (uint16_t)(p[1] << 8)); }

static uint32_t get32(const uint8_t* p) {
  return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* The two's complement number with these bits, without relying on the conversion. */
static int32_t get_signed32(const uint8_t* p) {
  const uint32_t bits = get32(p);
  int32_t value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static void put16(uint8_t* p, uint16_t value) {
  p[0] = (uint8_t)value;
  p[1] = (uint8_t)(value >> 8);
}

static void put32(uint8_t* p, uint32_t value) {
  put16(p, (uint16_t)value);
  put16(p + 2, (uint16_t)(value >> 16));
}

/* CRC-16/CCITT-FALSE: polynomial 0x1021, first value 0xffff, nothing reflected. */
static uint16_t checksum(const uint8_t* bytes) {
  uint16_t crc = 0xffff;
  int i, bit;
  for (i = 0; i < CHECKSUM_AT; ++i) {
    crc = (uint16_t)(crc ^ (uint16_t)(bytes[i] << 8));
    for (bit = 0; bit < 8; ++bit) {
      crc = (uint16_t)((crc & 0x8000) != 0 ? (uint16_t)(crc << 1) ^ 0x1021 : crc << 1);
    }
  }
  return crc;
}

static int all_zero(const uint8_t* bytes, int from, int to) {
  int i;
  for (i = from; i < to; ++i) {
    if (bytes[i] != 0) return 0;
  }
  return 1;
}

/* The largest integer whose square is not above x. */
static uint32_t square_root(uint64_t x) {
  uint64_t root = 0, bit = (uint64_t)1 << 62;
  while (bit > x) bit >>= 2;
  for (; bit != 0; bit >>= 2) {
    if (x >= root + bit) {
      x -= root + bit;
      root = (root >> 1) + bit;
    } else {
      root >>= 1;
    }
  }
  return (uint32_t)root;
}

/* Shortens v to `limit`; returns whether it had to. Components below 2^30, so that no sum wraps. */
static int cut(int32_t v[3], uint32_t limit) {
  uint64_t square = 0;
  uint32_t length;
  int i;
  for (i = 0; i < 3; ++i) {
    if (v[i] > 0x3fffffff) v[i] = 0x3fffffff;
    if (v[i] < -0x3fffffff) v[i] = -0x3fffffff;
    square += (uint64_t)((int64_t)v[i] * v[i]);
  }
  if (square <= (uint64_t)limit * limit) return 0;
  length = square_root(square) + 1;
  for (i = 0; i < 3; ++i) v[i] = (int32_t)((int64_t)v[i] * (int64_t)limit / (int64_t)length);
  return 1;
}

static int is_zero(const HapticWrench* w) {
  return w->force_un[0] == 0 && w->force_un[1] == 0 && w->force_un[2] == 0 &&
         w->torque_unm[0] == 0 && w->torque_unm[1] == 0 && w->torque_unm[2] == 0;
}

void haptic_init(HapticFirmware* device, const HapticDeviceRatings* ratings) {
  memset(device, 0, sizeof *device);
  device->ratings = *ratings;
  device->latched = 1;
}

static void take_command(HapticFirmware* device, const uint8_t* report, uint32_t now_us) {
  HapticWrench wrench;
  const uint32_t asked_us = get32(report + 36);
  int i;
  for (i = 0; i < 3; ++i) {
    wrench.force_un[i] = get_signed32(report + 12 + 4 * i);
    wrench.torque_unm[i] = get_signed32(report + 24 + 4 * i);
  }
  device->motors_on = (get16(report + 2) & COMMAND_MOTORS_ON) != 0;
  if (is_zero(&wrench)) device->latched = 0;
  device->limited = (uint8_t)(cut(wrench.force_un, device->ratings.max_force_un) |
                              cut(wrench.torque_unm, device->ratings.max_torque_unm));
  device->wrench = wrench;
  device->watchdog_us =
      asked_us < device->ratings.watchdog_us ? asked_us : device->ratings.watchdog_us;
  device->command_us = now_us;
  device->echo = get32(report + 4);
}

int haptic_receive(HapticFirmware* device, const uint8_t* report, uint32_t bytes, uint32_t now_us) {
  uint16_t flags;
  if (bytes != HAPTIC_REPORT_BYTES || get16(report + CHECKSUM_AT) != checksum(report) ||
      report[1] != VERSION) {
    ++device->refused;
    return 0;
  }
  flags = get16(report + 2);
  /* A command that is late by more than it may be held must not revive the motors unseen. */
  (void)haptic_motors(device, 0, now_us);
  if (report[0] == KIND_COMMAND && (flags & ~(COMMAND_MOTORS_ON | COMMAND_FADED)) == 0 &&
      all_zero(report, 48, CHECKSUM_AT)) {
    take_command(device, report, now_us);
    return 1;
  }
  if (report[0] == KIND_HELLO && flags == 0 && all_zero(report, 12, CHECKSUM_AT)) {
    device->hello = 1;
    device->hello_sequence = get32(report + 4);
    device->motors_on = 0;
    device->latched = 1; /* a host that starts anew starts from zero */
    return 1;
  }
  ++device->refused;
  return 0;
}

HapticWrench haptic_motors(HapticFirmware* device, int fault, uint32_t now_us) {
  HapticWrench zero;
  memset(&zero, 0, sizeof zero);
  if (fault || now_us - device->command_us > device->watchdog_us) device->latched = 1;
  if (device->latched || !device->motors_on) return zero;
  return device->wrench;
}

static void put_ratings(const HapticFirmware* device, uint8_t* report) {
  const HapticDeviceRatings* r = &device->ratings;
  report[0] = KIND_CAPABILITIES;
  put16(report + 2, r->senses_velocity ? VELOCITY_SENSED : 0);
  put32(report + 12, device->hello_sequence);
  report[16] = r->sensed_axes & 0x3f;
  report[17] = r->actuated_axes & 0x3f;
  put32(report + 20, r->max_force_un);
  put32(report + 24, r->max_torque_unm);
  put32(report + 28, r->stiffness_mn_per_m);
  put32(report + 32, r->stiffness_unm_per_rad);
  put32(report + 36, r->damping_uns_per_m);
  put32(report + 40, r->damping_nnms_per_rad);
  put32(report + 44, r->workspace_radius_um);
  put32(report + 48, r->rate_mhz);
  put32(report + 52, r->watchdog_us);
  put32(report + 56, r->delay_us);
}

static void put_state(const HapticFirmware* device, const HapticReading* reading, uint8_t* report) {
  unsigned status = 0;
  int i;
  if (reading->calibrated) status |= STATUS_CALIBRATED;
  if (reading->fault) status |= STATUS_FAULT;
  if (device->latched) status |= STATUS_WATCHDOG;
  if (device->motors_on && !device->latched) status |= STATUS_MOTORS_ON;
  if (device->limited) status |= STATUS_LIMITED;
  report[0] = KIND_STATE;
  put16(report + 2, (uint16_t)status);
  for (i = 0; i < 3; ++i) put32(report + 12 + 4 * i, (uint32_t)reading->position_10nm[i]);
  for (i = 0; i < 4; ++i) put32(report + 24 + 4 * i, (uint32_t)reading->orientation_q30[i]);
  for (i = 0; i < 3; ++i) put16(report + 40 + 2 * i, (uint16_t)reading->linear_q12_mps[i]);
  for (i = 0; i < 3; ++i) put16(report + 46 + 2 * i, (uint16_t)reading->angular_q9_radps[i]);
  put16(report + 52, reading->buttons);
  put32(report + 56, device->echo);
}

void haptic_next_report(HapticFirmware* device, const HapticReading* reading, uint32_t now_us,
                        uint8_t report[HAPTIC_REPORT_BYTES]) {
  /* The status is that of this moment: the watchdog shows even if the motor loop has not run. */
  (void)haptic_motors(device, reading->fault, now_us);
  memset(report, 0, HAPTIC_REPORT_BYTES);
  report[1] = VERSION;
  put32(report + 4, ++device->sequence);
  put32(report + 8, now_us);
  if (device->hello) {
    device->hello = 0;
    put_ratings(device, report);
  } else {
    put_state(device, reading, report);
  }
  put16(report + CHECKSUM_AT, checksum(report));
}
