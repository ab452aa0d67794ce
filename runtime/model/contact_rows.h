// The unilateral rows of one implicit solve, laid out for vectors: which of them push at a
// velocity, with what energy, and what they add to the 6x6 system.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/coupling/spatial.h"

namespace forcelayer::model {

// One unilateral constraint: pushes with the impulse weight * (onset - j.v) while j.v < onset. All
// of it is finite.
struct ContactRow {
  coupling::Vector6 j{};  // separation speed per velocity
  double weight = 0;      // N s per m/s
  double onset = 0;       // m/s
};

// Where rows stand, column by column: the six of j, weight, onset.
struct ContactRowColumns {
  static constexpr std::size_t kColumns = 8, kWeight = 6, kOnset = 7;
  double* at[kColumns] = {};
};

// Sum of weight j j^T, and of weight onset j, over rows.
struct ContactRowSum {
  coupling::Symmetric6 matrix;
  coupling::Vector6 impulse{};
};

// A box that holds the j of consecutive rows, and the largest onset of them. Of a part that is near
// the scene all around, most rows push at none of the velocities that a solve tries: their boxes
// show it at once.
struct ContactRowBox {
  coupling::Vector6 middle{}, half{};
  double max_onset = 0;  // infinite where a j or an onset is not a number
};

// Sums run in eight columns and are then added in one order: the same bits for any vector width.
class ContactRows {
 public:
  void reserve(std::size_t rows);  // set-up only
  void clear() noexcept;
  void add(const ContactRow& row) noexcept;  // beyond the room that was reserved: left out
  std::size_t size() const noexcept { return count_; }

  // Many at a time: next() is where the next rows go, at most room() of them, added() says how many
  // were written there. Up to kRowsAtOnce more elements of a column may be written.
  ContactRowColumns next() noexcept { return from(count_); }
  std::size_t room() const noexcept { return room_ - count_; }
  void added(std::size_t rows) noexcept;

  // Sum of weight max(0, onset - j.v)^2 / 2, J; notes which rows push at `v`.
  double energy_j(const coupling::Vector6& v) noexcept;
  // Over the rows that pushed at the last energy_j(). Summed anew only where these are others than
  // the last time.
  const ContactRowSum& pushing() noexcept;
  // Whether the rows that pushed at the last energy_j() are those of the last pushing().
  bool same_push() const noexcept;

  static constexpr std::size_t kRowsAtOnce = 8;
  static constexpr std::size_t kBoxBlocks = 8;  // blocks of kRowsAtOnce rows in a box

 private:
  std::size_t blocks() const noexcept { return (count_ + kRowsAtOnce - 1) / kRowsAtOnce; }
  ContactRowColumns from(std::size_t row) noexcept;
  void box_new_rows() noexcept;

  std::vector<double> columns_;       // each of stride_; rows beyond count_ push nothing
  std::vector<std::uint8_t> push_;    // [blocks()] bit n: row n of the eight pushes
  std::vector<std::uint8_t> summed_;  // those of sum_
  std::vector<ContactRowBox> boxes_;  // of each kBoxBlocks blocks
  std::size_t room_ = 0, stride_ = 0, count_ = 0;
  std::size_t boxed_ = 0;  // rows that are in boxes
  bool sum_known_ = false;
  ContactRowSum sum_;
};

}  // namespace forcelayer::model
