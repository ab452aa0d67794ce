// SpaceMouse: layouts from descriptors, control, and the device on a bus in this process.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/devices/hid/spacemouse.h"
#include "tests/support/fake_hid_bus.h"
#include "tests/support/hid_descriptors.h"

namespace forcelayer::test {
namespace {

using Report = std::vector<std::uint8_t>;

Report words(int id, std::initializer_list<int> values) {
  Report report{static_cast<std::uint8_t>(id)};
  for (const int value : values) {
    report.push_back(static_cast<std::uint8_t>(value));
    report.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  return report;
}

devices::SpaceMouseLayout layout_of(const Descriptor& descriptor) {
  const auto parsed = devices::parse_hid_report_descriptor(descriptor);
  EXPECT_TRUE(parsed) << (parsed ? "" : to_line(parsed.error()));
  const auto layout = devices::SpaceMouseLayout::from(*parsed);
  EXPECT_TRUE(layout);
  return *layout;
}

TEST(SpaceMouseLayout, ReadsSeparateReports) {
  const devices::SpaceMouseLayout layout = layout_of(separate_spacemouse());
  devices::SpaceMouseReading reading;
  EXPECT_TRUE(layout.take(words(1, {350, -175, 0}), reading));
  EXPECT_TRUE(layout.take(words(2, {0, -30, 700}), reading));
  EXPECT_EQ(reading.deflection, (std::array<double, 6>{1, -0.5, 0, 0, -30 / 350.0, 1}));
  EXPECT_FALSE(layout.take(Report{3, 2, 0}, reading));
  EXPECT_EQ(reading.buttons, 2u);
  EXPECT_FALSE(layout.take(Report{3, 1, 0xff}, reading));  // padding is no button
  EXPECT_EQ(reading.buttons, 1u);
  EXPECT_EQ(layout.led_report(true), (Report{4, 1}));
  EXPECT_EQ(layout.led_report(false), (Report{4, 0}));
}

TEST(SpaceMouseLayout, ReadsTheCombinedReport) {
  const devices::SpaceMouseLayout layout = layout_of(combined_spacemouse());
  devices::SpaceMouseReading reading;
  EXPECT_TRUE(layout.take(words(1, {35, 70, 105, -140, -175, -210}), reading));
  EXPECT_EQ(reading.deflection, (std::array<double, 6>{0.1, 0.2, 0.3, -0.4, -0.5, -0.6}));
  EXPECT_FALSE(layout.take(Report{3, 0x01, 0x40}, reading));
  EXPECT_EQ(reading.buttons, 0x4001u);
}

TEST(SpaceMouseLayout, ShortAndForeignReportsChangeNothing) {
  const devices::SpaceMouseLayout layout = layout_of(combined_spacemouse());
  devices::SpaceMouseReading reading;
  reading.deflection[2] = 0.5;
  for (const Report& report :
       {Report{}, Report{1}, Report{9, 1, 2, 3, 4, 5, 6, 7, 8}, Report{2, 1, 1}}) {
    EXPECT_FALSE(layout.take(report, reading));
  }
  EXPECT_EQ(reading.deflection, (std::array<double, 6>{0, 0, 0.5}));
  EXPECT_TRUE(layout.take(words(1, {350}), reading));  // what a cut report still holds
  EXPECT_EQ(reading.deflection, (std::array<double, 6>{1, 0, 0.5}));
}

TEST(SpaceMouseLayout, RefusesWhatHasNotSixAxes) {
  Descriptor d;
  add(d, {0x05, 0x01, 0x09, 0x08, 0xa1, 0x01});
  add_axes(d, 1, 0x30, 5, 0x02);
  add(d, {0xc0});
  auto parsed = devices::parse_hid_report_descriptor(d);
  ASSERT_TRUE(parsed);
  const auto layout = devices::SpaceMouseLayout::from(*parsed);
  ASSERT_FALSE(layout);
  EXPECT_EQ(layout.error().code, ErrorCode::kDeviceRefused);
  EXPECT_NE(layout.error().what.find("Rz"), std::string::npos);
  Descriptor joystick = combined_spacemouse();
  joystick[3] = 0x04;
  parsed = devices::parse_hid_report_descriptor(joystick);
  ASSERT_TRUE(parsed);
  EXPECT_FALSE(devices::SpaceMouseLayout::from(*parsed));
}

TEST(SpaceMouseMotion, RateControlMovesAlongTheAxesThatTheHandSees) {
  devices::SpaceMouseOptions options;
  options.dead_zone = 0.1;
  devices::SpaceMouseMotion motion(options);
  // Fully towards the user, half way down, within the dead zone to the right.
  for (int i = 0; i < 1000; ++i) motion.advance({0.1, 1, 0.55}, 0.001);
  EXPECT_EQ(motion.velocity().linear_mps.x, 0);
  EXPECT_NEAR(motion.velocity().linear_mps.y, -0.1, 1e-12);   // away is positive
  EXPECT_NEAR(motion.velocity().linear_mps.z, -0.05, 1e-12);  // up is positive
  // A second less the smoothing's lag of 20 ms.
  EXPECT_NEAR(motion.device_from_handle().position_m.y, -0.1 * (1 - 0.0195), 1e-5);
  for (int i = 0; i < 1000; ++i) motion.advance({}, 0.001);
  EXPECT_EQ(motion.velocity().linear_mps, glm::dvec3(0));  // exactly: what it holds can rest
  EXPECT_NEAR(motion.device_from_handle().position_m.y, -0.1, 1e-5);
}

TEST(SpaceMouseMotion, TurnsAboutTheAxesThatTheHandSees) {
  devices::SpaceMouseOptions options;
  options.dead_zone = 0;
  devices::SpaceMouseMotion motion(options);
  for (int i = 0; i < 500; ++i) motion.advance({0, 0, 0, 0, -1, 0}, 0.001);  // right side down
  const glm::dvec3 right = motion.device_from_handle().orientation * glm::dvec3(1, 0, 0);
  EXPECT_LT(right.z, -0.4);
  EXPECT_NEAR(right.y, 0, 1e-12);
  EXPECT_NEAR(motion.velocity().angular_radps.y, 1, 1e-9);
}

TEST(SpaceMouseMotion, PositionControlGoesBackWhenReleased) {
  devices::SpaceMouseOptions options;
  options.control = devices::SpaceMouseControl::kPosition;
  options.dead_zone = 0;
  devices::SpaceMouseMotion motion(options);
  glm::dvec3 last(0);
  for (int i = 0; i < 500; ++i) {
    motion.advance({1, 0, 0, 0, 0, -0.5}, 0.001);
    const glm::dvec3 now = motion.device_from_handle().position_m;
    EXPECT_LT(glm::length((now - last) / 0.001 - motion.velocity().linear_mps), 1e-12);
    last = now;
  }
  EXPECT_NEAR(last.x, 0.05, 1e-9);
  EXPECT_NEAR(coupling::rotation_vector(motion.device_from_handle().orientation).z, 0.4, 1e-9);
  for (int i = 0; i < 1000; ++i) motion.advance({}, 0.001);
  EXPECT_EQ(motion.device_from_handle().position_m, glm::dvec3(0));
}

TEST(SpaceMouse, FollowsItsReportsLightsUpAndLetsGoOfASilentCap) {
  auto socket = std::make_shared<FakeSocket>();
  socket->descriptor = separate_spacemouse();
  socket->info = {"/dev/fake1", 0x046d, 0xc626, "", "SpaceNavigator", devices::kMultiAxisUsage};
  std::mutex mutex;
  std::vector<Report> written;
  socket->on_write = [&](std::span<const std::uint8_t> report) {
    const std::lock_guard lock(mutex);
    written.emplace_back(report.begin(), report.end());
  };
  devices::SpaceMouse mouse(std::make_unique<FakeHidBus>(std::vector{socket}), {}, {});
  ASSERT_TRUE(mouse.start());
  EXPECT_EQ(mouse.capabilities().actuated_axes, 0u);
  double time_s = 0;
  DeviceSample sample;
  // The loop's time is made here; only the reports' way through the thread takes real time.
  const auto until = [&](auto done, const Report& report) {
    for (int i = 0; i < 5000; ++i) {
      if (!report.empty() && i % 8 == 0) socket->send(report);
      machine::sleep_until_ns(machine::monotonic_ns() + 1'000'000);
      sample = mouse.read(time_s += 0.001);
      if (done()) return true;
    }
    return false;
  };
  EXPECT_TRUE(until([&] { return sample.velocity.linear_mps.x > 0.09; }, words(1, {350, 0, 0})));
  EXPECT_TRUE(sample.present && sample.fresh);
  EXPECT_TRUE(until([&] { return sample.buttons == 3; }, Report{3, 3, 0}));
  // No more reports of axes: after a quarter of a second the cap counts as released.
  EXPECT_TRUE(until([&] { return sample.velocity.linear_mps.x == 0; }, {}));
  socket->plug(false);
  EXPECT_TRUE(until([&] { return !sample.present; }, {}));
  EXPECT_EQ(mouse.trouble().what, "the device was unplugged");
  socket->plug(true);
  EXPECT_TRUE(until([&] { return sample.present; }, {}));
  mouse.stop();
  const std::lock_guard lock(mutex);
  ASSERT_EQ(written.size(), 3u);  // on, on again, off
  EXPECT_EQ(written[0], (Report{4, 1}));
  EXPECT_EQ(written[1], (Report{4, 1}));
  EXPECT_EQ(written[2], (Report{4, 0}));
}

}  // namespace
}  // namespace forcelayer::test
