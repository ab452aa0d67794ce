// Triangles that close the open edges of others, against the sum of all solid angles.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pointshell/certificate/winding_number.h"
#include "pointshell/part/open_edges.h"
#include "pointshell/part/part.h"

namespace forcelayer::part {
namespace {

double winding_of(const Part& part, const Vec3& place) {
  double sum = 0;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    const Piece piece = triangle_piece(part, t);
    sum += certificate::triangle_winding(place, piece[0], piece[1], piece[2]);
  }
  return sum;
}

double off_whole(double winding) { return std::abs(winding - std::round(winding)); }

// A ball of bands. Some of its triangles are missing, some turned, some there twice, and some have
// corners of their own a little beside those of their neighbors.
Part torn_ball(std::mt19937& random) {
  constexpr std::uint32_t kBands = 9, kSides = 14;
  Part part;
  for (std::uint32_t band = 0; band <= kBands; ++band) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const double polar = M_PI * band / kBands, turn = 2 * M_PI * side / kSides;
      part.vertices.push_back(
          {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)});
    }
  }
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const double fate = unit(random);
    if (fate < -0.9) return;
    mesh::Triangle t{a, b, c};
    if (fate > 0.9) std::swap(t[1], t[2]);
    if (fate > 0.8 && fate < 0.9) part.triangles.push_back(t);
    if (fate > 0.6 && fate < 0.8) {
      const std::size_t corner = random() % 3;
      const Vec3 beside{0.01 * unit(random), 0.01 * unit(random), 0.01 * unit(random)};
      part.vertices.push_back(part.vertices[t[corner]] + beside);
      t[corner] = static_cast<std::uint32_t>(part.vertices.size() - 1);
    }
    part.triangles.push_back(t);
  };
  for (std::uint32_t band = 0; band < kBands; ++band) {
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t a = band * kSides + side, b = band * kSides + (side + 1) % kSides;
      add(a, a + kSides, b);
      add(b, a + kSides, b + kSides);
    }
  }
  return part;
}

TEST(OpenEdges, CapsMakeTheWindingNumberWhole) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1.3, 1.3);
  int graded = 0;
  for (int repeat = 0; repeat < 30; ++repeat) {
    const Part ball = torn_ball(random);
    const auto open = open_edges_of(ball.triangles);
    ASSERT_FALSE(open.empty());
    const Part caps = caps_of(ball, open);
    const TriangleTree ball_tree(ball), caps_tree(caps);
    const certificate::WindingNumber of_ball(ball_tree), of_caps(caps_tree);
    for (int n = 0; n < 100; ++n) {
      const Vec3 place{unit(random), unit(random), unit(random)};
      const double winding = winding_of(ball, place);
      EXPECT_LT(off_whole(winding + winding_of(caps, place)), 1e-9) << repeat << ' ' << n;
      graded += off_whole(winding) > 0.1;
      // Each tree errs by 0.01 at most.
      EXPECT_NEAR(off_whole(of_ball.at(place)), off_whole(of_caps.at(place)), 0.02);
    }
  }
  EXPECT_GT(graded, 100);  // where the ball alone does not tell its inside
}

TEST(OpenEdges, AClosedBodyHasNone) {
  const std::vector<mesh::Triangle> pyramid = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_TRUE(open_edges_of(pyramid).empty());
  std::vector<mesh::Triangle> turned = pyramid;
  std::swap(turned[0][0], turned[0][1]);
  const std::map<Edge, int> open = open_edges_of(turned);
  EXPECT_EQ(open.size(), 3U);  // all the edges of the turned one, twice each
  for (const auto& [edge, balance] : open) EXPECT_EQ(std::abs(balance), 2);
}

}  // namespace
}  // namespace forcelayer::part
