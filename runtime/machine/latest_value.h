// The newest value from one thread to one other, without locks: old ones are overwritten.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace forcelayer::machine {

// The memory that the two sides share; it may lie in memory that two processes map. Three slots are
// in use: the producer fills one, the consumer reads one, `between` says which one changes hands.
// There are four so that whatever stands in `between` names a slot.
template <typename T>
struct SharedValue {
  static_assert(std::is_trivially_copyable_v<T>);
  static constexpr std::uint32_t kSlot = 3, kNew = 4;

  std::array<T, 4> slots{};
  std::atomic<std::uint32_t> between{2};
};

// The side that gives.
template <typename T>
class ValueProducer {
 public:
  void put(SharedValue<T>& shared, const T& value) noexcept {
    using S = SharedValue<T>;
    shared.slots[filling_] = value;
    filling_ = shared.between.exchange(filling_ | S::kNew, std::memory_order_acq_rel) & S::kSlot;
  }

 private:
  std::uint32_t filling_ = 0;
};

// The side that takes. What a broken other side wrote is taken for a value or refused; nothing
// outside the slots is read.
template <typename T>
class ValueConsumer {
 public:
  // False where nothing came since the last call; `value` is then unchanged.
  bool take(SharedValue<T>& shared, T& value) noexcept {
    using S = SharedValue<T>;
    if ((shared.between.load(std::memory_order_relaxed) & S::kNew) == 0) return false;
    const std::uint32_t found = shared.between.exchange(reading_, std::memory_order_acq_rel);
    const std::uint32_t slot = found & S::kSlot;
    broken_ |= found > (S::kNew | 2) || slot == 3 || slot == reading_;
    if (broken_) return false;
    reading_ = slot;
    value = shared.slots[reading_];
    return true;
  }

  // Whether `between` ever held what no producer writes there.
  bool broken() const { return broken_; }

 private:
  std::uint32_t reading_ = 1;
  bool broken_ = false;
};

// The three in one process.
template <typename T>
class LatestValue {
 public:
  void put(const T& value) noexcept { producer_.put(shared_, value); }
  bool take(T& value) noexcept { return consumer_.take(shared_, value); }

 private:
  SharedValue<T> shared_;
  ValueProducer<T> producer_;
  ValueConsumer<T> consumer_;
};

}  // namespace forcelayer::machine
