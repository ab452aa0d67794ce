// How much work proving a file may take. Internal to formats/audit/.
//
// Equal nodes and bricks are stored once, and each can stand in many places, so a small file can
// describe more places than anyone can look at. A bake takes some 40 ns a byte. A file that needs
// more than this is refused: its facts may be true, but they are not proven.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace forcelayer::voxmap_audit {

// Work is counted in units of about a nanosecond, and never measured: the answer is the same on
// every machine.
class Effort {
 public:
  static constexpr std::uint64_t kForAnyFile = 1'000'000'000, kPerByte = 300;
  // To ask a large set whether it holds 27 entries.
  static constexpr std::uint64_t kAskUnits = 3'000;

  explicit Effort(std::size_t file_bytes) : left_(kForAnyFile + kPerByte * file_bytes) {}

  void spend(std::uint64_t units) { left_ -= std::min(left_, units); }
  bool is_spent() const { return left_ == 0; }
  std::uint64_t left() const { return left_; }

 private:
  std::uint64_t left_;
};

}  // namespace forcelayer::voxmap_audit
