// Contacts between triangle meshes, judged by the exact distance between them: no formula, no
// symmetry, every pose with a truth of its own.
#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "pointshell/part/triangle_tree.h"
#include "tests/bench/force_bench_fit.h"
#include "tests/bench/force_bench_shell.h"
#include "tests/stress/baked.h"

namespace forcelayer::bench {

// A static scene and a part, m, each in its own frame.
struct MeshPair {
  std::string name;
  mesh::Mesh scene, part;
};

// The sample part on the sample scene, and those of the shared models that are there.
std::vector<MeshPair> mesh_pairs(const std::string& models);

// A part as this bench needs it, for one voxel size.
struct PairPart {
  PairPart(const MeshPair& pair, double voxel_size_m);

  mesh::Mesh mesh;                 // about the shell's center
  Pshell shell;                    // the project's own bake
  AnalyticShell tested;            // the same points, areas over their mean
  std::vector<glm::dvec3> fine_m;  // pieces of the exact surface: their middles
  std::vector<double> fine_area;   // over the mean area of a tested point
};

// One contact: the part comes along a random line, turned at random, until it touches; the scene
// lies at random on the lattice, at several sub-voxel shifts.
class PairCase {
 public:
  PairCase(const MeshPair& pair, const PairPart& part, double voxel_size_m, std::mt19937_64& random,
           test::VoxelKind kind = test::VoxelKind::kChebyshev);

  static constexpr std::size_t kDepths = 12, kShifts = 4, kFrames = 200;

  // How the scene lies at a shift.
  struct Placing {
    Pose world_from_scene;
    Voxmap voxmap;
    openvdb::FloatGrid::Ptr distance_m;  // exact, around the poses' shell points
  };
  const Placing& placing(std::size_t shift) const { return placings_[shift]; }

  // The wrench at world_from_center with the scene at a shift, world axes, about the center.
  using WrenchAt = std::function<Wrench(std::size_t shift, const Pose& world_from_center)>;
  // `by_ten`: the truth too is divided by N/10, N the points that the contact area stands for.
  Quality judge(const WrenchAt& wrench_at, bool by_ten) const;

  // World poses along the line at shift 0, through the force layer, 200 frames.
  std::vector<Pose> frames() const;

  double middle_m() const { return middle_m_; }
  // The exact offset surface near the contact as a mesh, scene frame, for mesh colliders; and the
  // largest deviation of its vertices from that surface, m.
  mesh::Mesh offset_mesh() const;
  double offset_mesh_deviation_m(const mesh::Mesh& mesh) const;

 private:
  struct Foot {
    double distance_m;
    glm::dvec3 direction;  // from the foot
  };
  Foot foot(const glm::dvec3& place) const;  // scene frame
  void check_tree(std::mt19937_64& random) const;
  bool approach(std::mt19937_64& random);
  double advanced_to(double height_m, double distance_m);
  Pose at_height(double height_m) const;  // scene_from_center
  void keep_near_points();
  void tabulate_truth();
  void place(std::mt19937_64& random);
  openvdb::FloatGrid::Ptr distances_around(const Pose& world_from_scene) const;

  const MeshPair& pair_;
  const PairPart& part_;
  double s_;
  test::VoxelKind kind_;
  forcelayer::part::Part soup_;
  std::unique_ptr<part::TriangleTree> tree_;
  glm::dquat world_from_scene_turn_;
  glm::dquat turn_;          // scene_from_center
  glm::dvec3 aim_m_, line_;  // the center is at aim + height * line
  double reach_m_;
  double thickness_m_ = 0, middle_m_ = 0;
  std::vector<double> heights_m_;  // by depth, the outermost last
  std::vector<std::size_t> near_;  // fine points that can come near
  // Fine points' distances when last measured, and the height then: a distance changes by no more
  // than the part has gone.
  std::vector<double> measured_m_, measured_at_m_;
  std::vector<TruthTable> truth_;
  std::vector<Placing> placings_;
};

}  // namespace forcelayer::bench
