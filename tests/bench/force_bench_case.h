// One contact between a part and a static body: its poses, what is true there, and how a force
// model differs from it (force.md).
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "runtime/field/force_field.h"
#include "runtime/query/contact_query.h"
#include "tests/bench/force_bench_fit.h"
#include "tests/bench/force_bench_scene.h"
#include "tests/bench/force_bench_shell.h"

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
  bool standoff = false;      // the exact offset surface is k |n|_1 s off, and the fitted distance
};

enum class Method {
  kTangentPlane,
  kTangentPlaneAveraged,  // the paper's N/10
  kTrilinear,             // of the eight nearest levels, along the normal
  kBSpline,               // quadratic, of 27 levels, along the normal
  kSlopeOnly,             // the level field's phi, along its slope everywhere
  kLevel,                 // runtime/field/level_field.h, as voxrun uses it
  kContacts,              // the level field as the default model uses it: directions averaged
  kDistance,              // trilinear float distance to the exact surface, along its gradient
  kStandoff,              // exact, but each wall as far off as the map's layers hold it
  // In maps of other kinds.
  kEuclideanLevel,     // the level field in Euclidean layers
  kEuclideanContacts,  // ... with averaged directions
  kNormal8,            // trilinear depth by stored distances, along the part's normal
  kCellSlope8,         // the same along the slope of that interpolation, which jumps between cells
  kDistance8,          // runtime/field/distance_field.h
};
VoxelKind kind_of(Method method);
inline constexpr Method kMethods[] = {Method::kTangentPlane,      Method::kTangentPlaneAveraged,
                                      Method::kTrilinear,         Method::kBSpline,
                                      Method::kSlopeOnly,         Method::kLevel,
                                      Method::kContacts,          Method::kDistance,
                                      Method::kStandoff,          Method::kEuclideanLevel,
                                      Method::kEuclideanContacts, Method::kNormal8,
                                      Method::kCellSlope8,        Method::kDistance8};
const char* name_of(Method method);

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
  ~ContactCase();

  struct Placed {  // world_from_part
    glm::dmat3 rotation;
    glm::dvec3 position_m;
  };
  using WrenchAt = std::function<Wrench(const Placed&)>;

  // The step takes longer than all the rest: NAN where it is not asked for.
  Quality judge(Method method, bool with_step = true) const;

  // The same of any other way to a wrench, but for the step, at the first so many shifts; its unit
  // of force may be any. `shared`: how the truth is.
  static constexpr std::size_t kDepths = 12, kShifts = 12;
  Quality judge(const WrenchAt& wrench_at, std::size_t shifts = kShifts,
                Shared shared = Shared::kNot) const;

  std::vector<Placed> slide() const;  // the frames of the slide
  const AnalyticStatic& body() const { return body_; }
  const Voxmap& voxmap() const { return *voxmap_; }
  const DenseFields& dense() const { return *dense_; }
  double middle_m() const { return middle_m_; }  // of the force layer, from the surface

 private:
  void orient(std::mt19937_64& random);
  void offset_walls();
  double least_distance(double height_m) const;
  double height_at(double distance_m) const;
  void bake_around();
  Placed place(double height_m, double a_m, double b_m) const;
  glm::dmat3 symmetry(double a_m, double b_m) const;
  Wrench force(Method method, const Placed& placed) const;
  struct Collected;
  void collect(const Placed& placed, Collected& collected) const;
  Wrench field_force(const field::ForceField& field, const Placed& placed, bool averaged) const;
  glm::dvec3 standoff_force(const glm::dvec3& x) const;
  template <class Push>
  Wrench sum(const Placed& placed, Push push) const;
  void tabulate_truth();
  Wrench truth_at(std::size_t depth, double offset_m, Shared shared) const;
  std::array<double, 2> along_slide(int frame) const;
  double worst_step(const WrenchAt& wrench_at) const;

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
  std::unique_ptr<field::ForceField> field_;
  std::vector<TruthTable> truth_;  // [depth]; areas over the mean: points
};

}  // namespace forcelayer::bench
