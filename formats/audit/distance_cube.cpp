#include "formats/audit/distance_cube.h"

namespace forcelayer::voxmap_audit {
namespace {

void min_of_three(const Distance* from, std::int64_t step, std::int64_t count, Distance* to) {
  for (std::int64_t i = 0; i < count; ++i) {
    to[i] = std::min(std::min(from[i - step], from[i + step]), from[i]);
  }
}

}  // namespace

DistanceCube::DistanceCube() {
  one_.fill(Ring::kFar);
  two_.fill(Ring::kFar);
}

void DistanceCube::clear(std::int64_t margin) {
  margin_ = margin;
  width_ = kCells + 2 * margin;
  std::fill(cells_.begin(), cells_.end(), Ring::kFar);
}

void DistanceCube::add(const Ring& ring, std::size_t in_direction) {
  const Voxel d = direction(in_direction);
  Voxel first, last;  // of the node's cells and the layer around them, in the node
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = std::max<std::int64_t>(-1, -margin_ - kCells * d[axis]);
    last[axis] = std::min<std::int64_t>(kCells, kCells - 1 + margin_ - kCells * d[axis]);
  }
  for (std::int64_t x = first[0]; x <= last[0]; ++x) {
    for (std::int64_t y = first[1]; y <= last[1]; ++y) {
      const Distance* from = ring.row(x, y) + 1;
      Distance* to = row(x + kCells * d[0], y + kCells * d[1]) + kCells * d[2];
      for (std::int64_t z = first[2]; z <= last[2]; ++z) to[z] = std::min(to[z], from[z]);
    }
  }
}

void DistanceCube::spread(int edge) {
  const std::int64_t count = width_ * width_ * width_;
  for (std::int64_t step = 0; step < margin_; ++step) {
    min_of_three(cells_.data() + kPad, 1, count, one_.data() + kPad);
    min_of_three(one_.data() + kPad, width_, count, two_.data() + kPad);
    Distance* const cells = cells_.data() + kPad;
    const Distance* const from = two_.data() + kPad;
    const std::int64_t plane = width_ * width_;
    for (std::int64_t i = 0; i < count; ++i) {
      const Distance smallest = std::min(std::min(from[i - plane], from[i + plane]), from[i]);
      const int grown = smallest + edge;
      cells[i] = static_cast<Distance>(std::min<int>(cells[i], grown));
    }
  }
}

}  // namespace forcelayer::voxmap_audit
