// A list of points with inward normals as a valid .pshell file: simple and obviously right.
//
//   BuiltPshell built({{0.1, 0, 0}, {-0.1, 0, 0}}, {{-1, 0, 0}, {1, 0, 0}});  // built.pshell()
//   write_test_pshell("part.pshell", points, normals, options);
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "formats/pshell.h"
#include "formats/pshell_writer.h"
#include "tests/support/aligned_bytes.h"

namespace forcelayer::testing {

using Vec3 = std::array<double, 3>;

// The shell's fields that a list of points does not give. Points keep their order.
struct TestShellOptions {
  double voxel_size_m = 0.005;
  double covering_radius_m = 0.004;
  double convex_radius_m = 0;
  std::optional<double>
      convex_gap_m;  // absent: the covering radius, which the nearest point proves
  std::vector<DistanceLoss> losses;
  double part_deviation_m = 0;
  Vec3 center_m{0, 0, 0};  // part frame; the stored points are relative to it
  double weight_m2 = 2.5e-5;
  std::uint32_t block_points = kDefaultBlockPoints;
  std::uint32_t super_block_blocks = kDefaultSuperBlockBlocks;
  bool cones = false;
  std::vector<std::uint8_t> two_sided;  // of each point; empty: all have an inside
  std::string provenance = "{}";
};

// The shell's arrays, owned; content() is what the writer takes.
class TestShell {
 public:
  // `points` in meters, `normals` inward, of any length but zero; both in the part's frame.
  TestShell(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
            const TestShellOptions& options)
      : two_sided_(options.two_sided), provenance_(options.provenance), losses_(options.losses) {
    if (points.empty() || points.size() != normals.size()) {
      throw std::invalid_argument("a shell needs points and as many normals");
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& n = normals[i];
      const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        position_[axis].push_back(static_cast<float>(points[i][axis] - options.center_m[axis]));
        normal_[axis].push_back(static_cast<float>(n[axis] / length));
      }
      weight_.push_back(static_cast<float>(options.weight_m2));
      if (options.cones) cone_.push_back(1.0f);
    }
    fill_spheres(options);
    fill_header(options);
  }

  // Valid while this lives.
  PshellContent content() const {
    return {header_,    position_[0], position_[1], position_[2], normal_[0],
            normal_[1], normal_[2],   weight_,      blocks_,      super_blocks_,
            cone_,      provenance_,  losses_,      two_sided_};
  }
  PshellHeader& header() { return header_; }

 private:
  double distance(std::size_t point, const Vec3& from) const {
    double squared = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double d = double{position_[axis][point]} - from[axis];
      squared += d * d;
    }
    return std::sqrt(squared);
  }

  // Around the middle of the box of points [begin, end); the radius is rounded up.
  BoundingSphere sphere_of(std::size_t begin, std::size_t end) const {
    std::array<float, 3> middle{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::span<const float> some(&position_[axis][begin], end - begin);
      const auto [low, high] = std::minmax_element(some.begin(), some.end());
      middle[axis] = 0.5f * (*low + *high);
    }
    double radius = 0;
    for (std::size_t i = begin; i < end; ++i) {
      radius = std::max(radius, distance(i, {middle[0], middle[1], middle[2]}));
    }
    const float up = std::nextafter(static_cast<float>(radius), std::numeric_limits<float>::max());
    return {middle[0], middle[1], middle[2], up};
  }

  std::vector<BoundingSphere> spheres_of(std::size_t points_each) const {
    std::vector<BoundingSphere> spheres;
    for (std::size_t i = 0; i < weight_.size(); i += points_each) {
      spheres.push_back(sphere_of(i, std::min(weight_.size(), i + points_each)));
    }
    return spheres;
  }

  void fill_spheres(const TestShellOptions& options) {
    blocks_ = spheres_of(options.block_points);
    super_blocks_ = spheres_of(std::size_t{options.block_points} * options.super_block_blocks);
  }

  void fill_header(const TestShellOptions& options) {
    header_.point_count = weight_.size();
    header_.block_points = options.block_points;
    header_.super_block_blocks = options.super_block_blocks;
    header_.block_count = blocks_.size();
    header_.super_block_count = super_blocks_.size();
    header_.covering_radius_m = options.covering_radius_m;
    header_.convex_radius_m = options.convex_radius_m;
    header_.convex_gap_m = options.convex_gap_m.value_or(options.covering_radius_m);
    header_.voxel_size_m = options.voxel_size_m;
    double radius = 0;
    for (std::size_t i = 0; i < weight_.size(); ++i) radius = std::max(radius, distance(i, {}));
    header_.bounding_radius_m = std::nextafter(radius, 1e300);
    header_.part_deviation_m = options.part_deviation_m;
    header_.center_m = options.center_m;
    header_.area_m2 = options.weight_m2 * static_cast<double>(weight_.size());
    header_.mass_source = static_cast<std::uint32_t>(MassSource::kArea);
    header_.method = static_cast<std::uint32_t>(ShellMethod::kSurface);
    for (std::size_t axis = 0; axis < 3; ++axis) header_.inertia_m2[axis] = 0.4 * radius * radius;
  }

  PshellHeader header_{};
  std::array<std::vector<float>, 3> position_, normal_;
  std::vector<float> weight_, cone_;
  std::vector<std::uint8_t> two_sided_;
  std::vector<BoundingSphere> blocks_, super_blocks_;
  std::string provenance_;
  std::vector<DistanceLoss> losses_;
};

// A Pshell in memory with these points. Movable; throws where the reader refuses the bytes.
class BuiltPshell {
 public:
  BuiltPshell(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
              const TestShellOptions& options = {})
      : bytes_(pshell_bytes(TestShell(points, normals, options).content())),
        pshell_(checked(
            Pshell::from_bytes(bytes_.bytes(), "test shell", Verify::kStructureAndChecksums))) {}

  const Pshell& pshell() const { return pshell_; }

 private:
  static Pshell checked(Result<Pshell> result) {
    if (!result) throw std::runtime_error(to_line(result.error()));
    return std::move(*result);
  }

  AlignedBytes bytes_;
  Pshell pshell_;
};

// Writes a valid .pshell file with these points; throws on failure.
inline void write_test_pshell(const std::filesystem::path& path, const std::vector<Vec3>& points,
                              const std::vector<Vec3>& normals,
                              const TestShellOptions& options = {}) {
  const auto written = write_pshell(path, TestShell(points, normals, options).content());
  if (!written) throw std::runtime_error(to_line(written.error()));
}

}  // namespace forcelayer::testing
