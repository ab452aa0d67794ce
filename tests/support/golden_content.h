// The content of the golden files as formulas. The files must give these values for ever.
#pragma once

#include <cmath>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/file/file_bytes.h"
#include "tests/support/dense_voxmap.h"
#include "tests/support/make_pshell.h"
#include "tests/support/places.h"

namespace forcelayer::testing {

// v2.vox: values alone. A box on both sides of x = -512, so in two directory cells, with bricks
// inside of it that are one entry each; one voxel by itself; free entries with clearances up to a
// cropped side.
inline DenseVoxels golden_voxels() {
  DenseVoxels voxels({-520, 0, 0}, {80, 56, 56}, 0.0025);
  voxels.add_solid({-512, 8, 8}, {-496, 24, 24});
  voxels.add_solid({-470, 40, 40}, {-469, 41, 41});
  return voxels;
}

inline DenseVoxmapOptions golden_voxmap_options() {
  DenseVoxmapOptions options;
  options.clearances = true;
  options.offset_layers = 1;  // the single voxel is too narrow for more
  options.static_deviation_m = 0.0000078125;
  options.cropped_sides = kCroppedMaxX;
  options.valid_box = {{-600, -100, -100}, {-400, 200, 200}};
  options.provenance = R"({"made by":"tests/support/golden_content.h","inputs":[]})";
  return options;
}

// v2.pshell: points on a sphere of radius 20 mm about the point that `center_m` names.
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
  options.convex_radius_m = 0.00175;
  options.convex_gap_m = 0.00025;
  options.losses = {{0.002, 0.0015}, {0.004, 0.00075}, {0.008, 0.0005}};
  options.part_deviation_m = 0.000001;
  options.center_m = {0.5, 0, 0};
  options.weight_m2 = 0.00005;
  options.super_block_blocks = 1;
  options.cones = true;
  options.provenance = R"({"made by":"tests/support/golden_content.h","inputs":[]})";
  return options;
}

// v2_distances.vox: one brick in each of the three trees. The mesh is two points, the objects
// "left" and "right", in the centers of the voxels (3, 3, 3) and (4, 4, 4). A code's step is 1/32
// voxel, and code 127 begins at 0.
class GoldenDistances {
 public:
  static constexpr std::int32_t kStepsPerVoxel = 32, kZeroCode = 127;

  GoldenDistances() {
    header_.voxel_size_m = 0.001;
    header_.dims_voxels = {8, 8, 8};
    header_.valid_min_voxel = {-8, -8, -8};
    header_.valid_max_voxel = {16, 16, 16};
    header_.offset_layers = 2;
    header_.metric = static_cast<std::uint32_t>(Metric::kEuclidean);
    header_.directory_dims = {1, 1, 1};
    header_.object_count = 2;
    header_.triangles = 2;
    header_.zero_force_m = (1 + 888.0 / 1024 + 1) * 0.001;
    header_.force_depth_m = 0.001;
    header_.distance_quantum_m = 0.001 / kStepsPerVoxel;
    header_.distance_zero_code = kZeroCode;
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const std::int64_t x = n >> 6, y = (n >> 3) & 7, z = n & 7;
      add_voxel(n, x, y, z);
      const auto farthest = static_cast<std::uint32_t>(std::max({x, y, z}));
      add_entry(values_, n, uniform_entry(0, 64 * farthest - 7),
                uniform_entry(0, 8 * farthest - 7));
      add_entry(distances_, n, uniform_entry(kMaxDistanceCode), uniform_entry(kMaxDistanceCode));
      add_entry(objects_, n, uniform_entry(0), uniform_entry(0));
    }
  }

  VoxmapContent content() const {
    VoxmapContent content;
    content.header = header_;
    content.values = values_.content();
    content.distances = distances_.content();
    content.objects = objects_.content();
    content.object_names = {kNames, sizeof kNames};
    content.compliance = compliance_;
    content.provenance =  // 64 bytes: no padding follows that it might grow into
        R"({"made by":"tests/support/golden_content.h","inputs":["L", "R"]})";
    return content;
  }

  // By the definitions of voxmap_format.md.
  static std::int64_t squared_distance(std::int64_t x, std::int64_t y, std::int64_t z,
                                       std::int64_t point) {
    return (x - point) * (x - point) + (y - point) * (y - point) + (z - point) * (z - point);
  }
  static VoxelValue value(std::int64_t x, std::int64_t y, std::int64_t z) {
    // The interior: squared distances below 1.867^2 voxels. It is a cube of 3^3 about each point.
    std::int64_t layer = 4;
    for (const std::int64_t point : {3, 4}) {
      layer = std::min(
          layer, std::max({std::abs(x - point), std::abs(y - point), std::abs(z - point)}) - 1);
    }
    constexpr VoxelValue kValues[] = {VoxelValue::kInterior, VoxelValue::kSurface,
                                      VoxelValue::kProximity};
    return layer > 2 ? VoxelValue::kFree : kValues[std::max<std::int64_t>(layer, 0)];
  }
  static std::uint32_t code(std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto squared =
        static_cast<double>(std::min(squared_distance(x, y, z, 3), squared_distance(x, y, z, 4)));
    const auto steps = static_cast<std::int32_t>(std::sqrt(squared) * kStepsPerVoxel);
    return static_cast<std::uint32_t>(std::min(steps + kZeroCode, 255));
  }
  static std::uint32_t object(std::int64_t x, std::int64_t y, std::int64_t z) {
    return squared_distance(x, y, z, 3) <= squared_distance(x, y, z, 4) ? 1 : 2;
  }

 private:
  static constexpr char kNames[] = {'l', 'e', 'f', 't', 0, 'r', 'i', 'g', 'h', 't', 0};

  struct Tree {
    std::vector<std::uint32_t> directory = {0}, upper = {}, lower = {}, brick = {};
    TreeContent content() const { return {directory, upper, lower, brick}; }
  };

  static void add_entry(Tree& tree, std::uint32_t n, std::uint32_t upper, std::uint32_t lower) {
    tree.upper.push_back(n == 0 ? 0 : upper);
    tree.lower.push_back(n == 0 ? 0 : lower);
  }
  static void add_element(Tree& tree, std::uint32_t n, std::uint32_t bits, std::uint32_t element) {
    if (n * bits % 32 == 0) tree.brick.push_back(0);
    tree.brick.back() |= element << (n * bits % 32);
  }
  void add_voxel(std::uint32_t n, std::int64_t x, std::int64_t y, std::int64_t z) {
    const VoxelValue stored = value(x, y, z);
    header_.interior_voxels += stored == VoxelValue::kInterior;
    header_.surface_voxels += stored == VoxelValue::kSurface;
    header_.proximity_voxels += stored == VoxelValue::kProximity;
    add_element(values_, n, kValueBits, static_cast<std::uint32_t>(stored));
    add_element(distances_, n, kDistanceBits, code(x, y, z));
    add_element(objects_, n, kObjectBits, object(x, y, z));
  }

  VoxmapHeader header_{};
  Tree values_, distances_, objects_;
  std::vector<float> compliance_{0.0f, 0.25f, 0.75f, 1.75f};
};

// A committed file's bytes: quicker than building its content again. Throws where it is missing.
inline AlignedBytes golden_file_bytes(const char* name) {
  const auto file = FileBytes::read(test::source_path(std::string("tests/golden/") + name));
  if (!file) throw std::runtime_error(to_line(file.error()));
  return AlignedBytes(file->bytes());
}

}  // namespace forcelayer::testing
