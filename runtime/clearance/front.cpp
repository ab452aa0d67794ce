#include "runtime/clearance/front.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::clearance {
namespace {

constexpr double kHalfDiagonal = 0.8660254037844387;  // of a voxel, rounded up
constexpr double kHalfSquare = 0.375;                 // half its square
constexpr double kWriterError = 0.002;                // of a code, in voxels (voxmap_format.md, 6)
constexpr double kRounding = 1e-4;                    // voxels: far above that of the sums
constexpr double kDeepest = 0.9;                      // voxels: no voxel of the mesh is deeper
constexpr std::size_t kPadding = 16;                  // voxels of a front are looked at together

}  // namespace

LeftOut with_objects(LeftOut left_out, std::span<const std::uint32_t> objects) {
  for (const std::uint32_t object : objects) {
    if (object == 0) continue;  // not named
    left_out.resize(std::max<std::size_t>(left_out.size(), object + std::size_t{1}), 0);
    left_out[object] = 1;
  }
  return left_out;
}

double reach_voxels(const VoxmapHeader& h) {
  return (static_cast<double>(kMaxDistanceCode) - h.distance_zero_code) * h.distance_quantum_m /
         h.voxel_size_m;
}

Fronts::Fronts(const Voxmap& voxmap, const LeftOut& left_out, Window window)
    : voxmap_(voxmap),
      left_out_(left_out),
      quantum_(voxmap.header().distance_quantum_m / voxmap.voxel_size_m()) {
  // A whole window of codes below the highest.
  from_mesh_ = window == Window::kMesh
                   ? 1
                   : reach_voxels(voxmap.header()) - kHalfDiagonal - quantum_ - kWriterError;
  // Codes may end before the voxels of the mesh differ from those inside.
  const VoxmapHeader& h = voxmap.header();
  counts_lowest_ = window == Window::kMesh && (h.distance_zero_code - 1) * quantum_ < kDeepest;
  low_ = std::max(0.0, from_mesh_ - kHalfDiagonal);
  high_ = from_mesh_ + kHalfDiagonal;
}

double Fronts::distance_voxels(double min_sum, double known_voxels) const {
  const double sum = min_sum - kRounding;
  if (from_mesh_ <= 1) {
    // From L = 3 on, B between 1 and 2 h, the loss is at most this. Below, a sum is less than 4;
    // the nearest point's own voxel has L and twice half a diagonal at most.
    const double far = sum - kHalfSquare * (1 / (3 - 2 * kHalfDiagonal) + 1);
    return std::max({0.0, known_voxels, sum >= 4 ? far : sum - 2 * kHalfDiagonal});
  }
  const auto loss = [&](double to_front) { return kHalfSquare * (1 / to_front + 1 / from_mesh_); };
  const double known = std::max(known_voxels, from_mesh_ + kHalfDiagonal);
  const double smallest = std::max(known, sum - loss(known - from_mesh_));
  return std::max(known_voxels, sum - loss(smallest - from_mesh_));
}

const Front* Fronts::of(const BrickIndex& brick) {
  const auto [at, is_new] = fronts_.try_emplace(key_of(brick));
  if (!is_new) return at->second.get();
  const DistanceView& distances = *voxmap_.distances();
  const ObjectView* const objects = voxmap_.objects();
  const std::uint32_t entry = entry_of(distances, brick, uniform_entry(kMaxDistanceCode));
  if (is_uniform(entry)) {
    const std::uint32_t code = uniform_wide_value(entry);
    if (code == kMaxDistanceCode || (code == 0 && !counts_lowest_)) return nullptr;
  }
  const auto codes = distances.brick_codes(entry);
  const std::uint32_t named =
      objects != nullptr ? entry_of(*objects, brick, uniform_entry(0)) : uniform_entry(0);
  const auto numbers = objects != nullptr ? objects->brick_codes(named) : decltype(codes){};
  auto front = std::make_unique<Front>();
  const std::int32_t zero = voxmap_.header().distance_zero_code;
  for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
    const std::int32_t code = codes[n];
    if (code == static_cast<std::int32_t>(kMaxDistanceCode)) continue;
    if (code == 0 && !counts_lowest_) continue;
    const double low = code == 0 ? -Front::kFar : (code - zero) * quantum_;
    const double high = (code + 1 - zero) * quantum_ + kWriterError;
    const double smallest = std::max({0.0, low, -high}), largest = std::max(high, -low);
    if (largest < low_ || smallest > high_) continue;
    const std::uint32_t object = numbers[n];
    if (object < left_out_.size() && left_out_[object] != 0) continue;
    front->x.push_back(static_cast<float>(n >> 6) + 0.5f);
    front->y.push_back(static_cast<float>(n >> 3 & 7) + 0.5f);
    front->z.push_back(static_cast<float>(n & 7) + 0.5f);
    front->smallest.push_back(static_cast<float>(smallest));
    front->largest.push_back(static_cast<float>(largest));
    front->object.push_back(numbers[n]);
  }
  if (front->x.empty()) return nullptr;
  while (front->x.size() % kPadding != 0) {
    for (auto* values : {&front->x, &front->y, &front->z, &front->smallest, &front->largest}) {
      values->push_back(Front::kFar);
    }
    front->object.push_back(0);
  }
  at->second = std::move(front);
  return at->second.get();
}

}  // namespace forcelayer::clearance
