/* The device's side of ../hid_haptic_report.md, for a microcontroller with 64-byte RawHID reports.
 * Portable C99: integers alone, no heap, no library beyond memcpy and memset. Times are those of a
 * free-running 32-bit microsecond clock and may wrap.
 *
 * The board's own code:
 *   - gives the USB stack kHapticReportDescriptor, and 64-byte interrupt endpoints at 1 kHz;
 *   - calls haptic_receive() for every report that comes;
 *   - calls haptic_motors() at every tick of its motor loop, from a timer that nothing can stop.
 *     It puts exactly the returned wrench on the motors. The watchdog is inside: a host that is
 *     silent, stopped or gone gives zero, whatever else the firmware does;
 *   - calls haptic_next_report() once a millisecond and sends the report.
 * All three run in one context, or with interrupts off around them. */
#ifndef FORCELAYER_HAPTIC_FIRMWARE_H
#define FORCELAYER_HAPTIC_FIRMWARE_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { HAPTIC_REPORT_BYTES = 64, HAPTIC_REPORT_DESCRIPTOR_BYTES = 27 };

extern const uint8_t kHapticReportDescriptor[HAPTIC_REPORT_DESCRIPTOR_BYTES];

/* The abilities of the device; 0 in a rating: not stated. */
typedef struct {
  uint8_t sensed_axes;   /* bits 0-2 x y z, 3-5 rotation about them */
  uint8_t actuated_axes; /* the same */
  uint8_t senses_velocity;
  uint32_t max_force_un;   /* magnitude, micronewtons */
  uint32_t max_torque_unm; /* magnitude, micronewton-meters */
  uint32_t stiffness_mn_per_m;
  uint32_t stiffness_unm_per_rad;
  uint32_t damping_uns_per_m;
  uint32_t damping_nnms_per_rad;
  uint32_t workspace_radius_um;
  uint32_t rate_mhz; /* millihertz */
  uint32_t watchdog_us;
  uint32_t delay_us;
} HapticDeviceRatings;

/* A reading of the sensors, in the units of the layout. */
typedef struct {
  int32_t position_10nm[3];
  int32_t orientation_q30[4]; /* w x y z, unit quaternion times 2^30 */
  int16_t linear_q12_mps[3];
  int16_t angular_q9_radps[3];
  uint16_t buttons;
  uint8_t calibrated;
  uint8_t fault; /* not 0: the motors must stay off */
} HapticReading;

typedef struct {
  int32_t force_un[3];   /* micronewtons, device axes */
  int32_t torque_unm[3]; /* micronewton-meters, about the handle's origin */
} HapticWrench;

typedef struct {
  HapticDeviceRatings ratings;
  HapticWrench wrench;     /* of the last command, cut to the ratings */
  uint32_t command_us;     /* when it came */
  uint32_t watchdog_us;    /* it may be held for so long */
  uint32_t echo;           /* its sequence */
  uint32_t sequence;       /* of the reports sent */
  uint32_t hello_sequence; /* of the hello to answer */
  uint32_t refused;        /* reports that were no sound command or hello */
  uint8_t motors_on;       /* the host wants them on */
  uint8_t latched;         /* the watchdog holds zero */
  uint8_t limited;         /* the wrench was cut */
  uint8_t hello;           /* a hello waits for its answer */
} HapticFirmware;

/* Latched at first: zero until a host has sent a zero wrench. */
void haptic_init(HapticFirmware* device, const HapticDeviceRatings* ratings);

/* Takes a report of `bytes` bytes from the host. Returns 1 where it is a sound command or hello;
 * anything else changes nothing. */
int haptic_receive(HapticFirmware* device, const uint8_t* report, uint32_t bytes, uint32_t now_us);

/* The wrench that the motors must have now. `fault` not 0: zero, and latched. */
HapticWrench haptic_motors(HapticFirmware* device, int fault, uint32_t now_us);

/* Writes the next report for the host: the answer to a hello, else the reading. */
void haptic_next_report(HapticFirmware* device, const HapticReading* reading, uint32_t now_us,
                        uint8_t report[HAPTIC_REPORT_BYTES]);

#ifdef __cplusplus
}
#endif

#endif
