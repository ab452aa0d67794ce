#include "workbench/viewer/surface/quad_surface.h"

namespace forcelayer::viewer {

// Covers the faces with rectangles: a run along u, then as many equal rows as follow.
void QuadWriter::add(const RelativeVoxel& tile, int axis, int side, std::uint64_t mask) {
  surface_.voxel_faces += static_cast<std::uint64_t>(std::popcount(mask));
  while (mask != 0) {
    const int first = std::countr_zero(mask);
    const int u = first & 7, v = first >> 3;
    int width = 1, height = 1;
    if (faces_ == Faces::kMerged) {
      while (u + width < 8 && ((mask >> (first + width)) & 1u) != 0) ++width;
      const std::uint64_t row = (std::uint64_t{1} << width) - 1;
      while (v + height < 8 && ((mask >> (first + 8 * height)) & row) == row) ++height;
    }
    for (int line = 0; line < height; ++line) {
      mask &= ~(((std::uint64_t{1} << width) - 1) << (first + 8 * line));
    }
    rectangle(tile, axis, side, {u, v}, {width, height});
  }
}

void QuadWriter::rectangle(const RelativeVoxel& tile, int axis, int side, std::array<int, 2> at,
                           std::array<int, 2> size) {
  constexpr std::array<std::array<int, 2>, 4> kOrder = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (int n = 0; n < 4; ++n) {
    const auto& corner = kOrder[static_cast<std::size_t>(side > 0 ? n : 3 - n)];
    RelativeVoxel voxel = tile;
    voxel[axis] += side > 0 ? 1 : 0;
    voxel[(axis + 1) % 3] += at[0] + corner[0] * size[0];
    voxel[(axis + 2) % 3] += at[1] + corner[1] * size[1];
    std::array<float, 3> point{};
    for (int k = 0; k < 3; ++k) {
      point[k] = static_cast<float>(base_m_[k] + voxel[k] * voxel_size_m_);
    }
    surface_.corners.push_back(point);
  }
  surface_.directions.push_back(static_cast<std::uint8_t>(2 * axis + (side > 0 ? 1 : 0)));
}

}  // namespace forcelayer::viewer
