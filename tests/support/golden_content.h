// What the golden files hold, as formulas: the files must keep giving these values for ever.
#pragma once

#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/file/mapped_file.h"
#include "tests/support/dense_voxmap.h"
#include "tests/support/make_pshell.h"

namespace forcelayer::testing {

// v1.vox: an interior box that is one entry of an upper node, bricks on the other side of x = -512
// (another directory entry), a few single voxels, and free entries with clearances up to a cropped
// side.
inline DenseVoxels golden_voxels() {
  DenseVoxels voxels({-520, 0, -8}, {90, 70, 80}, 0.0025);
  voxels.fill({-512, 0, 0}, {-448, 64, 64}, VoxelValue::kInterior);
  voxels.fill({-513, 0, 0}, {-512, 64, 64}, VoxelValue::kSurface);
  voxels.fill({-514, 0, 0}, {-513, 64, 64}, VoxelValue::kProximity);
  voxels.set(-440, 17, 33, VoxelValue::kProximity);
  voxels.set(-440, 17, 34, VoxelValue::kSurface);
  voxels.set(-440, 18, 34, VoxelValue::kInterior);
  voxels.set(-431, 69, -8, VoxelValue::kSurface);
  return voxels;
}

inline DenseVoxmapOptions golden_voxmap_options() {
  DenseVoxmapOptions options;
  options.clearances = true;
  options.offset_layers = 2;
  options.static_deviation_m = 0.0000078125;
  options.cropped_sides = kCroppedMaxX;
  options.valid_box = {{-600, -100, -100}, {-400, 200, 200}};
  options.provenance = R"({"made by":"tests/support/golden_content.h","inputs":[]})";
  return options;
}

// v1.pshell: points on a sphere of radius 20 mm about the point that `center_m` names.
struct GoldenPoints {
  std::vector<Vec3> points, normals;
};

inline GoldenPoints golden_points() {
  constexpr int kCount = 100;
  GoldenPoints shell;
  for (int i = 0; i < kCount; ++i) {  // multiples of 2^-12 m: exact in float, on any machine
    const double z = 1 - (2 * i + 1.0) / kCount;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Vec3 direction{r * std::cos(angle), r * std::sin(angle), z};
    Vec3 point{}, normal{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      point[axis] = std::round(0.02 * direction[axis] * 4096) / 4096 + (axis == 0 ? 0.5 : 0.0);
      normal[axis] = 0;
    }
    normal[static_cast<std::size_t>(i) % 3] = i % 2 ? 1 : -1;  // exact; not the sphere's
    shell.points.push_back(point);
    shell.normals.push_back(normal);
  }
  return shell;
}

inline TestShellOptions golden_shell_options() {
  TestShellOptions options;
  options.voxel_size_m = 0.0025;
  options.covering_radius_m = 0.002;
  options.part_deviation_m = 0.000001;
  options.center_m = {0.5, 0, 0};
  options.weight_m2 = 0.00005;
  options.super_block_blocks = 1;
  options.cones = true;
  options.provenance = R"({"made by":"tests/support/golden_content.h","inputs":[]})";
  return options;
}

// v1_wide.vox: one block at four bits. Brick 0 holds code n % 16 in voxel n; brick 1 is full of the
// highest code but for its last voxel, which is 0.
class GoldenWideVoxmap {
 public:
  static constexpr std::uint32_t kFarCode = 15;

  GoldenWideVoxmap()
      : upper_(kNodeEntries, uniform_entry(kFarCode, 1)),
        lower_(kNodeEntries, uniform_entry(12, 0)),
        bricks_(2 * brick_bytes(4) / sizeof(std::uint32_t), 0) {
    upper_[0] = 0;
    lower_[0] = 0;
    lower_[511] = 1;
    lower_[1] = uniform_entry(0);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      bricks_[n / 8] |= (n % 16) << (4 * (n % 8));
      bricks_[64 + n / 8] |= (n == 511 ? 0 : kFarCode) << (4 * (n % 8));
    }
    header_.voxel_size_m = 0.001;
    header_.dims_voxels = {64, 64, 64};
    header_.valid_max_voxel = {64, 64, 64};
    header_.offset_layers = 2;
    header_.metric = static_cast<std::uint32_t>(Metric::kEuclidean);
    header_.bits_per_voxel = 4;
    header_.directory_dims = {1, 1, 1};
    // Brick 0 has 32 voxels of each code; codes 0-4 are interior, 5-7 surface, 8-10 proximity.
    header_.interior_voxels = 5 * 32 + 512 + 1;
    header_.surface_voxels = 3 * 32;
    header_.proximity_voxels = 3 * 32;
    header_.range_m = 0.004;
    header_.quantum_m = 0.0005;
    header_.zero_code = 4;
    header_.surface_code = 5;
    header_.proximity_code = 8;
    header_.free_code = 11;
  }

  VoxmapContent content() const {
    return {header_, directory_, upper_, lower_, bricks_, compliance_, "{}"};
  }

 private:
  VoxmapHeader header_{};
  std::vector<std::uint32_t> directory_{0};
  std::vector<std::uint32_t> upper_, lower_, bricks_;
  std::vector<float> compliance_{0.0f, 0.25f, 0.75f, 1.75f};
};

// A committed file's bytes: quicker than building its content again. Throws where it is missing.
inline AlignedBytes golden_file_bytes(const char* name) {
  const auto file =
      MappedFile::open(std::filesystem::path(FORCELAYER_SOURCE_DIR) / "tests" / "golden" / name);
  if (!file) throw std::runtime_error(to_line(file.error()));
  return AlignedBytes(file->bytes());
}

}  // namespace forcelayer::testing
