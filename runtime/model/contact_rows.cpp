#include "runtime/model/contact_rows.h"

#include <algorithm>

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

double energy_on_target(const Columns& rows, std::size_t blocks, const coupling::Vector6& v,
                        std::uint8_t* push) {
  VD sum[kVectors];
  for (VD& part : sum) part = hn::Zero(kD);
  const VD zero = hn::Zero(kD), half = hn::Set(kD, 0.5);
  for (std::size_t b = 0; b < blocks; ++b) {
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
}

void ContactRows::clear() noexcept {
  count_ = 0;
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

double ContactRows::energy_j(const coupling::Vector6& v) noexcept {
  return HWY_DYNAMIC_DISPATCH(energy_on_target)(from(0), blocks(), v, push_.data());
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
