#include "pointshell/part/pieces.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::part {

bool is_flat(const Piece& piece) {
  constexpr double kFlat = 1e-12;  // of its height over its length
  const double doubled = length(cross(piece[1] - piece[0], piece[2] - piece[0]));
  return !(doubled > kFlat * longest_edge(piece).length_squared);
}

std::optional<Needle> Needle::of(const Piece& piece, double longest_edge_m) {
  constexpr double kLongest = 4;                 // edges: shorter ones are bisected
  constexpr double kSlender = 8;                 // longest edge over height
  constexpr double kSlice = 0.8, kHeight = 0.5;  // edges: a slice fits a diagonal of one edge
  const LongestEdge longest = longest_edge(piece);
  const double length_m = std::sqrt(longest.length_squared);
  if (!(length_m > kLongest * longest_edge_m)) return {};
  Needle needle;
  needle.from_ = piece[longest.from];
  needle.to_ = piece[(longest.from + 1) % 3];
  needle.apex_ = piece[(longest.from + 2) % 3];
  const Vec3 along = needle.to_ - needle.from_, up = needle.apex_ - needle.from_;
  needle.height_ = length(cross(along, up)) / length_m;
  needle.foot_ = dot(along, up) / longest.length_squared;
  const bool slender = needle.height_ * kSlender <= length_m &&
                       needle.height_ <= kHeight * longest_edge_m && needle.foot_ > 0 &&
                       needle.foot_ < 1;
  if (!slender) return {};
  needle.slices_ = static_cast<std::size_t>(std::ceil(length_m / (kSlice * longest_edge_m)));
  return needle;
}

std::pair<std::size_t, std::size_t> Needle::slices_near(const Box& box) const {
  const Vec3 along = to_ - from_;
  const Vec3 size{std::abs(along.x), std::abs(along.y), std::abs(along.z)};
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const double length = coordinate(along, axis), start = coordinate(from_, axis);
  const auto slice_at = [&](double place) {
    return std::clamp((place - start) / length, 0.0, 1.0) * static_cast<double>(slices_);
  };
  const double a = slice_at(coordinate(box.low, axis) - height_),
               b = slice_at(coordinate(box.high, axis) + height_);
  const double first = std::floor(std::min(a, b)) - 1, last = std::ceil(std::max(a, b)) + 1;
  return {static_cast<std::size_t>(std::max(first, 0.0)),
          std::min(static_cast<std::size_t>(last), slices_)};
}

void for_each_tile_batch(const Part& part, double longest_edge_m,
                         const std::function<bool(std::span<const Piece>)>& take) {
  constexpr std::size_t kTilesPerBatch = 1 << 16;
  std::vector<Piece> tiles;
  tiles.reserve(kTilesPerBatch);
  bool goes_on = true;
  const auto add = [&](const Piece& tile) {
    if (!goes_on) return;
    tiles.push_back(tile);
    if (tiles.size() < kTilesPerBatch) return;
    goes_on = take(tiles);
    tiles.clear();
  };
  const auto bisect = [&](const auto& itself, const Piece& piece) -> void {
    const LongestEdge longest = longest_edge(piece);
    if (!(longest.length_squared > longest_edge_m * longest_edge_m)) return add(piece);
    for (const Piece& half : bisected(piece, longest.from)) {
      if (goes_on) itself(itself, half);
    }
  };
  for (std::size_t t = 0; t < part.triangles.size() && goes_on; ++t) {
    const Piece triangle = triangle_piece(part, t);
    const auto needle = Needle::of(triangle, longest_edge_m);
    if (!needle) bisect(bisect, triangle);
    for (std::size_t n = 0; needle && n < needle->slices() && goes_on; ++n) {
      needle->visit_slice(n, add);
    }
  }
  if (goes_on && !tiles.empty()) take(tiles);
}

}  // namespace forcelayer::part
