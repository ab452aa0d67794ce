// Report descriptors from devices that are not trusted: fields or an error, never more.
#include <gtest/gtest.h>

#include "runtime/devices/hid/firmware/haptic_firmware.h"
#include "runtime/devices/hid/hid_report_descriptor.h"
#include "runtime/devices/hid/spacemouse_layout.h"
#include "tests/support/hid_descriptors.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::test {
namespace {

Descriptor haptic() {
  return {kHapticReportDescriptor, kHapticReportDescriptor + HAPTIC_REPORT_DESCRIPTOR_BYTES};
}

// Every field of a descriptor that was taken can be read from a report of its size.
void expect_usable(const Descriptor& bytes) {
  const auto parsed = devices::parse_hid_report_descriptor(bytes);
  if (!parsed) {
    EXPECT_EQ(parsed.error().code, ErrorCode::kDeviceRefused);
    EXPECT_NE(parsed.error().where.find("byte"), std::string::npos);
    return;
  }
  const bool numbered = parsed->numbered();
  for (const devices::HidField& field : parsed->fields) {
    for (const devices::HidReportSize& size : parsed->reports) {
      if (size.kind != field.kind || size.report_id != field.report_id) continue;
      std::vector<std::uint8_t> report((size.bits + 7) / 8 + (numbered ? 1 : 0), 0xff);
      if (numbered) report[0] = field.report_id;
      std::int64_t value = 0;
      EXPECT_TRUE(devices::read_hid_field(field, numbered, report, value));
      EXPECT_EQ(value, field.logical_min < 0 ? -1 : (std::int64_t{1} << field.bit_size) - 1);
    }
  }
  (void)devices::SpaceMouseLayout::from(*parsed);
}

TEST(HidReportDescriptor, KnowsTheHapticDevice) {
  const auto parsed = devices::parse_hid_report_descriptor(haptic());
  ASSERT_TRUE(parsed);
  EXPECT_EQ(parsed->applications, std::vector<std::uint32_t>{0xff46'0001});
  EXPECT_FALSE(parsed->numbered());
  ASSERT_EQ(parsed->reports.size(), 2u);
  EXPECT_EQ(parsed->reports[0].bits, 512u);
  EXPECT_EQ(parsed->reports[1].bits, 512u);
  EXPECT_EQ(parsed->fields.size(), 128u);
  EXPECT_EQ(parsed->fields[63].bit_offset, 504u);
  EXPECT_EQ(parsed->fields[63].logical_max, 255);
}

TEST(HidReportDescriptor, PushPopUsageRangesAndLongItems) {
  Descriptor d;
  add(d, {0xfe, 2, 0x10, 1, 2});  // a long item: skipped
  add(d, {0x05, 0x01, 0x09, 0x08, 0xa1, 0x01, 0x75, 0x04, 0x95, 0x03, 0xa4, 0x75, 0x08, 0xb4});
  add(d, {0x19, 0x30, 0x29, 0x32, 0x15, 0xf8, 0x25, 0x07, 0x81, 0x02});
  add(d, {0x0b, 0x01, 0x00, 0x09, 0x00, 0x95, 0x01, 0x81, 0x02, 0xc0});  // a usage with its page
  const auto parsed = devices::parse_hid_report_descriptor(d);
  ASSERT_TRUE(parsed) << to_line(parsed.error());
  ASSERT_EQ(parsed->fields.size(), 4u);
  EXPECT_EQ(parsed->fields[2].usage, devices::hid_usage(1, 0x32));
  EXPECT_EQ(parsed->fields[2].bit_offset, 8u);
  EXPECT_EQ(parsed->fields[3].usage, devices::hid_usage(9, 1));
  std::int64_t value = 0;
  const std::uint8_t report[2] = {0x7f, 0x08};
  ASSERT_TRUE(devices::read_hid_field(parsed->fields[0], false, report, value));
  EXPECT_EQ(value, -1);
  ASSERT_TRUE(devices::read_hid_field(parsed->fields[1], false, report, value));
  EXPECT_EQ(value, 7);
  ASSERT_TRUE(devices::read_hid_field(parsed->fields[2], false, report, value));
  EXPECT_EQ(value, -8);
}

TEST(HidReportDescriptor, EveryPrefixIsSafe) {
  for (const Descriptor& whole : {haptic(), separate_spacemouse(), combined_spacemouse()}) {
    for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
      expect_usable({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(bytes)});
    }
    EXPECT_TRUE(devices::parse_hid_report_descriptor(whole));
  }
}

TEST(HidReportDescriptor, DamagedAndRandomBytesAreSafe) {
  const Descriptor seeds[] = {haptic(), separate_spacemouse(), combined_spacemouse()};
  for (std::uint64_t seed = 1; seed <= 20'000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Descriptor bytes = seeds[seed % 3];
    if (seed % 5 == 0) bytes.resize(static_cast<std::size_t>(integer(random, 0, 300)));
    const auto changes =
        seed % 5 == 0 ? static_cast<std::int64_t>(bytes.size()) : integer(random, 1, 8);
    for (std::int64_t i = 0; i < changes; ++i) {
      bytes[static_cast<std::size_t>(integer(random, 0, std::int64_t(bytes.size()) - 1))] =
          static_cast<std::uint8_t>(random());
    }
    expect_usable(bytes);
  }
}

TEST(HidReportDescriptor, RefusesWhatWouldNotFit) {
  const struct {
    Descriptor bytes;
    const char* what;
  } cases[] = {
      {{0xa1}, "ends within"},
      {{0xa1, 0x01}, "does not end"},
      {{0xc0}, "ends without a beginning"},
      {{0xb4}, "Pop"},
      {{0x85, 0x00}, "report id"},
      {{0x27, 0xff}, "ends within"},
      {{0x29, 0x01, 0x19, 0x05, 0x29, 0x01}, "ends before its beginning"},
      {{0x1b, 0, 0, 0, 0, 0x2b, 0xff, 0xff, 0xff, 0xff}, "too many usages"},
      {{0x77, 0xff, 0xff, 0xff, 0xff, 0x97, 0xff, 0xff, 0xff, 0xff, 0x81, 0x02}, "too long"},
      {{0x09, 0x01, 0x75, 0x21, 0x95, 0x01, 0x81, 0x02}, "size"},
  };
  for (const auto& c : cases) {
    const auto parsed = devices::parse_hid_report_descriptor(c.bytes);
    ASSERT_FALSE(parsed) << c.what;
    EXPECT_NE(parsed.error().what.find(c.what), std::string::npos) << parsed.error().what;
  }
}

// Counting on beyond the last number that there is would never end.
TEST(HidReportDescriptor, UsagesMayEndAtTheLargestNumber) {
  const Descriptor bytes = {0x1b, 0xf0, 0xff, 0xff, 0xff, 0x2b, 0xff, 0xff, 0xff, 0xff,
                            0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x10, 0x81, 0x02};
  const auto parsed = devices::parse_hid_report_descriptor(bytes);
  ASSERT_TRUE(parsed) << to_line(parsed.error());
  ASSERT_EQ(parsed->fields.size(), 16u);
  EXPECT_EQ(parsed->fields.back().usage, 0xffffffffu);
}

}  // namespace
}  // namespace forcelayer::test
