// Contacts between triangle meshes, judged by the exact distance between them: no formula, no
// symmetry, every pose with a truth of its own. The truth is shared by all kinds and peers.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "tests/bench/wrench_bench_dense.h"
#include "tests/bench/wrench_bench_exact.h"
#include "tests/bench/wrench_bench_fit.h"
#include "tests/bench/wrench_bench_shell.h"
#include "tests/support/voxel_kind.h"

namespace forcelayer::bench {

// A static scene and a part, m, each in its own frame.
struct MeshPair {
  std::string name;
  mesh::Mesh scene, part;
};

inline constexpr const char* kPairNames[] = {"pump on bay", "bracket on gearbox",
                                             "teapot on dragon", "bunny on engine",
                                             "module on counter"};

// The pair of one of these names. Throws std::runtime_error where a file is missing.
MeshPair mesh_pair(const std::string& name, const std::string& models);

// A part as this bench needs it, for one voxel size.
struct PairPart {
  PairPart(const MeshPair& pair, double voxel_size_m, double covering_radius_m);

  // Points of the exact surface that lie near each other, and a sphere around them.
  struct Block {
    std::size_t first, count;
    glm::dvec3 center_m;
    double radius_m;
  };

  mesh::Mesh mesh;                 // about the shell's center
  Pshell shell;                    // the project's own bake
  AnalyticShell tested;            // the same points, areas over their mean
  std::vector<glm::dvec3> fine_m;  // pieces of the exact surface: their middles
  std::vector<double> fine_area;   // over the mean area of a tested point
  std::vector<Block> blocks;       // of these
};

// One contact: the part comes along a random line, turned at random, until it touches; the scene
// lies at random on the lattice, at several sub-voxel shifts.
class PairContact {
 public:
  // All must outlive the contact.
  PairContact(const mesh::Mesh& scene, const ExactDistance& distance, const PairPart& part,
              double voxel_size_m, std::mt19937_64& random);

  static constexpr std::size_t kDepths = 12, kShifts = 4, kFrames = 200;

  const Pose& world_from_scene(std::size_t shift) const { return world_from_scene_[shift]; }

  // The scene as it lies at a shift, in voxels of a kind: the whole map, or around the contact.
  Voxmap bake(test::VoxelKind kind, std::size_t shift, bool whole) const;

  // Exact distances at the voxel centers that the part's points need, at the poses of kFull.
  DenseDistances distances(std::size_t shift) const;

  // The wrench at world_from_center with the scene at a shift, world axes, about the center.
  using WrenchAt = std::function<Wrench(std::size_t shift, const Pose& world_from_center)>;
  // Judges the force in voxels of a kind, at the first so many shifts.
  Quality judge(test::VoxelKind kind, const WrenchAt& wrench_at, std::size_t shifts = kShifts,
                LoadOfTruth load = LoadOfTruth::kWhole) const;

  // World poses along the line at shift 0, through the force layer of a kind, kFrames of them.
  std::vector<Pose> frames(test::VoxelKind kind) const;

  // Where the force of a kind begins, from the mesh.
  double offset_m(test::VoxelKind kind) const { return layer(kind).offset_m; }

  // The exact offset surface of kFull near the contact as a mesh, scene frame, for mesh colliders;
  // and the largest deviation of its vertices from that surface, m.
  mesh::Mesh offset_mesh() const;
  double offset_mesh_deviation_m(const mesh::Mesh& mesh) const;

 private:
  // The poses through the force layer of one kind, and what is true there.
  struct Layer {
    double offset_m = 0;
    std::vector<double> depths_m, heights_m;  // deepest first
    std::vector<TruthTable> truth;
  };

  const Layer& layer(test::VoxelKind kind) const { return layers_[static_cast<std::size_t>(kind)]; }
  bool approach(std::mt19937_64& random);
  double advanced_to(double height_m, double distance_m);
  Pose at_height(double height_m) const;                                  // scene_from_center
  glm::dvec3 placed(const glm::dvec3& on_part_m, double height_m) const;  // scene frame
  void keep_near_points();
  void tabulate_truth();

  const mesh::Mesh& scene_;
  const ExactDistance& distance_;
  const PairPart& part_;
  double s_;
  glm::dquat turn_;          // scene_from_center
  glm::dvec3 aim_m_, line_;  // the center is at aim + height * line
  double reach_m_;
  double thickness_m_ = 0;
  std::array<Layer, 3> layers_;    // kChebyshev, kLean, kFull
  std::vector<std::size_t> near_;  // fine points that can come near
  // Distances of blocks and of fine points when last measured, and the height then: a distance
  // changes by no more than the part has gone.
  struct Measured {
    double distance_m, height_m;
  };
  std::vector<Measured> block_at_, point_at_;
  std::size_t nearest_ = 0;  // fine point, when last advanced
  std::vector<Pose> world_from_scene_;
};

}  // namespace forcelayer::bench
