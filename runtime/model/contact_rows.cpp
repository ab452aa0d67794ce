#include "runtime/model/contact_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>

// Compiles what follows once per instruction set.
#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/model/contact_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::model {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Columns = ContactRowColumns;
constexpr std::size_t kRows = ContactRows::kRowsAtOnce;  // of a block
using Doubles = hn::CappedTag<double, kRows>;
using VD = hn::Vec<Doubles>;
constexpr Doubles kD;
constexpr std::size_t kLanes = HWY_MIN(HWY_LANES(double), kRows);
constexpr std::size_t kVectors = kRows / kLanes;  // of a block

double sum_of_columns(const double (&c)[kRows]) {
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

// The boxes of the blocks from box `first` on.
void box_on_target(const Columns& rows, std::size_t first, std::size_t blocks,
                   ContactRowBox* boxes) {
  constexpr std::size_t kBlocks = ContactRows::kBoxBlocks;
  for (std::size_t box = first; box * kBlocks < blocks; ++box) {
    const std::size_t begin = box * kBlocks * kRows,
                      end = std::min(blocks, (box + 1) * kBlocks) * kRows;
    auto numbers = hn::FirstN(kD, kLanes);
    const auto range_of = [&](const double* column, VD& low, VD& high) HWY_ATTR {
      low = high = hn::LoadU(kD, column + begin);
      for (std::size_t at = begin; at < end; at += kLanes) {
        const VD x = hn::LoadU(kD, column + at);
        low = hn::Min(low, x), high = hn::Max(high, x);
        numbers = hn::And(numbers, hn::Eq(x, x));
      }
    };
    VD low, high;
    for (std::size_t i = 0; i < 6; ++i) {
      range_of(rows.at[i], low, high);
      const double from = hn::GetLane(hn::MinOfLanes(kD, low)),
                   to = hn::GetLane(hn::MaxOfLanes(kD, high));
      boxes[box].middle[i] = 0.5 * (from + to);
      boxes[box].half[i] = 0.5 * (to - from);
    }
    range_of(rows.at[Columns::kOnset], low, high);
    boxes[box].max_onset = hn::AllTrue(kD, numbers) ? hn::GetLane(hn::MaxOfLanes(kD, high))
                                                    : std::numeric_limits<double>::infinity();
  }
}

// Whether no row of a box pushes at `v`: not even by the rounding of its speed and of the box.
// False where numbers are too large for double precision.
bool pushes_nothing(const ContactRowBox& box, const coupling::Vector6& v) {
  constexpr double kRounding = 1e-12, kTiny = 1e-290;
  double least = 0, size = std::abs(box.max_onset);
  for (std::size_t i = 0; i < 6; ++i) {
    const double middle = box.middle[i] * v[i], half = box.half[i] * std::abs(v[i]);
    least += middle - half;
    size += std::abs(middle) + half;
  }
  return box.max_onset + kRounding * size + kTiny < least;
}

double energy_on_target(const Columns& rows, const ContactRowBox* boxes, std::size_t blocks,
                        const coupling::Vector6& v, std::uint8_t* push) {
  VD sum[kVectors];
  for (VD& part : sum) part = hn::Zero(kD);
  const VD zero = hn::Zero(kD), half = hn::Set(kD, 0.5);
  bool is_idle = false;  // the box of the block
  for (std::size_t b = 0; b < blocks; ++b) {
    if (b % ContactRows::kBoxBlocks == 0) {
      is_idle = pushes_nothing(boxes[b / ContactRows::kBoxBlocks], v);
    }
    if (is_idle) {  // its rows, which are finite, add 0
      push[b] = 0;
      continue;
    }
    unsigned bits = 0;
    for (std::size_t part = 0; part < kVectors; ++part) {
      const std::size_t lane = part * kLanes, at = b * kRows + lane;
      VD speed = hn::Mul(hn::LoadU(kD, rows.at[0] + at), hn::Set(kD, v[0]));
      for (std::size_t i = 1; i < 6; ++i) {
        speed = hn::Add(speed, hn::Mul(hn::LoadU(kD, rows.at[i] + at), hn::Set(kD, v[i])));
      }
      const VD short_of = hn::Sub(hn::LoadU(kD, rows.at[Columns::kOnset] + at), speed);
      const auto pushes = hn::Gt(short_of, zero);
      const VD weight = hn::Mul(half, hn::LoadU(kD, rows.at[Columns::kWeight] + at));
      const VD energy = hn::Mul(weight, hn::Mul(short_of, short_of));
      sum[part] = hn::Add(sum[part], hn::IfThenElseZero(pushes, energy));
      std::uint8_t mask[8] = {};
      hn::StoreMaskBits(kD, pushes, mask);
      bits |= unsigned{mask[0]} << lane;
    }
    push[b] = static_cast<std::uint8_t>(bits);
  }
  HWY_ALIGN double columns[kRows];
  for (std::size_t part = 0; part < kVectors; ++part) {
    hn::Store(sum[part], kD, columns + part * kLanes);
  }
  return sum_of_columns(columns);
}

void sum_on_target(const Columns& rows, std::size_t blocks, const std::uint8_t* push,
                   ContactRowSum& out) {
  constexpr std::size_t kSums = 21 + 6;  // lower triangle by rows, impulse
  HWY_ALIGN double columns[kSums][kRows];
  for (std::size_t part = 0; part < kVectors; ++part) {
    const std::size_t lane = part * kLanes;
    VD sums[kSums];
    for (VD& sum : sums) sum = hn::Zero(kD);
    for (std::size_t b = 0; b < blocks; ++b) {
      if (push[b] == 0) continue;  // its rows add 0
      const std::uint8_t mask[8] = {static_cast<std::uint8_t>(push[b] >> lane)};
      const auto pushes = hn::LoadMaskBits(kD, mask);
      const std::size_t at = b * kRows + lane;
      const VD weight = hn::IfThenElseZero(pushes, hn::LoadU(kD, rows.at[Columns::kWeight] + at));
      const VD onset = hn::LoadU(kD, rows.at[Columns::kOnset] + at);
      VD j[6];
      for (std::size_t i = 0; i < 6; ++i) j[i] = hn::LoadU(kD, rows.at[i] + at);
      for (std::size_t row = 0, n = 0; row < 6; ++row) {
        const VD weighted = hn::Mul(weight, j[row]);
        for (std::size_t column = 0; column <= row; ++column, ++n) {
          sums[n] = hn::Add(sums[n], hn::Mul(weighted, j[column]));
        }
        sums[21 + row] = hn::Add(sums[21 + row], hn::Mul(weighted, onset));
      }
    }
    for (std::size_t n = 0; n < kSums; ++n) hn::Store(sums[n], kD, columns[n] + lane);
  }
  for (std::size_t n = 0; n < 21; ++n) out.matrix.lower[n] = sum_of_columns(columns[n]);
  for (std::size_t n = 0; n < 6; ++n) out.impulse[n] = sum_of_columns(columns[21 + n]);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::model
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::model {

HWY_EXPORT(box_on_target);
HWY_EXPORT(energy_on_target);
HWY_EXPORT(sum_on_target);

void ContactRows::reserve(std::size_t rows) {
  const std::size_t blocks = (rows + kRowsAtOnce - 1) / kRowsAtOnce;
  room_ = rows;
  // An odd number of cache lines: columns at one distance from a power of two would share few.
  stride_ = ((blocks + 1) | 1) * kRowsAtOnce;
  columns_.resize(ContactRowColumns::kColumns * stride_);
  push_.resize(blocks);
  summed_.resize(blocks);
  boxes_.resize((blocks + kBoxBlocks - 1) / kBoxBlocks);
}

void ContactRows::clear() noexcept {
  count_ = boxed_ = 0;
  sum_known_ = false;
}

ContactRowColumns ContactRows::from(std::size_t row) noexcept {
  ContactRowColumns columns;
  for (std::size_t i = 0; i < ContactRowColumns::kColumns; ++i) {
    columns.at[i] = &columns_[i * stride_ + row];
  }
  return columns;
}

void ContactRows::added(std::size_t rows) noexcept {
  count_ += rows;
  sum_known_ = false;
  for (double* column : from(count_).at) std::fill_n(column, kRowsAtOnce, 0.0);
}

void ContactRows::add(const ContactRow& row) noexcept {
  if (room() == 0) return;
  const ContactRowColumns to = next();
  for (std::size_t i = 0; i < 6; ++i) *to.at[i] = row.j[i];
  *to.at[ContactRowColumns::kWeight] = row.weight;
  *to.at[ContactRowColumns::kOnset] = row.onset;
  added(1);
}

void ContactRows::box_new_rows() noexcept {
  if (boxed_ == count_) return;
  HWY_DYNAMIC_DISPATCH(box_on_target)
  (from(0), boxed_ / (kBoxBlocks * kRowsAtOnce), blocks(), boxes_.data());
  boxed_ = count_;
}

double ContactRows::energy_j(const coupling::Vector6& v) noexcept {
  box_new_rows();
  return HWY_DYNAMIC_DISPATCH(energy_on_target)(from(0), boxes_.data(), blocks(), v, push_.data());
}

bool ContactRows::same_push() const noexcept {
  return sum_known_ &&
         std::equal(push_.begin(), push_.begin() + static_cast<std::ptrdiff_t>(blocks()),
                    summed_.begin());
}

const ContactRowSum& ContactRows::pushing() noexcept {
  if (same_push()) return sum_;
  HWY_DYNAMIC_DISPATCH(sum_on_target)(from(0), blocks(), push_.data(), sum_);
  std::copy_n(push_.begin(), blocks(), summed_.begin());
  sum_known_ = true;
  return sum_;
}

}  // namespace forcelayer::model
#endif
