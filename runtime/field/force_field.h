// The interface between the voxels and the force: how deep each collected point lies in the force
// layer and which way it is pushed.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "forcelayer/parameters.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/query/contact_query.h"

namespace forcelayer {

// Collected points with their depth, in the order of CollectedPoints. The force of one is
// stiffness * depth * direction, on the part at the point.
struct FieldSamples {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> at;  // index into CollectedPoints
  std::vector<float> depth_m;     // > 0 from evaluate(), signed from measure()
  std::vector<float> dx, dy, dz;  // unit, world axes: out of the static scene
  std::vector<float> gx, gy, gz;  // from measure(): slope of the field, per voxel, world axes

  void reserve(std::uint64_t points);  // set-up only
  void set(std::uint32_t i, std::uint32_t point_at, float depth,
           const std::array<float, 3>& direction) noexcept {
    at[i] = point_at;
    depth_m[i] = depth;
    dx[i] = direction[0], dy[i] = direction[1], dz[i] = direction[2];
  }
};

// Reads depth and direction at points in values 2 and 1; with Euclidean layers the level field may
// reach into value 3 (level_field.h). What lies in which value, and so the guard and the guarantee,
// does not depend on the field.
class ForceField {
 public:
  virtual ~ForceField() = default;

  // Fills `samples` from `points` (both with room for all points). No allocation, lock or system
  // call. A point in value 1 that the field cannot measure gets about half a voxel along
  // its normal.
  virtual void evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept = 0;

  // The same for every collected point, those of value 3 too, with signed depth: negative is how
  // far a point is from having depth, as far as the field can tell.
  virtual void measure(const CollectedPoints& points, FieldSamples& samples) const noexcept = 0;

  // Whether the directions of measure() are the scene's, so that there is nothing to gain from
  // averaging them over neighbours (surface_directions.h).
  virtual bool has_exact_slopes() const noexcept { return false; }
};

// The field that a model uses where the user names none: the paper's for `paper`; else the distance
// or the level field, whichever the map can give.
ForceKind usual_force(Model model, const Voxmap& voxmap);

// The field of `kind` over `voxmap`, which must outlive it. Errors: kUsage where the model or the
// map and the field do not go together.
Result<std::unique_ptr<ForceField>> make_force_field(Model model, ForceKind kind,
                                                     const Voxmap& voxmap);

// Mean area that a shell point stands for, m^2. A point's weight over this is its share of force
// in a sum over contacts: 1 on average, whatever the number of points.
double mean_point_area_m2(const Pshell& shell);

}  // namespace forcelayer
