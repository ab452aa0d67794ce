// The distance field: bit for bit its scalar twin; exact in front of walls; no depth in free
// voxels; leads out from inside; proven distances never above the exact ones.
#include "runtime/field/distance_field.h"

#include <gtest/gtest.h>

#include <hwy/targets.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/field/tangent_plane.h"
#include "tests/support/distance_scene.h"
#include "tests/support/every_target.h"
#include "tests/support/random_scenes.h"
#include "tests/support/reference_level.h"

namespace forcelayer::test {
namespace {

using Floats = std::array<float, 3>;

Floats as_floats(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// The code of a world voxel; beyond the sides in `cropped_sides` that of the nearest known voxel.
float code_of(const VoxelScene& scene, Voxel v, std::uint32_t cropped_sides) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = scene.min[axis], high = low + scene.dims[axis] - 1;
    if (cropped_sides >> (2 * axis) & 1) v[axis] = std::max(v[axis], low);
    if (cropped_sides >> (2 * axis + 1) & 1) v[axis] = std::min(v[axis], high);
  }
  return static_cast<float>(scene.code_at(v));
}

struct Twin {
  float phi = 0, depth_m = 0;  // signed
  float distance_m = 0;        // proven
  Floats direction{}, slope{}, gradient{};
};

// The definition of ForceField::measure at `fraction` of a world voxel: the arithmetic of the
// kernel, word by word, without tree or vectors.
Twin twin_of(const VoxelScene& scene, const Voxel& voxel, const Floats& fraction, const Floats& n,
             std::uint32_t cropped_sides = 0) {
  Voxel low = voxel;
  Floats between{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    between[axis] = fraction[axis] - 0.5f;
    if (fraction[axis] < 0.5f) between[axis] += 1.0f, --low[axis];
  }
  const auto at = [&](int x, int y, int z) {
    return code_of(scene, {low[0] + x, low[1] + y, low[2] + z}, cropped_sides);
  };
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  float at_x[2], step_y[2], step_z[2];
  for (int x = 0; x < 2; ++x) {
    const float z0 = at(x, 0, 1) - at(x, 0, 0), z1 = at(x, 1, 1) - at(x, 1, 0);
    const float y0 = at(x, 0, 0) + between[2] * z0, y1 = at(x, 1, 0) + between[2] * z1;
    step_y[x] = y1 - y0;
    at_x[x] = y0 + between[1] * step_y[x];
    step_z[x] = mix(z0, z1, between[1]);
  }
  const float step_x = at_x[1] - at_x[0];
  const float code = at_x[0] + between[0] * step_x;
  // The codes beside the cell, where the point's voxel is: one before its lower corners or one
  // behind its upper ones.
  std::array<int, 3> out{};
  for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = low[axis] == voxel[axis] ? -1 : 2;
  const auto along_z = [&](int x, int y) { return mix(at(x, y, 0), at(x, y, 1), between[2]); };
  const auto along_x = [&](int y, int z) { return mix(at(0, y, z), at(1, y, z), between[0]); };
  const Floats beside{mix(along_z(out[0], 0), along_z(out[0], 1), between[1]),
                      mix(along_z(0, out[1]), along_z(1, out[1]), between[0]),
                      mix(along_x(0, out[2]), along_x(1, out[2]), between[1])};
  const Floats cell{step_x, mix(step_y[0], step_y[1], between[0]),
                    mix(step_z[0], step_z[1], between[0])};
  const auto step = static_cast<float>(scene.distances.quantum_m / scene.voxel_size_m);
  const auto size_m = static_cast<float>(scene.voxel_size_m);
  Twin twin;
  // Codes are rounded down: each stands for the middle of its step.
  const double zero_code =
      scene.distances.zero_code - 0.5 + scene.zero_force_m() / scene.distances.quantum_m;
  twin.phi = (code - static_cast<float>(zero_code)) * step;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float a = between[axis] - 0.5f, b = std::abs(a);
    const float kept = (b - 1.5f) * b + 1.0f;
    twin.slope[axis] = (kept * cell[axis] + a * (beside[axis] - code)) * step;
    twin.gradient[axis] = cell[axis] * step;
  }
  // Squares of the corners' lower bounds, interpolated as the kernel does.
  const auto mesh_code = static_cast<float>(scene.distances.zero_code);
  const auto square = [&](int x, int y, int z) {
    const float above = std::max(at(x, y, z) - mesh_code, 0.0f);
    return above * above;
  };
  const auto squares_along_z = [&](int x, int y) {
    return mix(square(x, y, 0), square(x, y, 1), between[2]);
  };
  const float squared =
      mix(mix(squares_along_z(0, 0), squares_along_z(0, 1), between[1]),
          mix(squares_along_z(1, 0), squares_along_z(1, 1), between[1]), between[0]);
  float spread = 0;
  for (const float t : between) spread += t * (1.0f - t);
  const double codes = scene.voxel_size_m / scene.distances.quantum_m;
  const float lost = spread * static_cast<float>(codes * codes) + 0.125f;
  twin.distance_m = std::sqrt(std::max(squared - lost, 0.0f)) *
                    (static_cast<float>(1 / codes) * size_m * (1 - 4 * 0x1p-23f));
  for (std::size_t axis = 0; axis < 3; ++axis) {  // where the cell reaches beyond a cropped side
    const std::int64_t first = scene.min[axis], end = first + scene.dims[axis];
    const bool below = (cropped_sides >> (2 * axis) & 1) != 0 && low[axis] < first;
    const bool above = (cropped_sides >> (2 * axis + 1) & 1) != 0 && low[axis] + 1 >= end;
    if (below || above) twin.distance_m = 0;
  }
  const auto length_of = [](const Floats& v) {
    return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  };
  const auto clamp01 = [](float x) { return std::min(std::max(x, 0.0f), 1.0f); };
  const float depth = -twin.phi, buried = clamp01((depth - 1.5f) * 2.0f);
  Floats u{};
  for (std::size_t a = 0; a < 3; ++a) u[a] = twin.slope[a] + 0.05f * buried * n[a];
  const float length = length_of(u);
  if (!(length > 1e-6f)) {
    twin.depth_m = std::min(depth, 0.0f) * size_m;
    twin.direction = n;
    return twin;
  }
  const float per_length = 1.0f / length, gain = 1 / 0.1f;
  for (std::size_t a = 0; a < 3; ++a) twin.direction[a] = u[a] * per_length;
  const float certain = std::min(length_of(twin.slope) * gain, 1.0f);
  const float beyond = std::max(depth - 1.0f, 0.0f) * certain;
  twin.depth_m = (std::min(depth, 1.0f) + beyond) * std::min(length * gain, 1.0f) * size_m;
  return twin;
}

// Spheres, or noise, across the edges of bricks, nodes and directory cells.
VoxelScene random_distances(Random& random, bool with_noise = true) {
  Voxel min{}, dims{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t edge = std::array<std::int64_t, 4>{0, 8, 64, 512}[random() % 4];
    min[axis] = edge * integer(random, -2, 2) - integer(random, 4, 20);
    dims[axis] = integer(random, 20, 34);
  }
  const double s = 0.003;
  std::vector<glm::dvec4> spheres;
  for (std::int64_t n = integer(random, 1, 4); n > 0; --n) {
    glm::dvec4 sphere;
    for (int a = 0; a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      sphere[a] =
          s * (static_cast<double>(min[i]) + uniform(random, 0, 1) * static_cast<double>(dims[i]));
    }
    sphere.w = s * uniform(random, 0, 8);
    spheres.push_back(sphere);
  }
  const bool noise = with_noise && random() % 4 == 0;
  const DistanceDefinition definition(static_cast<std::uint32_t>(integer(random, 1, 3)),
                                      uniform(random, 2, 6));
  return distance_scene(
      s, min, dims,
      [&](const glm::dvec3& p) {
        double smallest = 1;
        for (const glm::dvec4& sphere : spheres) {
          smallest = std::min(smallest, glm::length(p - glm::dvec3(sphere)) - sphere.w);
        }
        return noise ? s * uniform(random, -3, 8) : smallest;
      },
      2, definition);
}

Voxel random_voxel(Random& random, const VoxelScene& scene) {
  Voxel v{};
  const int tries = random() % 2 ? 1 : 20;
  for (int i = 0; i < tries; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t low = scene.min[axis], high = low + scene.dims[axis] - 1;
      v[axis] = std::clamp(integer(random, low - 3, high + 3), low & ~511, high | 511);
    }
    if (scene.at(v) != VoxelValue::kFree) break;
  }
  return v;
}

Floats random_fraction(Random& random) {
  Floats f{};
  for (float& x : f) {
    // Faces and centers of voxels too: that is where a mistake would show.
    x = random() % 8 == 0 ? 0.5f * static_cast<float>(random() % 2)
                          : static_cast<float>(integer(random, 0, (1 << 24) - 1)) * 0x1p-24f;
  }
  return f;
}

// The slope by its definition: differences between the codes of neighboring voxels, each in the
// middle between their centers, interpolated between these along the axis and between the centers
// across it.
glm::dvec3 defined_slope(const VoxelScene& scene, const Voxel& voxel, const Floats& fraction) {
  glm::dvec3 slope(0);
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 shifted(fraction[0] - 0.5, fraction[1] - 0.5, fraction[2] - 0.5);
    shifted[axis] -= 0.5;
    const glm::dvec3 whole = glm::floor(shifted), f = shifted - whole;
    for (int n = 0; n < 8; ++n) {
      const glm::ivec3 corner(n & 1, n >> 1 & 1, n >> 2);
      double weight = 1;
      Voxel low{};
      for (int a = 0; a < 3; ++a) {
        weight *= corner[a] ? f[a] : 1 - f[a];
        const auto i = static_cast<std::size_t>(a);
        low[i] = voxel[i] + static_cast<std::int64_t>(whole[a]) + corner[a];
      }
      Voxel high = low;
      ++high[static_cast<std::size_t>(axis)];
      slope[axis] += weight * (code_of(scene, high, 0) - code_of(scene, low, 0));
    }
  }
  return slope * (scene.distances.quantum_m / scene.voxel_size_m);
}

class DistanceFieldOnEveryTarget : public EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, DistanceFieldOnEveryTarget,
                         testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(DistanceFieldOnEveryTarget, EqualsItsScalarTwinBitForBit) {
  std::uint32_t pushes = 0;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const VoxelScene scene = random_distances(random);
    const auto cropped = static_cast<std::uint32_t>(random() % 2 ? random() % 64 : 0);
    const Voxmap voxmap = make_voxmap(scene, cropped);
    const field::DistanceField field(voxmap);
    for (int frame = 0; frame < 3; ++frame) {  // the second finds its bricks decoded
      const auto count = static_cast<std::uint32_t>(integer(random, 0, 900));
      query::CollectedPoints points;
      points.reserve(count);
      std::vector<Twin> twins;
      const std::uint64_t near_in_ten = random() % 10;
      for (std::uint32_t i = 0; i < count; ++i) {
        const Voxel v = random_voxel(random, scene);
        const Floats fraction = random_fraction(random),
                     normal = as_floats(random_direction(random));
        const bool near = random() % 10 < near_in_ten;
        collect(points, voxmap, v, near ? VoxelValue::kProximity : VoxelValue::kSurface, fraction,
                normal);
        twins.push_back(twin_of(scene, v, fraction, normal, cropped));
      }
      field::FieldSamples samples;
      samples.reserve(count);
      field.measure(points, samples);
      for (std::uint32_t i = 0; i < count; ++i) {
        ASSERT_EQ(samples.depth_m[i], twins[i].depth_m) << "point " << i;
        ASSERT_EQ((Floats{samples.dx[i], samples.dy[i], samples.dz[i]}), twins[i].direction);
        ASSERT_EQ((Floats{samples.gx[i], samples.gy[i], samples.gz[i]}), twins[i].slope);
        ASSERT_EQ((Floats{samples.ex[i], samples.ey[i], samples.ez[i]}), twins[i].gradient);
        ASSERT_EQ(samples.distance_m[i], twins[i].distance_m);
        pushes += twins[i].depth_m > 0;
      }
    }
  }
  EXPECT_GT(pushes, 1000u);
}

TEST_P(DistanceFieldOnEveryTarget, HoldsWhereBricksReplaceEachOther) {
  static const VoxelScene scene = [] {  // noise; 2500 bricks, of which some share a slot
    Random random(7);
    return distance_scene(
        0.003, {-64, 0, 100}, {400, 400, 12},
        [&](const glm::dvec3&) { return 0.003 * static_cast<double>(random() % 9); }, 2,
        DistanceDefinition(2));
  }();
  static const Voxmap voxmap = make_voxmap(scene);
  Random random(8);
  const field::DistanceField field(voxmap);
  query::CollectedPoints points;
  points.reserve(5000);
  std::vector<Twin> twins;
  for (int i = 0; i < 5000; ++i) {
    const Voxel v = random_voxel(random, scene);
    const Floats fraction = random_fraction(random), normal = as_floats(random_direction(random));
    collect(points, voxmap, v, VoxelValue::kSurface, fraction, normal);
    twins.push_back(twin_of(scene, v, fraction, normal));
  }
  field::FieldSamples samples;
  samples.reserve(5000);
  field.measure(points, samples);
  for (std::uint32_t i = 0; i < 5000; ++i) ASSERT_EQ(samples.depth_m[i], twins[i].depth_m);
}

TEST(DistanceField, GivesNoDepthInFreeVoxels) {
  std::uint32_t pushes = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const VoxelScene scene = random_distances(random, false);
    const Voxmap voxmap = make_voxmap(scene);
    constexpr std::uint32_t kCount = 5000;
    query::CollectedPoints points;
    points.reserve(kCount);
    std::vector<VoxelValue> values;
    for (std::uint32_t i = 0; i < kCount; ++i) {
      Voxel v = random_voxel(random, scene);
      for (std::size_t axis = 0; axis < 3; ++axis) {  // the box cuts spheres off at its faces
        const std::int64_t low = scene.min[axis], high = low + scene.dims[axis] - 1;
        v[axis] = std::clamp(v[axis], low + 1, high - 1);
      }
      values.push_back(scene.at(v));
      collect(points, voxmap, v, values.back(), random_fraction(random),
              as_floats(random_direction(random)));
    }
    field::FieldSamples samples;
    samples.reserve(kCount);
    field::DistanceField(voxmap).measure(points, samples);
    for (std::uint32_t i = 0; i < kCount; ++i) {
      if (!(samples.depth_m[i] > 0)) continue;
      ++pushes;
      ASSERT_NE(values[i], VoxelValue::kFree);
    }
  }
  EXPECT_GT(pushes, 1000u);
}

TEST(DistanceField, SlopeIsThatOfDifferencesBetweenTheirMiddles) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const VoxelScene scene = random_distances(random);
    for (int i = 0; i < 400; ++i) {
      const Voxel v = random_voxel(random, scene);
      const Floats fraction = random_fraction(random);
      const Floats slope = twin_of(scene, v, fraction, {0, 0, 1}).slope;
      const glm::dvec3 defined = defined_slope(scene, v, fraction);
      // Single precision of codes up to 255, times up to 6 voxels over 127 codes, or 15.
      for (int a = 0; a < 3; ++a) {
        ASSERT_NEAR(slope[static_cast<std::size_t>(a)], defined[a], 2e-5) << "axis " << a;
      }
    }
  }
}

TEST(DistanceField, SlopeIsContinuousWhereTheCellOrTheVoxelChanges) {
  constexpr float kBit = 0x1p-24f;
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const VoxelScene scene = random_distances(random);
    for (int i = 0; i < 400; ++i) {
      const Voxel v = random_voxel(random, scene);
      Floats before = random_fraction(random), behind = before;
      Voxel next = v;
      const std::size_t axis = random() % 3;
      if (random() % 2) {
        before[axis] = 1 - kBit, behind[axis] = 0, ++next[axis];
      } else {
        before[axis] = 0.5f - kBit, behind[axis] = 0.5f;
      }
      const Floats a = twin_of(scene, v, before, {0, 0, 1}).slope;
      const Floats b = twin_of(scene, next, behind, {0, 0, 1}).slope;
      for (std::size_t n = 0; n < 3; ++n) ASSERT_NEAR(a[n], b[n], 4e-5) << "axis " << n;
    }
  }
}

// A half-space behind n . x = 0.
VoxelScene half_space(const glm::dvec3& n, const DistanceDefinition& definition) {
  return distance_scene(
      0.01, {-14, -14, -14}, {28, 28, 28}, [&](const glm::dvec3& p) { return glm::dot(n, p); }, 2,
      definition);
}

TEST(DistanceField, IsExactInFrontOfAPlaneButForTheQuantum) {
  for (const double range_voxels : {2.0, 4.0}) {
    const DistanceDefinition definition(2, range_voxels);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Random random(seed);
      const glm::dvec3 n = random_direction(random);
      const VoxelScene scene = half_space(n, definition);
      for (int i = 0; i < 200; ++i) {
        const double height =
            uniform(random, definition.zero_force - 1, definition.zero_force + 0.5);
        glm::dvec3 p = random_direction(random) * uniform(random, 0, 6);
        p += n * (height - glm::dot(n, p));
        const glm::dvec3 whole = glm::floor(p);
        const Voxel v{static_cast<std::int64_t>(whole.x), static_cast<std::int64_t>(whole.y),
                      static_cast<std::int64_t>(whole.z)};
        const Twin twin = twin_of(scene, v, as_floats(p - whole), as_floats(-n));
        // Each code is off by up to half a step.
        EXPECT_NEAR(twin.phi, height - definition.zero_force, 0.5 * definition.quantum + 1e-5);
        for (int a = 0; a < 3; ++a) {
          EXPECT_NEAR(twin.direction[static_cast<std::size_t>(a)], n[a], 3 * definition.quantum);
        }
      }
    }
  }
}

// Never above the exact distance, at any place: from spheres, sheets without an inside, edges and
// corners, in front of and behind them, near and far beyond the codes. And not far below it.
TEST(DistanceField, ProvenDistancesAreNeverAboveTheExactOnes) {
  std::vector<double> slack;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const double s = std::array<double, 3>{0.0007, 0.005, 0.3}[random() % 3];
    Voxel min{};
    const Voxel dims{22, 22, 22};
    for (std::int64_t& low : min) low = integer(random, -2, 2) * 512 - integer(random, 2, 20);
    std::vector<std::function<double(const glm::dvec3&)>> bodies;
    for (std::int64_t n = integer(random, 1, 4); n > 0; --n) {
      glm::dvec3 at;
      for (int a = 0; a < 3; ++a) {
        at[a] =
            s * (static_cast<double>(min[static_cast<std::size_t>(a)]) + uniform(random, 0, 22));
      }
      const glm::dvec3 half =
          s * glm::dvec3(uniform(random, 0, 8), uniform(random, 0, 8), uniform(random, 0, 8));
      const double radius = s * uniform(random, 0, 6);
      const int kind = static_cast<int>(random() % 4);
      const glm::dmat3 turn =
          glm::mat3_cast(glm::angleAxis(uniform(random, 0, 3), random_direction(random)));
      bodies.push_back([=](const glm::dvec3& p) {
        const glm::dvec3 q = (p - at) * turn;
        if (kind == 0) return glm::length(q) - radius;  // a sphere; a point where it is small
        glm::dvec3 h = half;
        if (kind == 1) h.z = 0;                                        // a sheet
        if (kind == 2) h = glm::dvec3(h.x, 0, 0);                      // a line
        return glm::length(glm::max(glm::abs(q) - h, glm::dvec3(0)));  // a box, as a set
      });
    }
    const auto exact_m = [&](const glm::dvec3& p) {
      double smallest = 1e300;
      for (const auto& body : bodies) smallest = std::min(smallest, body(p));
      return smallest;
    };
    const DistanceDefinition definition(static_cast<std::uint32_t>(integer(random, 1, 3)),
                                        uniform(random, 2, 8));
    const VoxelScene scene = distance_scene(s, min, dims, exact_m, 2, definition);
    const Voxmap voxmap = make_voxmap(scene);
    const field::DistanceField field(voxmap);
    query::CollectedPoints points;
    points.reserve(2000);
    std::vector<double> exact;
    for (int i = 0; i < 2000; ++i) {
      Voxel v{};
      for (std::size_t a = 0; a < 3; ++a) v[a] = min[a] + integer(random, 1, 20);
      const Floats fraction = random_fraction(random);
      collect(points, voxmap, v, VoxelValue::kSurface, fraction,
              as_floats(random_direction(random)));
      glm::dvec3 p;
      for (int a = 0; a < 3; ++a) {
        const auto n = static_cast<std::size_t>(a);
        p[a] = s * (static_cast<double>(v[n]) + double{fraction[n]});
      }
      exact.push_back(std::max(exact_m(p), 0.0));
    }
    field::FieldSamples samples;
    samples.reserve(2000);
    field.measure(points, samples);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      ASSERT_LE(double{samples.distance_m[i]}, exact[i]) << "point " << i;
      const double voxels = exact[i] / s;
      if (voxels > 1.5 && voxels < definition.zero_force + 2) {
        slack.push_back(voxels - double{samples.distance_m[i]} / s);
      }
    }
  }
  ASSERT_GT(slack.size(), 10000u);
  std::sort(slack.begin(), slack.end());
  EXPECT_LT(slack[slack.size() / 2], 0.15);
  EXPECT_LT(slack[slack.size() * 99 / 100], 0.4);
}

TEST(DistanceField, LeadsOutFromInsideAndHalfAVoxelBeyond) {
  const DistanceDefinition definition(2);
  const glm::dvec3 n(0, 0, 1);
  const VoxelScene scene = half_space(n, definition);
  const Voxmap voxmap = make_voxmap(scene);
  const field::DistanceField field(voxmap);
  const auto push_at = [&](std::int64_t z, const Floats& normal) {
    query::CollectedPoints points;
    points.reserve(1);
    collect(points, voxmap, {2, 3, z}, VoxelValue::kInterior, {0.5f, 0.5f, 0.5f}, normal);
    field::FieldSamples samples;
    samples.reserve(1);
    field.measure(points, samples);
    return samples;
  };
  // A voxel behind the mesh, 3.4 behind the zero force: straight up, whatever the part's normal.
  const field::FieldSamples near = push_at(-1, {1, 0, 0});
  EXPECT_GT(near.dz[0], 0.99f);
  EXPECT_NEAR(near.depth_m[0], 0.01 * (definition.zero_force + 0.5), 0.0004);
  // Where all codes are 0: the normal, and half a voxel.
  const field::FieldSamples deep = push_at(-9, {0.6f, 0, 0.8f});
  EXPECT_FLOAT_EQ(deep.dx[0], 0.6f);
  EXPECT_FLOAT_EQ(deep.dz[0], 0.8f);
  EXPECT_NEAR(deep.depth_m[0], 0.005, 1e-6);
}

TEST(DistanceField, IsTheUsualOneWhereDistancesAre) {
  const VoxelScene scene = half_space({0, 0, 1}, DistanceDefinition(2));
  const Voxmap full = make_voxmap(scene);
  const Voxmap lean =
      make_voxmap(offset_scene(0.01, {0, 0, 0}, {8, 8, 8}, 1, [](Voxel v) { return v[2] < 2; }));
  EXPECT_EQ(field::usual_force(Model::kDefault, full), ForceKind::kDistance);
  EXPECT_EQ(field::usual_force(Model::kPaper, full), ForceKind::kTangentPlane);
  EXPECT_EQ(field::usual_force(Model::kDefault, lean), ForceKind::kLevel);
  EXPECT_TRUE(field::make_force_field(Model::kDefault, ForceKind::kDistance, full));
  EXPECT_TRUE(field::make_force_field(Model::kDefault, ForceKind::kLevel, full));
  const auto refused = field::make_force_field(Model::kDefault, ForceKind::kDistance, lean);
  ASSERT_FALSE(refused);
  EXPECT_EQ(exit_status(refused.error().code), 2);
}

}  // namespace
}  // namespace forcelayer::test
