// The fit of a force model's wrenches to the true ones: shared by the contacts with a closed
// formula and by those between meshes.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "forcelayer/pose.h"

namespace forcelayer::bench {

// All errors are RMS over poses, over the RMS of the truth at the same poses.
struct Quality {
  double force_error;     // of the force vector, after one offset and one gain are fitted
  double torque_error;    // the same of the torque; NAN where the truth has next to none
  double raw_error;       // of the force with neither offset nor gain fitted
  double touching_error;  // as force_error, over the poses that barely touch (Nominal)
};

// A piece of the part's exact surface at some pose.
struct SurfaceSample {
  double distance_m;     // from the static body's exact surface
  double area;           // in any unit
  glm::dvec3 direction;  // gradient of the distance
  glm::dvec3 arm_m;      // from the part's center
};

// The true wrench at one pose (K = 1), tabulated over the distance of the exact offset surface from
// the body's: the first, and so much between two.
struct TruthTable {
  double first_m = 0, step_m = 0;
  std::vector<Wrench> wrench;
  std::vector<double> area;  // of the samples within the offset surface

  TruthTable(const std::vector<SurfaceSample>& samples, double first_m, double last_m);
  Wrench wrench_at(double offset_m) const;  // linear between entries, the last ones beyond them
  double area_at(double offset_m) const;

 private:
  double entry_of(double offset_m) const;
};

// The load that a force is judged by: the integral over the area; or that times ten over N, N the
// points that the contact's area stands for, where N is above ten (paper 5.2).
enum class LoadOfTruth { kWhole, kByTen };

// The true wrench at an offset. Areas are over the mean of a point.
Wrench true_wrench_at(const TruthTable& table, double offset_m, LoadOfTruth load);

// All wrenches are about the part's center, in axes in which the truth does not change with shifts.
using Measured = std::vector<std::vector<Wrench>>;  // [depth][shift]
using TruthAt = std::function<Wrench(std::size_t depth, double offset_m)>;

// Where a method says that its force begins, and how deep the poses are below that surface by the
// exact distance: from `pressing_m` on a pose presses, less deep it barely touches.
struct Nominal {
  double offset_m;
  std::vector<double> depths_m;
  double pressing_m;
};

// Fits one offset of `offsets_m`, and judges.
Quality judged(const Measured& measured, const TruthAt& truth_at, const Nominal& nominal,
               const std::vector<double>& offsets_m, double part_radius_m);

}  // namespace forcelayer::bench
