// The HID devices over a real kernel and the packaged hidapi. Runs inside the virtual machine of
// run_in_vm.sh, as root, with /dev/uhid; what is judged is the order of events, never the time.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "runtime/devices/hid/hid_device.h"
#include "runtime/devices/hid/spacemouse.h"
#include "tests/hid_vm/uhid_device.h"
#include "tests/support/hid_descriptors.h"

namespace forcelayer::test {
namespace {

using Fault = VirtualHapticDevice::Fault;
constexpr long long kMs = 1'000'000;
constexpr int kPatienceMs = 20'000;

// A host that reads and writes once a millisecond until `done`.
template <typename Done>
bool host_runs(devices::Device& host, const Wrench& wrench, DeviceSample& sample, Done done) {
  static double time_s = 0;
  long long tick_ns = machine::monotonic_ns();
  for (int i = 0; i < kPatienceMs; ++i) {
    tick_ns = std::max(tick_ns + kMs, machine::monotonic_ns() - kMs);
    machine::sleep_until_ns(tick_ns);
    sample = host.read(time_s += 0.001);
    host.write(wrench);
    if (done()) return true;
  }
  return false;
}

// udev and the driver take their time to show what was plugged in.
Status start_soon(devices::Device& device) {
  Status status = device.start();
  for (int i = 0; i < 100 && !status && status.error().code == ErrorCode::kDeviceNotFound; ++i) {
    machine::sleep_until_ns(machine::monotonic_ns() + 20 * kMs);
    status = device.start();
  }
  return status;
}

struct HidVm : testing::Test {
  void SetUp() override {
    unit.plug();
    ASSERT_TRUE(unit.created()) << "no /dev/uhid?";
  }
  void felt() {
    const Status started = start_soon(host);
    ASSERT_TRUE(started) << to_line(started.error());
    ASSERT_TRUE(host_runs(host, {}, sample, [&] { return sample.present && !sample.output_held; }));
    ASSERT_TRUE(host_runs(host, push, sample, [&] { return !is_zero(unit.device.motors()); }));
  }

  UhidHapticUnit unit;
  devices::HidDevice host{devices::make_hid_bus(), {}};
  DeviceSample sample;
  const Wrench push{{1, -2, 3}, {0.01, 0, 0}};
};

TEST_F(HidVm, IsFoundByUsageNameSerialAndPath) {
  const Status started = start_soon(host);
  ASSERT_TRUE(started) << to_line(started.error());
  host.stop();
  const auto bus = devices::make_hid_bus();
  const auto found = devices::find_hid_device(*bus, {}, {}, devices::kHapticUsage, "device");
  ASSERT_TRUE(found) << to_line(found.error());
  EXPECT_EQ(found->vendor, UhidHapticUnit::kVendor);
  EXPECT_EQ(found->product, UhidHapticUnit::kProduct);
  EXPECT_EQ(found->serial, "VM-1");
  EXPECT_EQ(found->product_name, "Forcelayer virtual haptic device");
  EXPECT_EQ(found->usage, devices::kHapticUsage);
  for (const std::string& name :
       {std::string("16c0:0486"), std::string("16c0:486:VM-1"), found->path}) {
    devices::HidDevice named(devices::make_hid_bus(), *devices::parse_hid_selector(name));
    const Status status = named.start();
    EXPECT_TRUE(status) << name << ": " << to_line(status.error());
  }
  devices::HidDevice other(devices::make_hid_bus(), *devices::parse_hid_selector("16c0:0486:VM-2"));
  EXPECT_EQ(other.start().error().code, ErrorCode::kDeviceNotFound);
}

TEST_F(HidVm, AnswersEveryReportOfAOneKilohertzStream) {
  felt();
  const std::uint64_t before = host.statistics().states, gaps = host.statistics().gaps;
  const std::size_t logged = unit.device.log().size();
  std::uint64_t fresh = 0;
  std::uint32_t first = 0, last = 0;
  ASSERT_TRUE(host_runs(host, push, sample, [&] {
    fresh += sample.fresh;
    if (first == 0) first = static_cast<std::uint32_t>(sample.sequence);
    last = static_cast<std::uint32_t>(sample.sequence);
    return fresh == 5000;
  }));
  const devices::HidStatistics statistics = host.statistics();
  host.stop();
  std::vector<bool> answered(last - first + 1);
  const auto log = unit.device.log();
  for (std::size_t i = logged; i < log.size(); ++i) {
    if (log[i].answers - first < answered.size()) answered[log[i].answers - first] = true;
  }
  const auto answers = std::count(answered.begin(), answered.end(), true);
  std::printf(
      "stream: %llu states, %llu gaps, %lld of %zu states answered, longest write %.2f ms\n",
      static_cast<unsigned long long>(statistics.states - before),
      static_cast<unsigned long long>(statistics.gaps - gaps), static_cast<long long>(answers),
      answered.size(), static_cast<double>(statistics.longest_write_ns) * 1e-6);
  EXPECT_EQ(statistics.malformed, 0u);
  EXPECT_EQ(unit.device.refused(), 0u);
  EXPECT_EQ(statistics.gaps, gaps);
  EXPECT_GE(answers, static_cast<long long>(answered.size()) * 99 / 100);
}

TEST_F(HidVm, AnUnpluggedDeviceIsZeroAndComesBackFromZero) {
  felt();
  unit.unplug();
  ASSERT_TRUE(host_runs(host, push, sample, [&] {
    return !sample.present && host.trouble().what == "the device was unplugged";
  })) << host.trouble().what;
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return unit.device.watchdog_holds(); }));
  const std::size_t logged = unit.device.log().size();
  unit.plug();
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return sample.present && sample.fresh; }))
      << host.trouble().what;
  ASSERT_TRUE(sample.output_held);
  for (int i = 0; i < 100; ++i) host_runs(host, push, sample, [] { return true; });
  ASSERT_TRUE(host_runs(host, {}, sample, [&] { return !sample.output_held; }));
  ASSERT_TRUE(host_runs(host, push, sample, [&] { return !is_zero(unit.device.motors()); }));
  // At the device's side: nothing but zero until the host's loop had been at zero.
  const auto log = unit.device.log();
  std::size_t zeros = 0;
  for (std::size_t i = logged; i < log.size() && is_zero(log[i].motors); ++i) ++zeros;
  EXPECT_GE(zeros, 50u);
}

TEST_F(HidVm, AFrozenDeviceGivesNoFreshPoseAndItsReason) {
  felt();
  const struct {
    Fault fault;
    const char* reason;
  } cases[] = {{Fault::kSilent, "sends no reports"},
               {Fault::kRepeating, "repeats its reports"},
               {Fault::kDamaged, "are damaged"}};
  for (const auto& c : cases) {
    unit.device.set_fault(c.fault);
    ASSERT_TRUE(host_runs(
        host, push, sample,
        [&] { return !sample.present && host.trouble().what.find(c.reason) != std::string::npos; }))
        << c.reason << ", but " << host.trouble().what;
    unit.device.set_fault(Fault::kNone);
    ASSERT_TRUE(host_runs(host, {}, sample, [&] { return sample.present && !sample.output_held; }))
        << c.reason << ": " << host.trouble().what;
    ASSERT_TRUE(host_runs(host, push, sample, [&] { return !is_zero(unit.device.motors()); }));
  }
}

TEST_F(HidVm, ALoopThatStandsStillIsFadedOut) {
  felt();
  machine::sleep_until_ns(machine::monotonic_ns() + 200 * kMs);
  EXPECT_TRUE(is_zero(unit.device.motors()));
  sample = host.read(0);
  EXPECT_TRUE(sample.output_held);
}

TEST(HidVmStart, RefusesAWrongDescriptor) {
  Descriptor wrong(kHapticReportDescriptor,
                   kHapticReportDescriptor + HAPTIC_REPORT_DESCRIPTOR_BYTES);
  wrong[15] = 0x20;  // reports of 32 bytes
  const UhidDevice device({"Not haptic", "VM-9", 0x16c0, 0x0487}, wrong, [](auto) {});
  ASSERT_TRUE(device.created());
  devices::HidDevice host(devices::make_hid_bus(), {0x16c0, 0x0487, "", ""});
  const Status status = start_soon(host);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kDeviceRefused);
  EXPECT_NE(to_line(status.error()).find("report descriptor"), std::string::npos);
  std::printf("refusal: %s\n", to_line(status.error()).c_str());
  devices::HidDevice silent(devices::make_hid_bus(), {});  // by its usage it looks right
  EXPECT_EQ(silent.start().error().code, ErrorCode::kDeviceRefused);
}

void follow(const UhidIdentity& identity, const Descriptor& descriptor,
            const std::vector<std::vector<std::uint8_t>>& deflected,
            const std::vector<std::vector<std::uint8_t>>& released) {
  std::mutex mutex;
  std::vector<std::vector<std::uint8_t>> written;
  auto device = std::make_unique<UhidDevice>(identity, descriptor, [&](auto report) {
    const std::lock_guard lock(mutex);
    written.emplace_back(report.begin(), report.end());
  });
  ASSERT_TRUE(device->created());
  devices::SpaceMouse mouse(devices::make_hid_bus(), {}, {});
  const Status started = start_soon(mouse);
  ASSERT_TRUE(started) << to_line(started.error());
  DeviceSample sample;
  int n = 0;
  const auto sending = [&](const std::vector<std::vector<std::uint8_t>>& reports, auto done) {
    return host_runs(mouse, {}, sample, [&] {
      if (n++ % 8 == 0) device->send(reports[static_cast<std::size_t>(n / 8) % reports.size()]);
      return done();
    });
  };
  // Half to the right, fully down; turned about the vertical.
  EXPECT_TRUE(sending(deflected,
                      [&] {
                        const Twist& v = sample.velocity;
                        return std::abs(v.linear_mps.x - 0.1 * (0.5 - 0.05) / 0.95) < 1e-3 &&
                               std::abs(v.linear_mps.z + 0.1) < 1e-3 &&
                               std::abs(v.angular_radps.z - 1) < 1e-2;
                      }))
      << sample.velocity.linear_mps.x << " " << sample.velocity.linear_mps.z;
  EXPECT_EQ(sample.velocity.linear_mps.y, 0);
  EXPECT_TRUE(sending(released, [&] {
    return sample.velocity.linear_mps == glm::dvec3(0) && sample.buttons == 2;
  }));
  EXPECT_GT(sample.device_from_handle.position_m.x, 0);
  EXPECT_LT(sample.device_from_handle.position_m.z, 0);
  device.reset();
  EXPECT_TRUE(host_runs(mouse, {}, sample, [&] { return !sample.present; }));
  device = std::make_unique<UhidDevice>(identity, descriptor, [](auto) {});
  EXPECT_TRUE(host_runs(mouse, {}, sample, [&] { return sample.present; })) << mouse.trouble().what;
  mouse.stop();
  const std::lock_guard lock(mutex);
  ASSERT_GE(written.size(), 1u);
  EXPECT_EQ(written[0], (std::vector<std::uint8_t>{4, 1}));  // its LED
}

// 175 = 0x00af, 350 = 0x015e, -350 = 0xfea2.
TEST(SpaceMouseVm, FollowsSeparateReports) {
  follow({"SpaceNavigator", "", 0x046d, 0xc626}, separate_spacemouse(),
         {{1, 0xaf, 0, 0, 0, 0x5e, 1}, {2, 0, 0, 0, 0, 0xa2, 0xfe}},
         {{1, 0, 0, 0, 0, 0, 0}, {2, 0, 0, 0, 0, 0, 0}, {3, 2, 0}});
}

TEST(SpaceMouseVm, FollowsTheCombinedReport) {
  follow({"SpaceMouse Pro", "", 0x256f, 0xc635}, combined_spacemouse(),
         {{1, 0xaf, 0, 0, 0, 0x5e, 1, 0, 0, 0, 0, 0xa2, 0xfe}},
         {{1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {3, 2, 0}});
}

}  // namespace
}  // namespace forcelayer::test
