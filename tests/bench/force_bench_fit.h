// The fit of a force model's wrenches to the true ones: shared by the contacts with a closed
// formula and by those between meshes.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "forcelayer/pose.h"

namespace forcelayer::bench {

struct Quality {
  double stiffness;      // over nominal, offset fitted too
  double bias;           // RMS error of the mean force over depths, over the true RMS force
  double noise;          // RMS of the force about its mean at a depth, over the same
  double direction_deg;  // median
  double torque;         // median of |T/F - true T/F| over the part's radius
  double step;           // largest change in one frame of a 50 mm/s slide, over the mean force
  double force_error;    // RMS error of the force vector over the true RMS, offset and gain fitted
  double deviation;      // of that, what the mean over shifts has; the rest is noise
  double torque_error;   // as force_error, of the torque; NAN where the truth has next to none
  double raw_error;      // as force_error, with neither offset nor gain fitted
  double raw_torque_error;
  // As force_error, with offset and gain of all poses: over the poses that press, over those that
  // barely touch (Nominal), each over the true RMS force of the same poses.
  double pressing_error, touching_error;
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
  std::vector<double> area;        // of the samples within the offset surface
  std::vector<double> area_depth;  // sum of their areas times depths

  TruthTable(const std::vector<SurfaceSample>& samples, double first_m, double last_m);
  Wrench wrench_at(double offset_m) const;  // linear between entries, the last ones beyond them
  double area_at(double offset_m) const;
  // The area within, each sample counted by its depth up to `full_m`, in full from there on.
  double sharing_area_at(double offset_m, double full_m) const;

 private:
  double entry_of(double offset_m) const;
  double between(const std::vector<double>& of, double offset_m) const;
};

// By how much many points share a load, in the truth as in the force that is judged by it: not at
// all; by N/10, N the points that the contact's area stands for (paper 5.2); or as the default
// model shares it, by area and by depth up to an eighth of a voxel.
enum class Shared { kNot, kByTen, kAsDefault };

// The true wrench, its load shared. Areas are over the mean of a point.
Wrench shared_truth(const TruthTable& table, double offset_m, Shared shared, double voxel_size_m);

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

// Fits one offset of `offsets_m` and judges; `step` is left NAN.
Quality judged(const Measured& measured, const TruthAt& truth_at, const Nominal& nominal,
               const std::vector<double>& offsets_m, double part_radius_m);

}  // namespace forcelayer::bench
