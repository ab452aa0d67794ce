// The interface between the voxels and the force: how deep each collected point lies in the force
// layer and which way it is pushed.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/contact_query.h"
#include "runtime/parameters.h"

namespace forcelayer {

// The collected points with depth > 0, in the order of CollectedPoints. The force of one is
// stiffness * depth * direction, on the part at the point.
struct FieldSamples {
  std::uint32_t count = 0;
  std::vector<std::uint32_t> at;  // index into CollectedPoints
  std::vector<float> depth_m;     // > 0
  std::vector<float> dx, dy, dz;  // unit, world axes: out of the static scene

  void reserve(std::uint64_t points);  // set-up only
};

// Reads depth and direction at points in values 2 and 1. What lies in which value, and so the
// guard and the guarantee, does not depend on the field.
class ForceField {
 public:
  virtual ~ForceField() = default;

  // Fills `samples` from `points` (both with room for all points). No allocation, lock or system
  // call. A point in value 1 that the field cannot measure is given the field's greatest depth.
  virtual void evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept = 0;
};

// The field of `kind` over `voxmap`, which must outlive it.
std::unique_ptr<ForceField> make_force_field(ForceKind kind, const Voxmap& voxmap);

}  // namespace forcelayer
