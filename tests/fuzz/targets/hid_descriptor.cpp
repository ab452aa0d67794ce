// A report descriptor, read as the SpaceMouse driver does; its own bytes then serve as reports.
#include <cmath>

#include "runtime/devices/hid/spacemouse_layout.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const std::span<const std::uint8_t> bytes(data, size);
  const auto descriptor = devices::parse_hid_report_descriptor(bytes);
  if (!descriptor) {
    fuzz::require(!descriptor.error().what.empty(), "an error says what is wrong");
    return 0;
  }
  for (const devices::HidField& field : descriptor->fields) {
    std::int64_t value = 0;
    (void)devices::read_hid_field(field, descriptor->numbered(), bytes, value);
    fuzz::require(field.bit_size >= 1 && field.bit_size <= 32, "fields of 1 to 32 bits");
  }
  const auto layout = devices::SpaceMouseLayout::from(*descriptor);
  if (!layout) return 0;
  devices::SpaceMouseReading reading;
  for (std::size_t at = 0; at < size; at += 7) {
    (void)layout->take(bytes.subspan(at), reading);
    for (const double part : reading.deflection) {
      fuzz::require(std::abs(part) <= 1, "deflections lie within -1 and 1");
    }
  }
  (void)layout->led_report(true);
  return 0;
}
