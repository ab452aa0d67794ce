// The hid device against the reference firmware on a bus in this process. The clock is the
// machine's, so that limits on time are generous here: what is judged is the order of events.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/devices/hid/hid_device.h"
#include "tests/support/fake_hid_bus.h"

namespace forcelayer::test {
namespace {

using Fault = VirtualHapticDevice::Fault;
constexpr long long kMs = 1'000'000;

// A host that reads and writes once a millisecond until `done`, for ten seconds at most.
template <typename Done>
bool host_runs(devices::HidDevice& host, const Wrench& wrench, DeviceSample& sample, Done done) {
  const long long begin_ns = machine::monotonic_ns();
  for (long long tick_ns = begin_ns; tick_ns < begin_ns + 10'000 * kMs; tick_ns += kMs) {
    machine::sleep_until_ns(tick_ns);
    sample = host.read(0);
    host.write(wrench);
    EXPECT_EQ(host.capabilities().max_force_n, 12);  // the loop looks at them in every frame
    if (done()) return true;
  }
  return false;
}

struct HidDeviceTest : testing::Test {
  // Starts the host, and brings it to where its wrench is on the motors.
  void felt(const Wrench& wrench) {
    ASSERT_TRUE(host.start());
    ASSERT_TRUE(host_runs(host, {}, sample, [&] { return sample.present && !sample.output_held; }));
    ASSERT_TRUE(host_runs(host, wrench, sample, [&] { return !is_zero(unit.device.motors()); }));
  }

  HidDeviceTest() { unit.run(); }

  FakeHapticUnit unit;
  devices::HidDevice host{std::make_unique<FakeHidBus>(std::vector{unit.socket}), {}};
  DeviceSample sample;
  const Wrench push{{1.25, -0.5, 3}, {0.01, 0, -0.02}};
};

TEST_F(HidDeviceTest, CarriesPosesInAndWrenchesOut) {
  const Pose pose{{0.012345678, -0.1, 0.25}, glm::normalize(glm::dquat(0.8, 0.2, -0.4, 0.1))};
  unit.device.set_hand([pose](double) { return pose; });
  felt(push);
  EXPECT_EQ(host.capabilities().max_force_n, 12);
  EXPECT_EQ(host.capabilities().max_torque_nm, 0.2);
  EXPECT_EQ(host.capabilities().watchdog_s, 0.02);
  EXPECT_TRUE(host.capabilities().hardware);
  EXPECT_TRUE(sample.calibrated);
  EXPECT_LT(glm::length(sample.device_from_handle.position_m - pose.position_m), 1e-8);
  EXPECT_NEAR(glm::dot(sample.device_from_handle.orientation, pose.orientation), 1, 1e-9);
  // A host that was late is faded in again.
  HapticWrench motors{};
  ASSERT_TRUE(host_runs(host, push, sample, [&] {
    motors = unit.device.motors();
    return motors.force_un[0] == 1'250'000;
  }));
  EXPECT_EQ(motors.force_un[1], -500'000);
  EXPECT_EQ(motors.torque_unm[2], -20'000);
  int fresh = 0;
  host_runs(host, push, sample, [&] { return (fresh += sample.fresh) == 200; });
  host.stop();
  EXPECT_TRUE(is_zero(unit.device.motors()));  // at once: stop() says so itself
  EXPECT_EQ(unit.device.refused(), 0u);
  const devices::HidStatistics statistics = host.statistics();
  EXPECT_GE(statistics.states, 200u);
  EXPECT_EQ(statistics.malformed, 0u);
}

// Nothing here depends on how busy the machine is: where it stood still for so long that reports
// found no room or the connection was given up, the burst is sent again.
TEST_F(HidDeviceTest, TakesTheNewestOfManyAndCountsWhatItMissed) {
  std::atomic<std::uint32_t> report{0};
  unit.device.set_hand([&](double) { return Pose{{++report * 1e-8, 0, 0}, {1, 0, 0, 0}}; });
  felt(push);
  const auto number = [&] {
    return static_cast<std::uint32_t>(std::lround(sample.device_from_handle.position_m.x * 1e8));
  };
  for (int attempt = 0; attempt < 20; ++attempt) {
    const devices::HidStatistics before = host.statistics();
    const std::uint64_t lost = unit.socket->lost();
    const std::uint32_t first = report + 1;
    unit.burst();
    std::vector<std::uint32_t> seen{number()};
    ASSERT_TRUE(host_runs(host, push, sample, [&] {
      if (sample.fresh) seen.push_back(number());
      return !unit.bursting() && report > first + FakeHapticUnit::kBurst + 10 && sample.fresh &&
             number() + 5 > report;
    }));
    if (host.statistics().losses != before.losses || unit.socket->lost() != lost) continue;
    EXPECT_EQ(host.statistics().gaps - before.gaps, FakeHapticUnit::kBurstLost);
    // In order, and of the burst at most the last: what a newer one overtook is not handed over.
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    std::uint32_t largest_step = 0;
    for (std::size_t i = 1; i < seen.size(); ++i) {
      largest_step = std::max(largest_step, seen[i] - seen[i - 1]);
    }
    EXPECT_GE(largest_step, FakeHapticUnit::kBurst - 1);
    return;
  }
  FAIL() << "the machine stood still again and again";
}

TEST_F(HidDeviceTest, AnUnpluggedDeviceIsZeroAndComesBackFromZero) {
  felt(push);
  unit.socket->plug(false);
  ASSERT_TRUE(host_runs(host, push, sample, [&] {
    return !sample.present && host.trouble().what == "the device was unplugged";
  })) << host.trouble().what;
  // The device's own watchdog: nobody tells it anything any more.
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return unit.device.watchdog_holds(); }));
  EXPECT_TRUE(is_zero(unit.device.motors()));
  unit.socket->plug(true);
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return sample.present && sample.fresh; }));
  // The host that goes on pushing is not felt before it has been at zero.
  EXPECT_TRUE(sample.output_held);
  for (int i = 0; i < 50; ++i) {
    machine::sleep_until_ns(machine::monotonic_ns() + kMs);
    host.write(push);
    ASSERT_TRUE(is_zero(unit.device.motors()));
  }
  ASSERT_TRUE(host_runs(host, {}, sample, [&] { return !sample.output_held; }));
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return !is_zero(unit.device.motors()); }));
  EXPECT_GE(host.statistics().losses, 1u);
}

TEST_F(HidDeviceTest, AFrozenDeviceGivesNoFreshPoseAndItsReason) {
  const struct {
    Fault fault;
    const char* reason;
  } cases[] = {{Fault::kSilent, "sends no reports"},
               {Fault::kRepeating, "repeats its reports"},
               {Fault::kClockStill, "repeats its reports"},
               {Fault::kDamaged, "are damaged"}};
  felt(push);
  for (const auto& c : cases) {
    unit.device.set_fault(c.fault);
    int fresh_after = 0;
    ASSERT_TRUE(host_runs(host, push, sample,
                          [&] {
                            fresh_after += sample.fresh;
                            return !sample.present &&
                                   host.trouble().what.find(c.reason) != std::string::npos;
                          }))
        << c.reason << ", but " << host.trouble().what;
    EXPECT_LE(fresh_after, 3) << c.reason;  // what was on its way
    unit.device.set_fault(Fault::kNone);
    ASSERT_TRUE(host_runs(host, {}, sample, [&] { return sample.present && !sample.output_held; }))
        << c.reason << ": " << host.trouble().what;
    ASSERT_TRUE(host_runs(host, push, sample, [&] { return !is_zero(unit.device.motors()); }));
  }
}

TEST_F(HidDeviceTest, AFaultThatTheDeviceReportsTakesItAway) {
  felt(push);
  unit.device.set_fault(Fault::kReported);
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return !sample.present; }));
  EXPECT_EQ(host.trouble().what, "the device reports a fault");
  EXPECT_TRUE(is_zero(unit.device.motors()));
}

TEST_F(HidDeviceTest, ALoopThatStandsStillIsFadedOut) {
  felt(push);
  machine::sleep_until_ns(machine::monotonic_ns() + 100 * kMs);  // no write()
  EXPECT_TRUE(is_zero(unit.device.motors()));
  bool fading = false;
  for (const auto& taken : unit.device.log()) fading |= (taken.flags & 2) != 0;
  EXPECT_TRUE(fading);  // the host's side did it, not only the device's watchdog
  sample = host.read(0);
  EXPECT_TRUE(sample.output_held);
}

TEST_F(HidDeviceTest, AHostThatSleepsIsSeenByTheDevicesWatchdog) {
  felt(push);
  auto write = unit.socket->on_write;
  std::atomic<bool> asleep{true};
  unit.socket->on_write = [&](std::span<const std::uint8_t> report) {
    if (!asleep) write(report);
  };
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return unit.device.watchdog_holds(); }));
  EXPECT_TRUE(is_zero(unit.device.motors()));
  // It is there and sends poses; it is its motors that it took away.
  ASSERT_TRUE(host_runs(host, push, sample, [&] {
    return sample.output_held && host.trouble().what == "the device's watchdog tripped";
  }));
  EXPECT_NE(host.trouble().mend.find("doctor"), std::string::npos);
  EXPECT_TRUE(sample.present);
  asleep = false;
  for (int i = 0; i < 30; ++i) {
    machine::sleep_until_ns(machine::monotonic_ns() + kMs);
    host.write(push);
    ASSERT_TRUE(is_zero(unit.device.motors()));
  }
  ASSERT_TRUE(host_runs(host, {}, sample, [&] { return !sample.output_held; }));
  host.stop();
}

TEST(HidDeviceStart, RefusesWhatIsNoSoundHapticDevice) {
  const auto start = [](const HapticDeviceRatings& ratings, Fault fault, auto change) {
    FakeHapticUnit unit(ratings);
    unit.device.set_fault(fault);
    change(*unit.socket);
    unit.run();
    devices::HidDevice host(std::make_unique<FakeHidBus>(std::vector{unit.socket}),
                            {0x16c0, 0x0486, "", ""});
    const Status status = host.start();
    EXPECT_FALSE(status);
    return status.ok() ? Error{} : status.error();
  };
  const auto as_it_is = [](FakeSocket&) {};
  const auto expect = [](const Error& error, ErrorCode code, const char* what) {
    EXPECT_EQ(error.code, code) << to_line(error);
    EXPECT_NE(error.what.find(what), std::string::npos) << to_line(error);
    EXPECT_NE(error.file.find("16c0:0486"), std::string::npos) << to_line(error);
    EXPECT_NE(error.mend, "");
  };
  const HapticDeviceRatings sound = virtual_ratings();
  expect(start(sound, Fault::kNone, [](FakeSocket& s) { s.descriptor[1] = 0x00; }),
         ErrorCode::kDeviceRefused, "descriptor");
  expect(start(sound, Fault::kNone, [](FakeSocket& s) { s.descriptor[15] = 0x20; }),
         ErrorCode::kDeviceRefused, "descriptor");
  expect(start(sound, Fault::kNone, [](FakeSocket& s) { s.descriptor.resize(9); }),
         ErrorCode::kDeviceRefused, "descriptor");
  HapticDeviceRatings ratings = sound;
  ratings.watchdog_us = 0;
  expect(start(ratings, Fault::kNone, as_it_is), ErrorCode::kDeviceRefused, "watchdog");
  ratings = sound;
  ratings.watchdog_us = 200'000;
  expect(start(ratings, Fault::kNone, as_it_is), ErrorCode::kDeviceRefused, "watchdog");
  ratings = sound;
  ratings.sensed_axes = 7;
  expect(start(ratings, Fault::kNone, as_it_is), ErrorCode::kDeviceRefused, "six axes");
  ratings = sound;
  ratings.rate_mhz = 49'000;
  expect(start(ratings, Fault::kNone, as_it_is), ErrorCode::kDeviceRefused, "ratings");
  ratings = sound;
  ratings.delay_us = 1'100'000;  // which no device in a hand has (forcelayer/ranges.h)
  expect(start(ratings, Fault::kNone, as_it_is), ErrorCode::kDeviceRefused, "ratings");
  ratings = sound;
  ratings.workspace_radius_um = 1'001'000'000;
  expect(start(ratings, Fault::kNone, as_it_is), ErrorCode::kDeviceRefused, "ratings");
  ratings = sound;
  ratings.max_force_un = 0;
  expect(start(ratings, Fault::kNone, as_it_is), ErrorCode::kDeviceRefused, "ratings");
  expect(start(sound, Fault::kSilent, as_it_is), ErrorCode::kDeviceFailed,
         "does not send its capabilities");
  expect(start(sound, Fault::kDamaged, as_it_is), ErrorCode::kDeviceFailed, "are damaged");
  expect(start(sound, Fault::kReported, as_it_is), ErrorCode::kDeviceFailed, "fault");
}

TEST(HidSelection, FindsByUsageNameSerialAndPath) {
  const auto socket = [](const char* path, std::uint16_t product, const char* serial,
                         std::uint32_t usage) {
    auto made = std::make_shared<FakeSocket>();
    made->info = {path, 0x16c0, product, serial, "unit", usage};
    return made;
  };
  FakeHidBus bus({socket("/dev/h0", 1, "a", 0x0001'0006),
                  socket("/dev/h1", 2, "b", devices::kHapticUsage),
                  socket("/dev/h2", 3, "c", devices::kHapticUsage), socket("/dev/h3", 3, "d", 1)});
  const auto find = [&](const char* text) {
    const auto selector = devices::parse_hid_selector(text);
    EXPECT_TRUE(selector) << text;
    return devices::find_hid_device(bus, *selector, {}, devices::kHapticUsage, "device");
  };
  EXPECT_EQ(find("16c0:0002")->path, "/dev/h1");
  EXPECT_EQ(find("16C0:3:d")->path, "/dev/h3");
  EXPECT_EQ(find("16c0:3")->path, "/dev/h2");  // the right usage before the wrong one
  EXPECT_EQ(find("/dev/h0")->path, "/dev/h0");
  EXPECT_EQ(find("16c0:9").error().code, ErrorCode::kDeviceNotFound);
  EXPECT_EQ(find("/dev/none").error().code, ErrorCode::kDeviceNotFound);
  const auto any = devices::find_hid_device(bus, {}, {}, devices::kHapticUsage, "device");
  EXPECT_EQ(any.error().code, ErrorCode::kUsage);
  EXPECT_NE(any.error().what.find("/dev/h2"), std::string::npos);
  for (const char* text : {"", "16c0", ":", "16c0:", "16c0:12345", "0x16:1", "16c0:-1", "dev"}) {
    EXPECT_FALSE(devices::parse_hid_selector(text)) << text;
  }
}

}  // namespace
}  // namespace forcelayer::test
