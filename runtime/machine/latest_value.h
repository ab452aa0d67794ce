// The newest value from one thread to one other, without locks: old ones are overwritten.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace forcelayer::machine {

// Three slots: the producer fills one, the consumer reads one, the third changes hands.
template <typename T>
class LatestValue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  // Producer.
  void put(const T& value) noexcept {
    slots_[filling_] = value;
    filling_ = between_.exchange(filling_ | kNew, std::memory_order_acq_rel) & kSlot;
  }

  // Consumer. False where nothing came since the last call; `value` is then unchanged.
  bool take(T& value) noexcept {
    if ((between_.load(std::memory_order_relaxed) & kNew) == 0) return false;
    reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & kSlot;
    value = slots_[reading_];
    return true;
  }

 private:
  static constexpr std::uint32_t kSlot = 3, kNew = 4;

  std::array<T, 3> slots_{};
  std::uint32_t filling_ = 0, reading_ = 1;
  std::atomic<std::uint32_t> between_{2};
};

}  // namespace forcelayer::machine
