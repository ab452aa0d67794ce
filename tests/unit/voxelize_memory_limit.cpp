// A triangle that no machine can hold is refused before memory is taken, with the numbers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <set>

#include "voxelize/bake.h"
#include "voxelize/limits/memory_limit.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/scan_conversion.h"

namespace forcelayer {
namespace {

scan::SnappedObject snapped(const mesh::Mesh& mesh, double voxel_size_m) {
  auto object = scan::snap_object(mesh, {}, voxel_size_m, "plate");
  EXPECT_TRUE(object);
  return std::move(*object);
}

mesh::Mesh plate(double edge_m, bool upright = false) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {edge_m, 0, 0}, {0, edge_m, 0}, {1, 1, 1}, {1.1, 1, 1}, {1, 1.1, 1}};
  if (upright) std::swap(mesh.vertices[1][0], mesh.vertices[1][2]);
  mesh.triangles = {{3, 4, 5}, {0, 1, 2}};
  return mesh;
}

TEST(MemoryLimit, CountsTheLargestTriangle) {
  constexpr double kVoxels = 1e4 * 1e4 / 2;
  for (const bool upright : {false, true}) {
    const mesh::Mesh mesh = plate(10, upright);
    const scan::SnappedObject object = snapped(mesh, 1e-3);
    EXPECT_TRUE(limits::fit_memory(object, "plate", 1e-3, 1.51 * kVoxels));
    const Status refused = limits::fit_memory(object, "plate", 1e-3, 1.49 * kVoxels);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge);
    EXPECT_EQ(refused.error().where, "triangle 1 of plate");
    EXPECT_NE(refused.error().what.find("at least 5e+07 voxels, which take 0.075 GB"),
              std::string::npos)
        << to_line(refused.error());
  }
}

// An object of a meter with one vertex far away.
mesh::Mesh stray_vertex(double away_m) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {1, 0, 0}, {0.005, 0.005, -away_m}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 4}, {1, 3, 2}};
  return mesh;
}

// The sliver covers no plane of voxels, but is a brick every 8 and a node every 64 voxels.
TEST(MemoryLimit, CountsTheLongestSliver) {
  const mesh::Mesh mesh = stray_vertex(1e4);
  const scan::SnappedObject object = snapped(mesh, 1e-2);
  const double smallest = 1e6 / 64 * (8 * 96 + sizeof(masks::LowerMaskNode));
  EXPECT_TRUE(limits::fit_memory(object, "part", 1e-2, 1.01 * smallest));
  const Status refused = limits::fit_memory(object, "part", 1e-2, 0.99 * smallest);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge);
  EXPECT_EQ(refused.error().where, "triangle 1 of part");
  EXPECT_NE(refused.error().what.find("at least 1e+06 voxels"), std::string::npos);
  EXPECT_NE(refused.error().mend.find("stray vertex"), std::string::npos);
}

// A refused bake could not have been held: the voxels that the surface passes through, alone, take
// more than is said.
TEST(MemoryLimit, SaysLessThanTheVoxelsTake) {
  for (const double away_m : {1.0, 10.0, 100.0}) {
    for (const double voxel_size_m : {1e-2, 1e-3}) {
      const mesh::Mesh mesh = stray_vertex(away_m);
      const scan::SnappedObject object = snapped(mesh, voxel_size_m);
      const auto tree = scan::scan_convert(object, {-(1 << 20), -(1 << 20), -(1 << 20)});
      const double taken = static_cast<double>(tree->memUsage());
      EXPECT_TRUE(limits::fit_memory(object, "part", voxel_size_m, taken))
          << away_m << " " << voxel_size_m;
      // And not so much less that it were of no use.
      EXPECT_FALSE(limits::fit_memory(object, "part", voxel_size_m, taken / 8));
    }
  }
}

TEST(MemoryLimit, NamesAVoxelSizeThatFits) {
  for (const mesh::Mesh& mesh : {plate(10), stray_vertex(1e3)}) {
    const Status refused = limits::fit_memory(snapped(mesh, 1e-3), "plate", 1e-3, 1e6);
    ASSERT_FALSE(refused);
    double size_m = 0;
    const std::string& mend = refused.error().mend;
    ASSERT_EQ(std::sscanf(mend.c_str() + mend.find("--voxel-size"), "--voxel-size %lfm", &size_m),
              1);
    EXPECT_TRUE(limits::fit_memory(snapped(mesh, size_m), "plate", size_m, 1e6)) << mend;
    EXPECT_FALSE(limits::fit_memory(snapped(mesh, 0.9 * size_m), "plate", 0.9 * size_m, 1e6))
        << mend;
  }
}

// A needle along x in the middle of nodes, and one along an edge of four of them.
TEST(MemoryLimit, CountsTheNodesThatALineTouchesAndReaches) {
  constexpr int kNodes = 1000, kReach = 5;
  for (const auto& [offset, reached] : {std::pair{32.5, 1.0}, std::pair{0.5, 4.0}}) {
    mesh::Mesh mesh;
    mesh.vertices = {
        {0.5, offset, offset}, {64.0 * kNodes - 0.5, offset, offset}, {0.5, offset + 0.25, offset}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 1}};  // counted once
    const scan::SnappedObject object = snapped(mesh, 1);
    const limits::NamedObject named{&object, "needle"};
    const limits::NodeBytes bytes{1e4, 1e3};
    const double smallest = kNodes * (bytes.touched + reached * bytes.reached);
    EXPECT_TRUE(limits::fit_nodes({&named, 1}, kReach, bytes, 1, 1.02 * smallest)) << offset;
    const Status refused = limits::fit_nodes({&named, 1}, kReach, bytes, 1, 0.999 * smallest);
    ASSERT_FALSE(refused) << offset;
    EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge);
    EXPECT_EQ(refused.error().where, "needle");
  }
}

TEST(MemoryLimit, NamesTheObjectAndItsStrayVertex) {
  const mesh::Mesh small = plate(2), stray = stray_vertex(1e6);
  const scan::SnappedObject objects[] = {snapped(small, 0.1), snapped(stray, 0.1)};
  const limits::NamedObject named[] = {{&objects[0], "plate"}, {&objects[1], "bracket"}};
  const Status refused = limits::fit_nodes(named, 5, {17e3, 11e3}, 0.1, 1e9);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().where, "bracket");
  EXPECT_TRUE(
      refused.error().mend.starts_with("correct the stray vertex at (0.00498047, 0.00498047, "
                                       "-1e+06) m (it is 1e+06 m from the object's middle"))
      << refused.error().mend;
}

// Never more nodes than there are: each node that holds a voxel of the surface, and each within
// reach of one, by brute force.
TEST(MemoryLimit, CountsNoNodeThatABakeDoesNotMake) {
  std::mt19937_64 random(20);
  std::uniform_real_distribution<double> anywhere(-400, 400), within(-30, 30);
  for (int soup = 0; soup < 20; ++soup) {
    mesh::Mesh mesh;
    for (std::uint32_t t = 0; t < 6; ++t) {
      const mesh::Vec3d at{anywhere(random), anywhere(random), anywhere(random)};
      for (int k = 0; k < 3; ++k) {
        const bool is_near = t % 2 == 0 || k > 0;
        mesh.vertices.push_back(is_near ? mesh::Vec3d{at[0] + within(random), at[1], at[2]} : at);
        if (t % 3 == 0 && k == 2) mesh.vertices.back()[1] = anywhere(random);
      }
      mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    const scan::SnappedObject object = snapped(mesh, 1);
    constexpr int kReach = 5;
    std::set<lattice::VoxelIndex> touched, reached;
    for (std::size_t t = 0; t < object.triangles.size(); ++t) {
      for (const lattice::VoxelIndex& at : lattice::overlapped_voxels(object.triangle(t))) {
        touched.insert({at[0] >> 6, at[1] >> 6, at[2] >> 6});
        for (int n = 0; n < 27; ++n) {
          reached.insert({(at[0] + kReach * (n / 9 - 1)) >> 6,
                          (at[1] + kReach * (n / 3 % 3 - 1)) >> 6,
                          (at[2] + kReach * (n % 3 - 1)) >> 6});
        }
      }
    }
    const limits::NamedObject named{&object, "soup"};
    const limits::NodeBytes bytes{1, 1};
    const auto largest = static_cast<double>(touched.size() + reached.size());
    EXPECT_TRUE(limits::fit_nodes({&named, 1}, kReach, bytes, 1, largest)) << "soup " << soup;
    // And not so few that the count were of no use: the triangles are needles.
    EXPECT_FALSE(limits::fit_nodes({&named, 1}, kReach, bytes, 1, largest / 3)) << "soup " << soup;
  }
}

// Within the directory's limit, and some 10 TB.
TEST(MemoryLimit, HoldsInABake) {
  const mesh::Mesh mesh = plate(3000);
  voxelize::SceneObject object;
  object.name = "plate";
  object.mesh = &mesh;
  voxelize::BakeOptions options;
  options.voxel_size_m = 1e-3;
  options.threads = 1;
  const auto refused = voxelize::bake(std::span(&object, 1), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge) << to_line(refused.error());
  EXPECT_GT(limits::available_bytes(), 1e8);
}

}  // namespace
}  // namespace forcelayer
