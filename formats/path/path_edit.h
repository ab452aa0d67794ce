// Facts about a path, and other paths made from it.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "formats/path/path_file.h"

namespace forcelayer {

struct PathFacts {
  std::size_t poses = 0;
  double begin_s = 0, end_s = 0;
  double way_m = 0;                           // of the frame's origin
  double turn_rad = 0;                        // summed up
  double most_step_m = 0, most_turn_rad = 0;  // between two rows
  double most_mps = 0;
  std::array<double, 3> low_m{}, high_m{};  // the box of the origin
};

// `rows`: at least one, as read_path() gives them.
PathFacts path_facts(std::span<const PathRow> rows);

// The pose at a time between two rows: the place `center_m` of the part (in its own frame) goes
// straight, and the orientation turns the short way round, both evenly; so do voxcheck and voxrun
// with the centroid. The first and the last pose stand for what is before and behind.
PathRow pose_at(std::span<const PathRow> rows, double time_s,
                const std::array<double, 3>& center_m);

// A row every `period_s`, from the first to the last time, which is the last row.
std::vector<PathRow> resampled(std::span<const PathRow> rows, double period_s,
                               const std::array<double, 3>& center_m);

// The same poses from the last to the first, over the same times.
std::vector<PathRow> reversed(std::span<const PathRow> rows);

}  // namespace forcelayer
