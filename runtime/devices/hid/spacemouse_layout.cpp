#include "runtime/devices/hid/spacemouse_layout.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::devices {
namespace {

constexpr std::uint32_t kFirstAxis = hid_usage(0x01, 0x30);  // X; then Y Z Rx Ry Rz
constexpr std::uint32_t kButtonPage = 0x09, kMaxButtons = 32;
constexpr std::uint32_t kIndicator = hid_usage(0x08, 0x4b);  // LED page, Generic Indicator

const char* const kAxisNames[6] = {"X", "Y", "Z", "Rx", "Ry", "Rz"};

}  // namespace

Result<SpaceMouseLayout> SpaceMouseLayout::from(const HidReportDescriptor& descriptor) {
  SpaceMouseLayout layout;
  layout.numbered_ = descriptor.numbered();
  std::array<bool, 6> found{};
  for (const HidField& field : descriptor.fields) {
    if (field.application != kMultiAxisUsage) continue;
    const std::uint32_t axis = field.usage - kFirstAxis;
    const bool input = field.kind == HidReportKind::kInput;
    if (input && axis < 6 && !found[axis] && field.logical_max > 0 && field.logical_min < 0) {
      layout.axes_[axis] = field;
      found[axis] = true;
    } else if (input && field.usage >> 16 == kButtonPage && field.bit_size == 1) {
      layout.buttons_.push_back(field);
    } else if (field.kind == HidReportKind::kOutput && field.usage == kIndicator && !layout.led_) {
      layout.led_ = field;
    }
  }
  for (int axis = 0; axis < 6; ++axis) {
    if (found[axis]) continue;
    return Error{ErrorCode::kDeviceRefused, "", "report descriptor",
                 std::string("has no axis ") + kAxisNames[axis] + " of a multi-axis controller",
                 "check that it is the right device"};
  }
  for (const HidReportSize& report : descriptor.reports) {
    if (layout.led_ && report.kind == HidReportKind::kOutput &&
        report.report_id == layout.led_->report_id) {
      layout.led_report_bits_ = report.bits;
    }
  }
  return layout;
}

bool SpaceMouseLayout::take(std::span<const std::uint8_t> report,
                            SpaceMouseReading& reading) const noexcept {
  bool moved = false;
  std::int64_t value = 0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const HidField& field = axes_[axis];
    if (!read_hid_field(field, numbered_, report, value)) continue;
    const auto range = static_cast<double>(std::max(-field.logical_min, field.logical_max));
    reading.deflection[axis] = std::clamp(static_cast<double>(value) / range, -1.0, 1.0);
    moved = true;
  }
  for (const HidField& field : buttons_) {
    const std::uint32_t button = (field.usage & 0xffff) - 1;  // the page's usages begin at 1
    if (button >= kMaxButtons || !read_hid_field(field, numbered_, report, value)) continue;
    reading.buttons = (reading.buttons & ~(1u << button)) | (value != 0 ? 1u << button : 0u);
  }
  return moved;
}

std::vector<std::uint8_t> SpaceMouseLayout::led_report(bool on) const {
  if (!led_) return {};
  std::vector<std::uint8_t> report(1 + (led_report_bits_ + 7) / 8);
  report[0] = led_->report_id;
  if (on) report[1 + led_->bit_offset / 8] |= static_cast<std::uint8_t>(1u << led_->bit_offset % 8);
  return report;
}

}  // namespace forcelayer::devices
