#include "runtime/contact_rows.h"

#include <algorithm>

// Vectors stand in arrays here, which those of unknown size cannot.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/contact_rows.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace forcelayer {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Block = ContactRowBlock;
using Doubles = hn::CappedTag<double, Block::kRows>;
using VD = hn::Vec<Doubles>;
constexpr Doubles kD;
constexpr std::size_t kLanes = HWY_MIN(HWY_LANES(double), Block::kRows);
constexpr std::size_t kVectors = Block::kRows / kLanes;  // of a block

double sum_of_columns(const double (&c)[Block::kRows]) {
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

double energy_on_target(const Block* blocks, std::size_t count, const Vector6& v,
                        std::uint8_t* push) {
  VD sum[kVectors];
  for (VD& part : sum) part = hn::Zero(kD);
  const VD zero = hn::Zero(kD), half = hn::Set(kD, 0.5);
  for (std::size_t b = 0; b < count; ++b) {
    const auto& columns = blocks[b].columns;
    unsigned bits = 0;
    for (std::size_t part = 0; part < kVectors; ++part) {
      const std::size_t at = part * kLanes;
      VD speed = hn::Mul(hn::Load(kD, columns[0] + at), hn::Set(kD, v[0]));
      for (std::size_t i = 1; i < 6; ++i) {
        speed = hn::Add(speed, hn::Mul(hn::Load(kD, columns[i] + at), hn::Set(kD, v[i])));
      }
      const VD short_of = hn::Sub(hn::Load(kD, columns[Block::kOnset] + at), speed);
      const auto pushes = hn::Gt(short_of, zero);
      const VD weight = hn::Mul(half, hn::Load(kD, columns[Block::kWeight] + at));
      const VD energy = hn::Mul(weight, hn::Mul(short_of, short_of));
      sum[part] = hn::Add(sum[part], hn::IfThenElseZero(pushes, energy));
      std::uint8_t mask[8] = {};
      hn::StoreMaskBits(kD, pushes, mask);
      bits |= unsigned{mask[0]} << at;
    }
    push[b] = static_cast<std::uint8_t>(bits);
  }
  HWY_ALIGN double columns[Block::kRows];
  for (std::size_t part = 0; part < kVectors; ++part) {
    hn::Store(sum[part], kD, columns + part * kLanes);
  }
  return sum_of_columns(columns);
}

void sum_on_target(const Block* blocks, std::size_t count, const std::uint8_t* push,
                   ContactRowSum& out) {
  constexpr std::size_t kSums = 21 + 6;  // lower triangle by rows, impulse
  HWY_ALIGN double columns[kSums][Block::kRows];
  for (std::size_t part = 0; part < kVectors; ++part) {
    const std::size_t at = part * kLanes;
    VD sums[kSums];
    for (VD& sum : sums) sum = hn::Zero(kD);
    for (std::size_t b = 0; b < count; ++b) {
      const std::uint8_t mask[8] = {static_cast<std::uint8_t>(push[b] >> at)};
      const auto pushes = hn::LoadMaskBits(kD, mask);
      const auto& c = blocks[b].columns;
      const VD weight = hn::IfThenElseZero(pushes, hn::Load(kD, c[Block::kWeight] + at));
      const VD onset = hn::Load(kD, c[Block::kOnset] + at);
      VD j[6];
      for (std::size_t i = 0; i < 6; ++i) j[i] = hn::Load(kD, c[i] + at);
      for (std::size_t row = 0, n = 0; row < 6; ++row) {
        const VD weighted = hn::Mul(weight, j[row]);
        for (std::size_t column = 0; column <= row; ++column, ++n) {
          sums[n] = hn::Add(sums[n], hn::Mul(weighted, j[column]));
        }
        sums[21 + row] = hn::Add(sums[21 + row], hn::Mul(weighted, onset));
      }
    }
    for (std::size_t n = 0; n < kSums; ++n) hn::Store(sums[n], kD, columns[n] + at);
  }
  for (std::size_t n = 0; n < 21; ++n) out.matrix.lower[n] = sum_of_columns(columns[n]);
  for (std::size_t n = 0; n < 6; ++n) out.impulse[n] = sum_of_columns(columns[21 + n]);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer {

HWY_EXPORT(energy_on_target);
HWY_EXPORT(sum_on_target);

void ContactRows::reserve(std::size_t rows) {
  const std::size_t blocks = (rows + ContactRowBlock::kRows - 1) / ContactRowBlock::kRows;
  blocks_.resize(blocks);
  push_.resize(blocks);
  summed_.resize(blocks);
}

void ContactRows::clear() noexcept {
  count_ = 0;
  sum_known_ = false;
}

void ContactRows::add(const ContactRow& row) noexcept {
  const std::size_t block = count_ / ContactRowBlock::kRows, at = count_ % ContactRowBlock::kRows;
  if (block == blocks_.size()) return;
  if (at == 0) blocks_[block] = {};  // rows that are not there yet push nothing
  auto& columns = blocks_[block].columns;
  for (std::size_t i = 0; i < 6; ++i) columns[i][at] = row.j[i];
  columns[ContactRowBlock::kWeight][at] = row.weight;
  columns[ContactRowBlock::kOnset][at] = row.onset;
  ++count_;
  sum_known_ = false;
}

double ContactRows::energy_j(const Vector6& v) noexcept {
  return HWY_DYNAMIC_DISPATCH(energy_on_target)(blocks_.data(), blocks(), v, push_.data());
}

const ContactRowSum& ContactRows::pushing() noexcept {
  const std::size_t count = blocks();
  if (sum_known_ && std::equal(push_.begin(), push_.begin() + static_cast<std::ptrdiff_t>(count),
                               summed_.begin())) {
    return sum_;
  }
  HWY_DYNAMIC_DISPATCH(sum_on_target)(blocks_.data(), count, push_.data(), sum_);
  std::copy_n(push_.begin(), count, summed_.begin());
  sum_known_ = true;
  return sum_;
}

}  // namespace forcelayer
#endif
