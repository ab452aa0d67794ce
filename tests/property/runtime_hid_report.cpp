// The haptic reports: the host's code and the firmware's, written apart, agree; damage is seen.
#include <gtest/gtest.h>

#include <cstring>
#include <glm/geometric.hpp>
#include <limits>

#include "runtime/devices/hid/hid_haptic_report.h"
#include "runtime/devices/hid/hid_report_descriptor.h"
#include "tests/support/random_scenes.h"
#include "tests/support/virtual_haptic_device.h"

namespace forcelayer::test {
namespace {

devices::HapticReport bytes_of(const std::uint8_t (&report)[HAPTIC_REPORT_BYTES]) {
  devices::HapticReport bytes;
  std::copy(std::begin(report), std::end(report), bytes.begin());
  return bytes;
}

devices::HapticReport random_state(Random& random, HapticReading& reading,
                                   HapticFirmware& firmware) {
  const HapticDeviceRatings ratings = virtual_ratings();
  haptic_init(&firmware, &ratings);
  firmware.sequence = static_cast<std::uint32_t>(random());
  firmware.echo = static_cast<std::uint32_t>(random());
  reading =
      reading_of({random_direction(random) * uniform(random, 0, 20), random_orientation(random)});
  for (int i = 0; i < 3; ++i) {
    reading.linear_q12_mps[i] = static_cast<std::int16_t>(random());
    reading.angular_q9_radps[i] = static_cast<std::int16_t>(random());
  }
  reading.buttons = static_cast<std::uint16_t>(random());
  reading.calibrated = random() % 2;
  reading.fault = random() % 2;
  std::uint8_t report[HAPTIC_REPORT_BYTES];
  haptic_next_report(&firmware, &reading, static_cast<std::uint32_t>(random()), report);
  return bytes_of(report);
}

TEST(HapticReport, TheHostReadsTheFirmwaresStates) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    HapticReading reading;
    HapticFirmware firmware;
    const devices::HapticReport report = random_state(random, reading, firmware);
    devices::HapticState state;
    ASSERT_EQ(devices::decode_state(report, state), devices::HapticDefect::kNone)
        << "seed " << seed;
    EXPECT_EQ(state.sequence, firmware.sequence) << "seed " << seed;
    EXPECT_EQ(state.echo, firmware.echo) << "seed " << seed;
    EXPECT_EQ(state.buttons, reading.buttons) << "seed " << seed;
    EXPECT_EQ(state.status, (reading.calibrated ? devices::kHapticCalibrated : 0) |
                                (reading.fault ? devices::kHapticFault : 0) |
                                devices::kHapticWatchdog)
        << "seed " << seed;
    const glm::dquat sent(reading.orientation_q30[0], reading.orientation_q30[1],
                          reading.orientation_q30[2], reading.orientation_q30[3]);
    EXPECT_NEAR(glm::length(state.device_from_handle.orientation), 1, 1e-15);
    EXPECT_NEAR(glm::dot(state.device_from_handle.orientation, glm::normalize(sent)), 1, 1e-15);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(state.device_from_handle.position_m[i], reading.position_10nm[i] * 1e-8);
      EXPECT_EQ(state.velocity.linear_mps[i], reading.linear_q12_mps[i] / 4096.0);
      EXPECT_EQ(state.velocity.angular_radps[i], reading.angular_q9_radps[i] / 512.0);
    }
  }
}

TEST(HapticReport, TheHostReadsTheFirmwaresRatings) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    Random random(seed);
    HapticDeviceRatings ratings = virtual_ratings();
    ratings.actuated_axes = random() % 64;
    ratings.senses_velocity = random() % 2;
    for (std::uint32_t* value :
         {&ratings.max_force_un, &ratings.max_torque_unm, &ratings.stiffness_mn_per_m,
          &ratings.stiffness_unm_per_rad, &ratings.damping_uns_per_m, &ratings.damping_nnms_per_rad,
          &ratings.workspace_radius_um, &ratings.rate_mhz, &ratings.watchdog_us,
          &ratings.delay_us}) {
      *value = static_cast<std::uint32_t>(random());
    }
    HapticFirmware firmware;
    haptic_init(&firmware, &ratings);
    const auto sequence = static_cast<std::uint32_t>(random());
    const devices::HapticReport hello = devices::encode_hello(sequence, 7);
    ASSERT_EQ(haptic_receive(&firmware, hello.data(), hello.size(), 7), 1);
    HapticReading reading = reading_of({});
    std::uint8_t report[HAPTIC_REPORT_BYTES];
    haptic_next_report(&firmware, &reading, 8, report);
    devices::HapticRatings read;
    ASSERT_EQ(devices::decode_ratings(bytes_of(report), read), devices::HapticDefect::kNone)
        << "seed " << seed;
    const DeviceCapabilities& device = read.capabilities;
    EXPECT_EQ(read.echo, sequence);
    EXPECT_EQ(device.sensed_axes, kAllAxes);
    EXPECT_EQ(device.actuated_axes, ratings.actuated_axes);
    EXPECT_EQ(device.senses_velocity, ratings.senses_velocity != 0);
    EXPECT_EQ(device.max_force_n, ratings.max_force_un / 1e6);
    EXPECT_EQ(device.max_torque_nm, ratings.max_torque_unm / 1e6);
    EXPECT_EQ(device.max_stiffness_n_per_m, ratings.stiffness_mn_per_m / 1e3);
    EXPECT_EQ(device.max_stiffness_nm_per_rad, ratings.stiffness_unm_per_rad / 1e6);
    EXPECT_EQ(device.damping_ns_per_m, ratings.damping_uns_per_m / 1e6);
    EXPECT_EQ(device.damping_nms_per_rad, ratings.damping_nnms_per_rad / 1e9);
    EXPECT_EQ(device.workspace_radius_m, ratings.workspace_radius_um / 1e6);
    EXPECT_EQ(device.rate_hz, ratings.rate_mhz / 1e3);
    EXPECT_EQ(device.watchdog_s, ratings.watchdog_us / 1e6);
    EXPECT_EQ(device.delay_s, ratings.delay_us / 1e6);
  }
}

HapticFirmware armed_firmware() {
  HapticFirmware firmware;
  const HapticDeviceRatings ratings = virtual_ratings();
  haptic_init(&firmware, &ratings);
  devices::HapticCommand zero;
  zero.motors_on = true;
  zero.watchdog_us = 20'000;
  const devices::HapticReport report = devices::encode_command(zero);
  EXPECT_EQ(haptic_receive(&firmware, report.data(), report.size(), 0), 1);
  return firmware;
}

TEST(HapticReport, TheMotorsGetTheHostsWrenchWithinTheRatings) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    Random random(seed);
    HapticFirmware firmware = armed_firmware();
    devices::HapticCommand command;
    command.motors_on = true;
    command.watchdog_us = 20'000;
    command.wrench.force_n = random_direction(random) * std::exp(uniform(random, -8, 9));
    command.wrench.torque_nm = random_direction(random) * std::exp(uniform(random, -10, 9));
    const devices::HapticReport report = devices::encode_command(command);
    ASSERT_EQ(haptic_receive(&firmware, report.data(), report.size(), 1000), 1);
    const HapticWrench motors = haptic_motors(&firmware, 0, 1000);
    // Below the rating to the microstep; above it the same direction, at most the rating.
    const auto check = [&](const std::int32_t(&v)[3], const glm::dvec3& wanted, double limit) {
      const glm::dvec3 got = glm::dvec3(v[0], v[1], v[2]) * 1e-6;
      if (glm::length(wanted) < 0.999 * limit) {
        EXPECT_LT(glm::length(got - wanted), 1e-6) << "seed " << seed;
      } else if (glm::length(wanted) < 500) {  // beyond, components end before the vector does
        EXPECT_LE(glm::length(got), limit) << "seed " << seed;
        EXPECT_LT(glm::length(got / limit - glm::normalize(wanted)), 2e-3) << "seed " << seed;
      } else {
        EXPECT_LE(glm::length(got), limit) << "seed " << seed;
        EXPECT_GT(glm::dot(got, wanted), 0) << "seed " << seed;
      }
    };
    check(motors.force_un, command.wrench.force_n, 12);
    check(motors.torque_unm, command.wrench.torque_nm, 0.2);
  }
}

TEST(HapticReport, AWrenchThatIsNotFiniteIsZeroWithTheMotorsOff) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity()};
  for (const double value : bad) {
    for (int axis = 0; axis < 6; ++axis) {
      devices::HapticCommand command;
      command.motors_on = true;
      command.wrench = {{1, 1, 1}, {1, 1, 1}};
      (axis < 3 ? command.wrench.force_n : command.wrench.torque_nm)[axis % 3] = value;
      const devices::HapticReport report = devices::encode_command(command);
      EXPECT_EQ(report[2], 2);
      EXPECT_TRUE(
          std::all_of(report.begin() + 12, report.begin() + 36, [](auto b) { return b == 0; }));
    }
  }
}

TEST(HapticFirmware, HoldsNoWrenchLongerThanItsWatchdogWhateverTheClock) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    Random random(seed);
    const auto start_us = static_cast<std::uint32_t>(random());  // the clock wraps
    HapticFirmware firmware = armed_firmware();
    devices::HapticCommand command;
    command.motors_on = true;
    command.watchdog_us = static_cast<std::uint32_t>(integer(random, 1, 60'000));
    const std::uint32_t held_us = std::min(command.watchdog_us, virtual_ratings().watchdog_us);
    const devices::HapticReport zero = devices::encode_command(command);
    command.wrench.force_n.x = 1;
    const devices::HapticReport push = devices::encode_command(command);
    const auto send = [&](const devices::HapticReport& report, std::uint32_t at_us) {
      ASSERT_EQ(haptic_receive(&firmware, report.data(), report.size(), at_us), 1);
    };
    send(zero, start_us);
    send(push, start_us);
    EXPECT_EQ(haptic_motors(&firmware, 0, start_us + held_us).force_un[0], 1'000'000);
    EXPECT_TRUE(is_zero(haptic_motors(&firmware, 0, start_us + held_us + 1)));
    send(push, start_us + held_us + 2);
    EXPECT_TRUE(is_zero(haptic_motors(&firmware, 0, start_us + held_us + 2))) << "seed " << seed;
    send(zero, start_us + held_us + 3);
    send(push, start_us + held_us + 4);
    EXPECT_FALSE(is_zero(haptic_motors(&firmware, 0, start_us + held_us + 4)));
    EXPECT_TRUE(is_zero(haptic_motors(&firmware, 1, start_us + held_us + 5)));  // its own fault
    EXPECT_TRUE(is_zero(haptic_motors(&firmware, 0, start_us + held_us + 6)));
    // A command that comes after the time has run out does not revive what nobody looked at.
    send(zero, start_us + held_us + 7);
    send(push, start_us + held_us + 8);
    send(push, start_us + 2 * held_us + 9);
    EXPECT_TRUE(is_zero(haptic_motors(&firmware, 0, start_us + 2 * held_us + 9)));
  }
}

// The documented check value, in a report made by Python's binascii.crc_hqx(bytes, 0xffff).
TEST(HapticReport, GoldenBytes) {
  const devices::HapticReport hello = devices::encode_hello(0x04030201, 0x08070605);
  const std::uint8_t head[12] = {0x82, 1, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_TRUE(std::equal(std::begin(head), std::end(head), hello.begin()));
  EXPECT_EQ(hello[62] | hello[63] << 8, 0x2ee4);
}

TEST(HapticReport, EveryDamagedBitAndEveryOtherLengthIsRefusedByBothSides) {
  Random random(5);
  HapticReading reading;
  HapticFirmware firmware;
  const devices::HapticReport report = random_state(random, reading, firmware);
  devices::HapticCommand command;
  command.motors_on = true;
  command.wrench.force_n = {1, 2, 3};
  const devices::HapticReport sent = devices::encode_command(command);
  for (std::size_t bit = 0; bit < 8 * report.size(); ++bit) {
    devices::HapticReport damaged = report;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    devices::HapticState state;
    EXPECT_NE(devices::decode_state(damaged, state), devices::HapticDefect::kNone) << "bit " << bit;
    damaged = sent;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    HapticFirmware device = armed_firmware();
    EXPECT_EQ(haptic_receive(&device, damaged.data(), damaged.size(), 1), 0) << "bit " << bit;
    EXPECT_TRUE(is_zero(haptic_motors(&device, 0, 1)));
  }
  std::vector<std::uint8_t> longer(report.begin(), report.end());
  longer.resize(200);
  for (std::size_t bytes = 0; bytes < longer.size(); ++bytes) {
    if (bytes == report.size()) continue;
    devices::HapticState state;
    EXPECT_EQ(devices::decode_state(std::span(longer).first(bytes), state),
              devices::HapticDefect::kLength);
    HapticFirmware device = armed_firmware();
    EXPECT_EQ(haptic_receive(&device, longer.data(), static_cast<std::uint32_t>(bytes), 1), 0);
  }
}

// Anything with a right checksum: taken only with the fields in range, and then finite.
TEST(HapticReport, SoundChecksumsAroundNonsenseGiveFiniteValuesOrNone) {
  int taken = 0;
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    Random random(seed);
    HapticReading reading;
    HapticFirmware firmware;
    devices::HapticReport report = random_state(random, reading, firmware);
    const auto changes = integer(random, 1, 6);
    for (std::int64_t i = 0; i < changes; ++i) {
      report[static_cast<std::size_t>(integer(random, 0, 61))] =
          static_cast<std::uint8_t>(random());
    }
    std::uint16_t crc = 0xffff;
    for (std::size_t i = 0; i < 62; ++i) {
      crc = static_cast<std::uint16_t>(crc ^ report[i] << 8);
      for (int bit = 0; bit < 8; ++bit) {
        crc = static_cast<std::uint16_t>(crc & 0x8000 ? crc << 1 ^ 0x1021 : crc << 1);
      }
    }
    report[62] = static_cast<std::uint8_t>(crc);
    report[63] = static_cast<std::uint8_t>(crc >> 8);
    devices::HapticState state;
    if (devices::decode_state(report, state) != devices::HapticDefect::kNone) continue;
    ++taken;
    EXPECT_NEAR(glm::length(state.device_from_handle.orientation), 1, 1e-12) << "seed " << seed;
    EXPECT_LT(glm::length(state.device_from_handle.position_m), 40) << "seed " << seed;
    EXPECT_EQ(report[54] | report[55] | report[60] | report[61], 0) << "seed " << seed;
  }
  EXPECT_GT(taken, 100);
}

}  // namespace
}  // namespace forcelayer::test
