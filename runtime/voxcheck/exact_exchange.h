// The question of voxcheck to voxcheck-exact, and the answer: JSON between two programs of one
// build. Lengths in meters, world frame unless said otherwise.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::voxcheck {

// A stretch of a path, and the clearance that the baked files prove for all of it.
struct ProvenStretch {
  double from_s = 0, to_s = 0, proven_m = 0;
  bool too_near = false;  // less than required is proven
  bool seated = false;    // the seat's objects do not count
};

struct ExactRequest {
  std::string scene, part, path;  // baked files and path, as given
  std::vector<std::string> meshes, part_meshes, without;
  std::optional<double> unit_m, part_unit_m;  // meters per file unit
  bool allow_outside = false;
  double required_m = 0;
  double least_s = 0;            // when the least clearance is proven,
  std::optional<double> most_m;  // and what the exact one is no more than then, where known
  std::vector<std::uint32_t> allowed, seat;  // objects of the scene, by number
  std::vector<ProvenStretch> stretches;      // in the order of time, without gaps
};

inline constexpr double kNothingM = 1e100;  // farther away than any mesh

// The surfaces at one moment, as the meshes have them.
struct ExactMoment {
  double time_s = 0, exact_m = 0;             // kNothingM where no object counts
  std::uint32_t object = 0;                   // the nearest; 0: the file names none
  std::array<double, 3> part_m{}, scene_m{};  // the nearest points of the two surfaces
};

// A stretch in which the meshes do not keep the required clearance.
struct ExactViolation {
  double from_s = 0, to_s = 0;
  double clearance_m = 0;  // that holds for all of it, deviations and rounding taken off
  ExactMoment worst;
  bool graze = false;  // so near to what is required that deviations and rounding decide
};

struct ExactAnswer {
  double clearance_m = 0;  // that holds along the whole path, deviations and rounding taken off
  double margin_m = 0;     // deviations of scene and part, and rounding
  ExactMoment least;
  std::vector<ExactViolation> violations;
  std::uint64_t moments = 0;  // at which a distance was measured
  std::vector<std::string> warnings;
};

std::string text_of(const ExactRequest& request);
std::string text_of(const Result<ExactAnswer>& answer);

// Errors: kInternal for a text that the other side did not write.
Result<ExactRequest> exact_request(const std::string& text);
Result<ExactAnswer> exact_answer(const std::string& text);

}  // namespace forcelayer::voxcheck
