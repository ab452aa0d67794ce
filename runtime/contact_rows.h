// The unilateral rows of one implicit solve, laid out for vectors: which of them push at a
// velocity, with what energy, and what they add to the 6x6 system.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/spatial.h"

namespace forcelayer {

// One unilateral constraint: pushes with the impulse weight * (onset - j.v) while j.v < onset.
struct ContactRow {
  Vector6 j{};        // separation speed per velocity
  double weight = 0;  // N s per m/s
  double onset = 0;   // m/s
};

// Eight rows in columns: the six of j, weight, onset.
struct alignas(64) ContactRowBlock {
  static constexpr std::size_t kRows = 8, kWeight = 6, kOnset = 7;
  double columns[8][kRows] = {};
};

// Sum of weight j j^T, and of weight onset j, over rows.
struct ContactRowSum {
  Symmetric6 matrix;
  Vector6 impulse{};
};

// Sums run in eight columns and are then added in one order: the same bits for any vector width.
class ContactRows {
 public:
  void reserve(std::size_t rows);  // set-up only
  void clear() noexcept;
  void add(const ContactRow& row) noexcept;  // beyond the room that was reserved: left out
  std::size_t size() const noexcept { return count_; }

  // Sum of weight max(0, onset - j.v)^2 / 2, J; notes which rows push at `v`.
  double energy_j(const Vector6& v) noexcept;
  // Over the rows that pushed at the last energy_j(). Summed anew only where these are others than
  // the last time.
  const ContactRowSum& pushing() noexcept;

 private:
  std::size_t blocks() const noexcept {
    return (count_ + ContactRowBlock::kRows - 1) / ContactRowBlock::kRows;
  }

  std::vector<ContactRowBlock> blocks_;
  std::vector<std::uint8_t> push_;    // [blocks()] bit n: row n of the block pushes
  std::vector<std::uint8_t> summed_;  // those of sum_
  std::size_t count_ = 0;
  bool sum_known_ = false;
  ContactRowSum sum_;
};

}  // namespace forcelayer
