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
  double length_m = 0;                      // of the path of the point, straight between rows
  double turn_rad = 0;                      // summed up
  double max_step_m = 0, max_turn_rad = 0;  // between two rows
  double max_mps = 0;
  std::array<double, 3> low_m{}, high_m{};  // the box of the point at the rows
};

// The facts of the point `center_m` of the part (part frame). `rows`: at least one, as read_path()
// gives them.
PathFacts path_facts(std::span<const PathRow> rows, const std::array<double, 3>& center_m = {});

// Between two rows the centroid moves straight. A CAD program may move the frame's origin straight,
// or turn the part about it. Then the whole part is elsewhere between the rows, by at most
// `aside_m`: the height of the arc about the origin over its chord.
struct WideStep {
  std::size_t row = 0;                            // its first row; it ends at the next one
  double turn_rad = 0, shift_m = 0, aside_m = 0;  // the shift is that of the centroid
};

// The step with the largest `aside_m`; all zero if there is no step.
WideStep widest_step(std::span<const PathRow> rows, const std::array<double, 3>& center_m);

// The pose at a time. Between two rows the point `center_m` of the part (part frame) goes straight
// and the orientation turns the short way round, both evenly; voxcheck and voxrun do the same with
// the centroid. Before the first row the pose is the first one, after the last row the last one.
PathRow pose_at(std::span<const PathRow> rows, double time_s,
                const std::array<double, 3>& center_m);

// All rows, so that no corner is lost, and between them one every `period_s` from the first time
// on; fewer where times are so late that doubles are farther apart. All of them are in memory.
std::vector<PathRow> resampled(std::span<const PathRow> rows, double period_s,
                               const std::array<double, 3>& center_m);

// A path whose poses lie on turns about the point `pivot_m` of the part (part frame): between two
// rows that point goes straight, and the part turns about it. Rows are added until the same path
// comes from the point `center_m` going straight: no point of the part is off by more than
// `within_m`. A point at the distance r from the axis leaves its chord by at most r turn^2 / 8 in a
// turn. Errors: kUsage where that takes too many rows, or times are so late that doubles are
// farther apart than the rows.
Result<std::vector<PathRow>> turned_about(std::span<const PathRow> rows,
                                          const std::array<double, 3>& pivot_m,
                                          const std::array<double, 3>& center_m, double within_m);

// Fewer rows of the same motion: all others are left out from which no point of the part, at most
// `radius_m` away from its point `center_m`, is off by more than `within_m`.
std::vector<PathRow> thinned(std::span<const PathRow> rows, const std::array<double, 3>& center_m,
                             double radius_m, double within_m);

// The same poses from the last to the first, over the same times.
std::vector<PathRow> reversed(std::span<const PathRow> rows);

}  // namespace forcelayer
