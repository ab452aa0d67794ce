// The distance of a part's surface that the distance of its shell points proves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "formats/surface_distance.h"

namespace forcelayer {
namespace {

struct Pair {
  double radius, gap;  // the root of a second moment, and a gap
};

double proven_by(const Pair& pair, double m) {
  return m >= pair.radius ? std::sqrt(m * m - pair.radius * pair.radius) - pair.gap : -1e300;
}

// A surface whose places have combinations of known pairs, the nearest point (0, rho) among them.
struct Surface {
  std::vector<std::vector<Pair>> places;
  double covering_radius = 0;

  // The distance that points at `m` prove of the whole surface, place by place.
  double distance(double m) const {
    double smallest = 1e300;
    for (const auto& pairs : places) {
      double best = 0;
      for (const Pair& pair : pairs) best = std::max(best, proven_by(pair, m));
      smallest = std::min(smallest, best);
    }
    return smallest;
  }
};

Surface random_surface(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Surface surface;
  for (int place = 0; place < 8; ++place) {
    std::vector<Pair> pairs{{0, unit(random)}};
    surface.covering_radius = std::max(surface.covering_radius, pairs[0].gap);
    for (int n = 0; n < 3; ++n) pairs.push_back({1.2 * unit(random), 0.5 * unit(random)});
    surface.places.push_back(pairs);
  }
  return surface;
}

// The claims of a shell of this surface: one pair for all places, and the loss at some distances.
struct Claim {
  SurfaceDistanceTerms terms;
  std::vector<DistanceLoss> losses;
};

Claim claim_of(const Surface& surface, std::mt19937_64& random) {
  Claim claim;
  claim.terms.covering_radius_m = surface.covering_radius;
  for (const auto& pairs : surface.places) {
    claim.terms.convex_radius_m = std::max(claim.terms.convex_radius_m, pairs.back().radius);
    claim.terms.convex_gap_m = std::max(claim.terms.convex_gap_m, pairs.back().gap);
  }
  std::uniform_real_distribution<double> step(0.05, 0.6);
  for (double m = surface.covering_radius; m < 3; m += step(random)) {
    claim.losses.push_back({m, m - surface.distance(m)});
  }
  claim.terms.losses = claim.losses;
  return claim;
}

TEST(SurfaceDistance, IsNeverAboveThatOfAnyPlace) {
  int used = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const Surface surface = random_surface(random);
    const Claim claim = claim_of(surface, random);
    for (double m = 0; m < 5; m += 0.01) {
      const double bound = surface_distance_bound_m(claim.terms, m);
      ASSERT_LE(bound, surface.distance(m)) << m;
      used += bound > m - surface.covering_radius + 1e-6;
    }
  }
  EXPECT_GT(used, 50000);  // the other terms prove more than the covering radius
}

// With the losses at the very distance, the table proves all that the places prove.
TEST(SurfaceDistance, IsExactAtTheDistancesOfTheTable) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::mt19937_64 random(seed);
    const Surface surface = random_surface(random);
    const Claim claim = claim_of(surface, random);
    for (const DistanceLoss& entry : claim.losses) {
      EXPECT_NEAR(surface_distance_bound_m(claim.terms, entry.distance_m),
                  surface.distance(entry.distance_m), 1e-6)
          << "seed " << seed;
    }
  }
}

TEST(SurfaceDistance, KnownAnswers) {
  const DistanceLoss losses[] = {{2, 1}, {4, 0.5}};
  const SurfaceDistanceTerms terms{1, 0.6, 0.45, losses};
  EXPECT_NEAR(surface_distance_bound_m(terms, 1), std::sqrt(1 - 0.36) - 0.45, 1e-9);  // the pair
  EXPECT_NEAR(surface_distance_bound_m({1, 9, 9, {}}, 2.5), 1.5, 1e-9);
  // Below 4, the entry there proves more than the loss of 2 and the covering radius.
  EXPECT_NEAR(surface_distance_bound_m({1, 9, 9, losses}, 2.5), std::sqrt(3.5 * 3.5 - 9.75), 1e-9);
  EXPECT_NEAR(surface_distance_bound_m({1, 9, 9, losses}, 4), 3.5, 1e-9);
  EXPECT_NEAR(surface_distance_bound_m({1, 9, 9, losses}, 5), 4.5, 1e-9);  // the last loss
  // Between the entries that of 4 proves sqrt(3.5^2 - (4^2 - m^2)).
  EXPECT_NEAR(surface_distance_bound_m({1, 9, 9, losses}, 3.9),
              std::sqrt(3.5 * 3.5 - (16 - 3.9 * 3.9)), 1e-9);
  EXPECT_EQ(surface_distance_bound_m({1, 0, 1, {}}, 0.99), 0);
  EXPECT_EQ(surface_distance_bound_m({1, 0, 1, {}}, 0), 0);
  EXPECT_EQ(surface_distance_bound_m(terms, -1), 0);
}

TEST(SurfaceDistance, GrowsAndHasAnInverse) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const Surface surface = random_surface(random);
    const Claim claim = claim_of(surface, random);
    double before = 0;
    for (double m = 0; m < 5; m += 0.01) {
      const double bound = surface_distance_bound_m(claim.terms, m);
      ASSERT_GE(bound, before) << m;
      before = bound;
    }
    for (double wanted = 0; wanted < 4; wanted += 0.013) {
      const double needed = min_point_distance_for_m(claim.terms, wanted);
      ASSERT_GE(surface_distance_bound_m(claim.terms, needed), wanted);
      if (wanted > 0) {
        ASSERT_LT(surface_distance_bound_m(claim.terms, needed * (1 - 1e-6)), wanted);
      }
    }
  }
}

}  // namespace
}  // namespace forcelayer
