// The interface between voxels and force: the depth of each collected point and the direction in
// which it is pushed.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "forcelayer/parameters.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/query/contact_query.h"

namespace forcelayer::field {

// A slope of a field, per voxel, that is shorter than this has no direction that can be trusted.
inline constexpr float kMinSlope = 0.1f;
// A slope that is shorter than this, at a surface, is of a place near the middle of a sheet.
inline constexpr float kSideSlope = 0.5f;

// One sample for each of the CollectedPoints, in their order. The force on the part at a point of
// positive depth is stiffness * depth * direction.
struct FieldSamples {
  std::vector<float> depth_m;     // signed: negative is how far the point is from having depth
  std::vector<float> dx, dy, dz;  // direction: unit, world axes, out of the static scene
  std::vector<float> gx, gy, gz;  // slope of the field, per voxel, world axes
  // Only where ForceField::proves_distances(). No point of the static mesh is nearer than
  // distance_m. from_zero_force_m is the stored distance, interpolated, less that of the zero-force
  // surface: a measure, and no bound.
  std::vector<float> distance_m, from_zero_force_m;
  // Its gradient, voxels a voxel, world axes: that of a potential, and it jumps between cells, as
  // the slope does not.
  std::vector<float> ex, ey, ez;

  void reserve(std::uint64_t points);  // set-up only
};

// Measures collected points. Points in values 1 and 2 may have depth, and around Euclidean layers
// some points in value 3. The field does not decide which point
// lies in which value, so the guard and the guarantee do not depend on it.
class ForceField {
 public:
  virtual ~ForceField() = default;

  // Fills `samples` from `points`; both have room for every shell point. No allocation, lock or
  // system call. A point in value 1 that the field cannot measure gets about half a voxel along its
  // normal.
  virtual void measure(const query::CollectedPoints& points,
                       FieldSamples& samples) const noexcept = 0;

  // Whether measure() fills FieldSamples::distance_m.
  virtual bool proves_distances() const noexcept { return false; }

  // Whether the directions of measure() are exact enough to need no averaging over neighbors
  // (average_directions.h).
  virtual bool has_exact_slopes() const noexcept { return false; }
};

// The field of a model where the user names none: the tangent plane for `paper`; else the distance
// field or the level field, whichever can read the map.
ForceKind usual_force(Model model, const Voxmap& voxmap);

// The field of `kind` over `voxmap`, which must outlive it. Errors: kUsage where the model or the
// map and the field do not go together.
Result<std::unique_ptr<ForceField>> make_force_field(Model model, ForceKind kind,
                                                     const Voxmap& voxmap);

// Mean area that a shell point stands for, m^2. A point's weight over this is its fraction of force
// in a sum over contacts: 1 on average, whatever the number of points.
double mean_point_area_m2(const Pshell& shell);

}  // namespace forcelayer::field
