// Reads HID report descriptors (Device Class Definition for HID 1.11, section 6.2.2): which bits of
// which report mean what. Made for untrusted input: any bytes give fields or an error.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/result.h"

namespace forcelayer::devices {

enum class HidReportKind : std::uint8_t { kInput, kOutput, kFeature };

// One value of a report. Constant fields (padding) are not listed.
struct HidField {
  HidReportKind kind = HidReportKind::kInput;
  std::uint8_t report_id = 0;     // 0: the device's reports are not numbered
  std::uint32_t bit_offset = 0;   // in the report, after the id's byte where there is one
  std::uint32_t bit_size = 0;     // 1 to 32
  std::uint32_t usage = 0;        // page in the upper, usage in the lower 16 bits
  std::uint32_t application = 0;  // the same of the application collection that it stands in
  std::int64_t logical_min = 0;
  std::int64_t logical_max = 0;
};

struct HidReportSize {
  HidReportKind kind = HidReportKind::kInput;
  std::uint8_t report_id = 0;
  std::uint32_t bits = 0;  // padding included, the id's byte not
};

struct HidReportDescriptor {
  std::vector<std::uint32_t> applications;  // usages of the application collections, in order
  std::vector<HidField> fields;             // in the descriptor's order
  std::vector<HidReportSize> reports;       // each report once

  bool numbered() const;  // reports start with a byte of id
};

constexpr std::uint32_t hid_usage(std::uint32_t page, std::uint32_t usage) {
  return page << 16 | usage;
}

// Errors: kDeviceRefused with the byte at which the descriptor makes no sense.
Result<HidReportDescriptor> parse_hid_report_descriptor(std::span<const std::uint8_t> bytes);

// The field's value in `report`, which begins with the id's byte where reports are numbered
// (`numbered`). Sign-extended where the logical minimum is negative. False where the report is too
// short or another one.
bool read_hid_field(const HidField& field, bool numbered, std::span<const std::uint8_t> report,
                    std::int64_t& value) noexcept;

}  // namespace forcelayer::devices
