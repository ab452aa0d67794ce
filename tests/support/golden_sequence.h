// Numbers and hashes of the golden tests: the same bits on every machine. Only +, -, *, / and
// sqrt, which IEEE 754 rounds the same everywhere, and no library's random numbers.
#pragma once

#include <cstddef>
#include <cstdint>

namespace forcelayer::test {

// Knuth's MMIX generator; uniform in [-1, 1).
class Sequence {
 public:
  double next() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(static_cast<std::int64_t>(state_) >> 11) * 0x1p-52;
  }

 private:
  std::uint64_t state_ = 1999;
};

// FNV-1a.
class GoldenHash {
 public:
  template <typename T, std::size_t kCount>
  void add(const T (&values)[kCount]) {
    const auto* const bytes = reinterpret_cast<const unsigned char*>(values);
    for (std::size_t i = 0; i < sizeof values; ++i) value_ = (value_ ^ bytes[i]) * 1099511628211u;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037u;
};

}  // namespace forcelayer::test
