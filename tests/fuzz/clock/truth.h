/* Told by the two processes of fault_clock to each other, beside the interface that is tested: the
 * plugin obeys orders and judges its motors; the loop judges its frames. One structure in a file
 * that both map. Every word is written by one side, with the builtins for atomics. */
#ifndef FORCELAYER_TESTS_FUZZ_CLOCK_TRUTH_H
#define FORCELAYER_TESTS_FUZZ_CLOCK_TRUTH_H

#include <stdint.h>

enum { TRUTH_WRITES = 1024 };

/* The plugin's faults. Those up to FAULT_BAD_READINGS give readings that the loop must refuse. */
enum truth_fault {
  FAULT_NONE,
  FAULT_NAN,
  FAULT_NO_ROTATION,
  FAULT_FAR,
  FAULT_UNCALIBRATED,
  FAULT_BAD_READINGS = FAULT_UNCALIBRATED,
  FAULT_JUMP,
  FAULT_TURN,
  FAULT_CLAIM,
  FAULT_SILENT, /* no readings */
  FAULT_HANG,   /* no readings, no writes: it sleeps */
  FAULT_MOTORS_OFF,
  FAULT_FOR_GOOD,
  FAULT_UNPLUG = FAULT_FOR_GOOD,
  FAULT_CRASH,
  FAULT_WILD,       /* 0xff over the memory that is shared with the loop */
  FAULT_WILD_INDEX, /* over the words there that say where a value is */
  FAULT_KINDS
};

/* A wrench that the loop wrote. It may be in use as soon as it counts in `writes`, and is the
 * newest one once `done_ns` (CLOCK_MONOTONIC) is not 0. */
struct truth_write {
  int64_t done_ns;
  double force_n[3], torque_nm[3];
};

struct truth {
  /* By the loop. */
  uint64_t writes;
  struct truth_write write[TRUTH_WRITES];
  uint32_t order, order_readings; /* a fault, and for how many readings; order 0 again once taken */
  double grip_m[3];               /* of the part's center in the handle's frame */

  /* By the plugin. */
  int32_t process;
  uint64_t readings; /* given until now */
  int64_t bad_since; /* its reading numbers, the first of a row that must be refused; 0: none */
  uint64_t faults, motor_writes, motor_forces;
  uint32_t broken; /* promises of the motors' side */
  char what[96];   /* the first one */
};

#endif
