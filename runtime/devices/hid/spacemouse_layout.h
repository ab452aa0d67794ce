// Finds the axes, buttons and LED of a 3Dconnexion device in its report descriptor. Models differ:
// six axes come in one report or in two, in several sizes and ranges.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/devices/hid/hid_report_descriptor.h"

namespace forcelayer::devices {

inline constexpr std::uint32_t kMultiAxisUsage = hid_usage(0x01, 0x08);

// The cap's deflection and the buttons. Axes x y z rx ry rz in the device's own frame: x to the
// right, y towards the user, z down, rotations right-handed about them; -1 to 1.
struct SpaceMouseReading {
  std::array<double, 6> deflection{};
  std::uint32_t buttons = 0;  // bit n: the descriptor's button n + 1
};

class SpaceMouseLayout {
 public:
  // Errors: kDeviceRefused where one of six axes is missing.
  static Result<SpaceMouseLayout> from(const HidReportDescriptor& descriptor);

  // Takes the axes and buttons of `report` into `reading`, and leaves the others. Returns
  // whether it had any axis.
  bool take(std::span<const std::uint8_t> report, SpaceMouseReading& reading) const noexcept;

  // The output report that switches the LED, its id (or 0) first; empty where there is no LED.
  std::vector<std::uint8_t> led_report(bool on) const;

 private:
  bool numbered_ = false;
  std::array<HidField, 6> axes_;
  std::vector<HidField> buttons_;
  std::optional<HidField> led_;
  std::uint32_t led_report_bits_ = 0;
};

}  // namespace forcelayer::devices
