// Slices of long thin triangles, and flat patches that stand for many pieces of surface.
#include "pointshell/part/pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "pointshell/certificate/flat_patches.h"
#include "pointshell/part/triangle_tree.h"
#include "tests/support/part_support.h"

namespace forcelayer {
namespace {

using namespace testing;

double area_of(const part::Piece& p) {
  return part::length(part::cross(p[1] - p[0], p[2] - p[0])) / 2;
}

TEST(Needle, SlicesAreTheTriangleAndSmall) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto place = [&](double scale) {
    return scale * part::Vec3{unit(random), unit(random), unit(random)};
  };
  int needles = 0;
  for (int n = 0; n < 2000; ++n) {
    const part::Vec3 a = place(1), b = place(100);
    const part::Piece piece{a, b, a + (0.5 + 0.5 * unit(random)) * (b - a) + place(0.2)};
    const double edge = 0.5 + 0.4 * unit(random);
    const auto needle = part::Needle::of(piece, edge);
    if (!needle) continue;
    ++needles;
    double area = 0;
    for (std::size_t slice = 0; slice < needle->slices(); ++slice) {
      needle->visit_slice(slice, [&](const part::Piece& part) {
        area += area_of(part);
        EXPECT_LE(std::sqrt(part::longest_edge(part).length_squared), edge);
      });
    }
    EXPECT_NEAR(area, area_of(piece), 1e-9 * area_of(piece) + 1e-12) << n;
    // As many as the length needs.
    EXPECT_LE(static_cast<double>(needle->slices()),
              std::sqrt(part::longest_edge(piece).length_squared) / edge * 1.3 + 2);
  }
  EXPECT_GT(needles, 500);
}

TEST(Needle, SlicesNearABoxAreAllThatReachIt) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int n = 0; n < 300; ++n) {
    const part::Vec3 b{50 * unit(random), 50 * unit(random), 50 * unit(random)};
    const auto needle = part::Needle::of({part::Vec3{}, b, 0.4 * b + part::Vec3{0.01, 0, 0}}, 0.5);
    if (!needle) continue;
    part::Box box;
    const part::Vec3 corner = std::abs(unit(random)) * b + part::Vec3{unit(random), 0, 0};
    box.grow(corner), box.grow(corner + part::Vec3{2, 2, 2});
    const auto [first, last] = needle->slices_near(box);
    for (std::size_t slice = 0; slice < needle->slices(); ++slice) {
      if (first <= slice && slice < last) continue;
      needle->visit_slice(slice, [&](const part::Piece& piece) {
        part::Box own;
        for (const part::Vec3& v : piece) own.grow(v);
        const bool apart = own.low.x > box.high.x || own.high.x < box.low.x ||
                           own.low.y > box.high.y || own.high.y < box.low.y ||
                           own.low.z > box.high.z || own.high.z < box.low.z;
        EXPECT_TRUE(apart) << n << " slice " << slice;
      });
    }
  }
}

// Corners in a line, exactly and but for rounding: the slices are the whole line.
TEST(Needle, SlicesOfALineLeaveNoGap) {
  constexpr std::uint64_t kSeed = 9;
  std::mt19937_64 random(kSeed);
  std::uniform_int_distribution<int> whole(-64, 64), way(1, 999);
  for (int n = 0; n < 500; ++n) {
    const double x = whole(random), y = whole(random), z = whole(random);
    const part::Vec3 along{x, y, n % 3 == 0 ? 0 : z}, from{y, z, x};
    if (part::length(along) < 20) continue;
    const double scale = n % 2 == 0 ? 1 : 1.0 / 3;  // thirds are rounded
    const double fraction = way(random) / 1000.0;
    const part::Vec3 middle = n % 2 == 0 ? 0.5 * along : fraction * along;
    const auto placed = [&](const part::Vec3& p) { return scale * (from + p); };
    const part::Piece line{placed({}), placed(along), placed(middle)};
    const auto needle = part::Needle::of(line, 0.9);
    ASSERT_TRUE(needle) << n;
    std::vector<part::Piece> pieces;
    for (std::size_t slice = 0; slice < needle->slices(); ++slice) {
      needle->visit_slice(slice, [&](const part::Piece& piece) { pieces.push_back(piece); });
    }
    EXPECT_LE(pieces.size(), 2 * needle->slices() + 1);
    for (int step = 0; step <= 300; ++step) {
      const part::Vec3 place = line[0] + (step / 300.0) * (line[1] - line[0]);
      double nearest = 1e9;
      for (const auto& [a, b, c] : pieces) {
        const part::Vec3 foot = part::nearest_on_triangle(place, a, b, c);
        nearest = std::min(nearest, part::length(foot - place));
      }
      ASSERT_LT(nearest, 1e-9) << "seed " << kSeed << ", line " << n << ", step " << step;
    }
  }
}

// Pieces near a random plane: all places of theirs are within the gap of a patch or inside a box,
// or are handed over one by one.
TEST(FlatPatches, StandForAllPieces) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    const part::Vec3 n = part::normalized({unit(random), unit(random), unit(random)}),
                     u = part::any_perpendicular(n), v = part::cross(n, u);
    certificate::SurfacePieces pieces;
    std::vector<part::Vec3> places;
    for (int k = 0; k < 400; ++k) {
      const double x = 2 * unit(random), y = unit(random);
      part::Piece piece;
      for (part::Vec3& corner : piece) {
        corner = (x + 0.3 * unit(random)) * u + (y + 0.1 * unit(random)) * v +
                 (0.02 * unit(random) + 0.1 * x * x) * n;
      }
      pieces.add(piece);
      places.push_back(part::centroid(piece));
    }
    std::vector<certificate::FlatPatch> patches;
    std::vector<std::array<part::Vec3, 8>> boxes;
    std::vector<part::Piece> rest;
    certificate::bound_by_patches(
        pieces, 1,
        [&](const certificate::FlatPatch& patch) {
          if (random() % 4 == 0) return false;  // as where a patch does not prove enough
          patches.push_back(patch);
          return true;
        },
        [&](const certificate::OrientedBox& box, const certificate::SurfacePieces&) {
          EXPECT_LE(box.radius(), 0.75);
          if (random() % 8 != 0) return false;
          boxes.push_back(box.corners());
          return true;
        },
        [&](std::span<const part::Vec3> polygon) {
          for (std::size_t c = 2; c < polygon.size(); ++c)
            rest.push_back({polygon[0], polygon[c - 1], polygon[c]});
        });
    EXPECT_FALSE(patches.empty());
    EXPECT_FALSE(boxes.empty());
    for (const part::Vec3& place : places) {
      const auto within = [&](const part::Vec3& a, const part::Vec3& b, const part::Vec3& c,
                              double gap) {
        return part::length(part::nearest_on_triangle(place, a, b, c) - place) <= gap + 1e-12;
      };
      const bool on_patch = std::any_of(patches.begin(), patches.end(), [&](const auto& patch) {
        const auto& [a, b, c, d] = patch.corners;
        return within(a, b, c, patch.gap) || within(a, c, d, patch.gap);
      });
      const bool by_itself = std::any_of(rest.begin(), rest.end(), [&](const part::Piece& p) {
        return within(p[0], p[1], p[2], 1e-9);  // the nearest point of a sliver is not exact
      });
      const bool in_box = std::any_of(boxes.begin(), boxes.end(), [&](const auto& corners) {
        for (const std::size_t beside_first : {1, 2, 4}) {
          const part::Vec3 edge = corners[beside_first] - corners[0];
          const double along = part::dot(place - corners[0], edge);
          if (along < -1e-12 || along > part::length_squared(edge) + 1e-12) return false;
        }
        return true;
      });
      EXPECT_TRUE(on_patch || by_itself || in_box) << "seed " << seed;
    }
  }
}

// Against a map of all cubes; some of them hold few tiles, some many, some just as many.
TEST(FlatPatches, TilesAreGroupedByCube) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> unit(0, 1);
  const double edge = 0.5;
  std::vector<part::Piece> tiles;
  for (const int count : {1, 255, 256, 257, 300, 2000}) {
    for (int cube = 0; cube < 10; ++cube) {
      const part::Vec3 low = edge * part::Vec3{std::floor(100 * unit(random)) - 50,
                                               static_cast<double>(count), std::floor(9.0 - cube)};
      for (int n = 0; n < count; ++n) {
        const part::Vec3 p =
            low + (0.9 * edge) *
                      part::Vec3{unit(random) + 0.05, unit(random) + 0.05, unit(random) + 0.05};
        tiles.push_back({p, p, p});
      }
    }
  }
  std::shuffle(tiles.begin(), tiles.end(), random);
  std::map<part::Cube, std::vector<std::uint32_t>> by_cube;
  for (std::uint32_t n = 0; n < tiles.size(); ++n) {
    by_cube[part::cube_at(part::centroid(tiles[n]), edge)].push_back(n);
  }
  std::vector<std::uint32_t> sparse;
  std::vector<part::Vec3> dense;
  for (const auto& [cube, of_cube] : by_cube) {
    if (of_cube.size() <= 256) sparse.insert(sparse.end(), of_cube.begin(), of_cube.end());
    for (const std::uint32_t n : of_cube) {
      if (of_cube.size() > 256) dense.insert(dense.end(), tiles[n].begin(), tiles[n].end());
    }
  }
  std::sort(sparse.begin(), sparse.end());
  const certificate::TileGroups groups = certificate::group_tiles(tiles, edge);
  EXPECT_EQ(groups.sparse, sparse);
  std::vector<part::Vec3> found;
  for (const certificate::SurfacePieces& pieces : groups.dense) {
    found.insert(found.end(), pieces.corners().begin(), pieces.corners().end());
  }
  EXPECT_EQ(found, dense);
}

}  // namespace
}  // namespace forcelayer
