// A nut on the thread of a bolt, by the meshes: turned with the thread's advance it is proven not
// to meet the bolt; turned the other way, or pulled, it meets it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "workbench/exact/exact_walk.h"
#include "workbench/exact/seat_walk.h"

namespace forcelayer::exact {
namespace {

// An M20 thread, in mm: crests are P/8 wide, roots P/4. Few faces around its axis: a nut's corner
// stands up to 0.09 mm off the middle of the bolt's face.
constexpr int kFaces = 24;
constexpr double kRadius = 10, kPitch = 2.5, kHeight = 1.353, kPlay = 0.3;
constexpr double kEighth = 2 * std::numbers::pi / 8;
constexpr std::array<double, 4> kCorners{-kPitch / 16, kPitch / 16, kPitch * 3 / 8, kPitch * 5 / 8};

double thread_radius(double z) {
  const double flank = (std::abs(std::remainder(z, kPitch)) - kPitch / 16) / (kPitch * 5 / 16);
  return kRadius - kHeight * std::clamp(flank, 0.0, 1.0);
}

// A column of corners for each face around z, which begins and ends on the rim. Its rows follow the
// helix and are cut at the ends; after a turn a row goes on as the fourth one after it, a pitch up.
Surface threaded(double half, double play, double rim) {
  const int pitches = static_cast<int>(std::ceil(half / kPitch)) + 2, rows = 8 * pitches + 4;
  Surface surface;
  for (int column = 0; column < kFaces; ++column) {
    const double turn = static_cast<double>(column) / kFaces, angle = 2 * std::numbers::pi * turn;
    const auto add = [&](double radius, double z) {
      surface.vertices_m.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    };
    add(rim, -half);
    for (int row = 0; row < rows; ++row) {
      const double along = kPitch * (row / 4 - pitches + turn) + kCorners[row % 4];
      const double z = std::clamp(along, -half, half);
      add(thread_radius(z - kPitch * turn) + play, z);
    }
    add(rim, half);
  }
  const auto at = [&](int column, int row) {
    const bool is_end = row < 0 || row >= rows;
    const int up = column == kFaces && !is_end ? std::min(row + 4, rows - 1) : row;
    return static_cast<std::uint32_t>((column % kFaces) * (rows + 2) + 1 + up);
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto& v = surface.vertices_m;
    if (v[a] == v[b] || v[b] == v[c] || v[c] == v[a]) return;
    if (rim > 0) std::swap(b, c);  // its thread faces inwards
    surface.triangles.push_back({a, b, c});
  };
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    add(a, b, c);
    add(a, c, d);
  };
  for (int n = 0; n < kFaces; ++n) {
    for (int row = -1; row < rows; ++row) {
      quad(at(n, row), at(n + 1, row), at(n + 1, row + 1), at(n, row + 1));
    }
    if (rim > 0) quad(at(n, rows), at(n + 1, rows), at(n + 1, -1), at(n, -1));
  }
  surface.object.assign(surface.triangles.size(), 1);
  surface.largest_m = 40;
  return surface;
}

struct Answer {
  bool is_too_near = false, is_too_deep = false;
  std::uint64_t distances = 0, depths = 0;  // measured
};

// The nut goes so far along its axis, and turns.
Answer moved(double advance, double turn) {
  const Surface bolt = threaded(8, 0, 0), nut = threaded(4, kPlay, 15);
  const Bodies of_bolt = bodies_of(bolt, 1e-3), of_nut = bodies_of(nut, 1e-3);
  EXPECT_TRUE(are_solid(of_bolt) && are_solid(of_nut));
  const MeshPair pair(bolt, nut);
  const std::vector<PathRow> rows{
      {0, {0, 0, 0}, {1, 0, 0, 0}},
      {1, {0, 0, advance}, {std::cos(turn / 2), 0, 0, std::sin(turn / 2)}}};
  const clearance::CenterPath path(rows, glm::dvec3(0), 16);
  const Moment begin{0, 0}, end{1, 0};
  Answer answer;
  ExactWalk walk(path, pair, pair, 1e-9);
  answer.is_too_near = !walk.nearer_than({begin, end}, 0.01, 0.01).empty();
  answer.distances = walk.measured();
  SeatWalk seat(path, of_nut, of_bolt, pair, 1e-4);
  answer.is_too_deep = !seat.deeper_than(begin, end, 1e-3, 0.01).empty();
  answer.depths = seat.measured();
  return answer;
}

// The surfaces stay 0.1 mm apart while the nut's corners travel by 12 mm. Motions are proven by the
// triangles, so that 9 distances and 7 depths are measured: 65 and 2081 without these proofs.
TEST(Thread, IsFollowedByATurnWithItsAdvance) {
  const Answer answer = moved(kPitch / 8, kEighth);
  EXPECT_FALSE(answer.is_too_near);
  EXPECT_FALSE(answer.is_too_deep);
  EXPECT_LE(answer.distances, 18u);
  EXPECT_LE(answer.depths, 14u);
}

// Where the surfaces begin to meet is found to a hundredth of a millimeter; from there on no moment
// proves more. The turn takes 117 distances and 47 depths, the pull 9 and 22.
TEST(Thread, IsMetByATurnTheOtherWayAndByAPull) {
  for (const double turn : {kEighth, 0.0}) {
    SCOPED_TRACE(turn);
    const Answer answer = moved(turn == 0 ? kPitch / 4 : -kPitch / 8, turn);
    EXPECT_TRUE(answer.is_too_near);
    EXPECT_TRUE(answer.is_too_deep);
    EXPECT_LE(answer.distances, 240u);
    EXPECT_LE(answer.depths, 100u);
  }
}

}  // namespace
}  // namespace forcelayer::exact
