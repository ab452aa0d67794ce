// One contact between a part and a static body with a closed formula: its poses, and how a wrench
// differs there from the true one.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "formats/voxmap.h"
#include "tests/bench/wrench_bench_fit.h"
#include "tests/bench/wrench_bench_scene.h"
#include "tests/bench/wrench_bench_shell.h"

namespace forcelayer::bench {

enum class Part { kSphere, kBox, kCylinder, kCone, kTorus };
enum class Stance { kAnyWay, kFaceDown, kCapDown, kAlongBore, kAlongWedge, kEdgeDown };

struct Combination {
  std::string name;
  Part part;
  Stance stance;
  StaticKind body;
  double radius_m = 0;
  double free_angle = 0;
  bool smooth = true;         // flush or smooth: counts in the medians
  bool wall_by_wall = false;  // the exact offset surface has its own offset at each wall
};

// Shells of one part at one voxel size: the one that is judged, and a dense one for the truth.
struct PartShells {
  AnalyticShell tested, fine;
};

// A contact at one random orientation of the static body (and of the part where its stance leaves
// that open). Meters; part poses are of its center.
class ContactCase {
 public:
  ContactCase(const Combination& combination, const PartShells& shells, double voxel_size_m,
              std::mt19937_64& random, VoxelKind kind = VoxelKind::kChebyshev);

  struct Placed {  // world_from_part
    glm::dmat3 rotation;
    glm::dvec3 position_m;
  };
  using WrenchAt = std::function<Wrench(const Placed&)>;

  // Judges a way to a wrench at the first so many shifts; its unit of force may be any.
  static constexpr std::size_t kDepths = 12, kShifts = 12;
  Quality judge(const WrenchAt& wrench_at, std::size_t shifts = kShifts,
                LoadOfTruth load = LoadOfTruth::kWhole) const;

  std::vector<Placed> slide() const;  // the frames of the slide
  glm::dvec3 out() const;             // the way out at its first frame, world
  const AnalyticStatic& body() const { return body_; }
  const Voxmap& voxmap() const { return *voxmap_; }
  const DenseFields& dense() const { return *dense_; }
  double middle_m() const { return middle_m_; }  // of the force layer, from the surface

 private:
  void orient(std::mt19937_64& random);
  void offset_walls();
  double min_distance(double height_m) const;
  double height_at(double distance_m) const;
  void bake_around();
  Placed place(double height_m, double a_m, double b_m) const;
  glm::dmat3 symmetry(double a_m, double b_m) const;
  void tabulate_truth();
  std::array<double, 2> along_slide(int frame) const;

  static constexpr int kLayers = 2;

  Combination combination_;
  VoxelKind kind_;
  double s_;
  AnalyticStatic body_;
  AnalyticShell tested_, fine_;  // the points that can come near; areas over the mean
  double part_radius_m_;
  glm::dmat3 part_rotation_{1};               // local_from_part
  glm::dvec3 base_m_{0}, approach_{0, 0, 1};  // local: where height 0 is, and the way out
  double thickness_m_ = 0, middle_m_ = 0;     // of the force layer; its distance from the surface
  double rate_ = 1;                           // height over distance
  std::vector<double> depths_m_, heights_m_;
  std::vector<std::array<double, 2>> shifts_m_;
  std::unique_ptr<test::VoxelScene> scene_;
  std::unique_ptr<Voxmap> voxmap_;
  std::unique_ptr<DenseFields> dense_;
  std::vector<TruthTable> truth_;  // [depth]; areas over the mean: points
};

}  // namespace forcelayer::bench
