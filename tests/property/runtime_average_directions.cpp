// Averaged directions: bit for bit their scalar twin, whatever the width of vectors.
#include "runtime/field/average_directions.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>

#include "tests/support/every_target.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::test {
namespace {

struct Collected {
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet set;
};

Collected random_contacts(Random& random, std::uint32_t count, float s) {
  Collected c;
  c.points.reserve(count);
  c.samples.reserve(count);
  c.set.reserve(count);
  // Beyond the last sample stands anything.
  for (auto* values : {&c.points.rx, &c.points.ry, &c.points.rz, &c.samples.gx, &c.samples.gy,
                       &c.samples.gz, &c.samples.dx, &c.samples.dy, &c.samples.dz}) {
    std::fill(values->begin(), values->end(), NAN);
  }
  c.points.count = c.set.count = count;
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<float>(static_cast<float>(low),
                                                 static_cast<float>(high))(random);
  };
  const bool flat = random() % 8 == 0;  // no slope at all: the field's own direction
  for (std::uint32_t i = 0; i < count; ++i) {
    c.points.rx[i] = s * number(-8, 8), c.points.ry[i] = s * number(-8, 8);
    c.points.rz[i] = s * number(-1, 1);
    c.samples.gx[i] = flat ? 0 : number(-1, 1), c.samples.gy[i] = flat ? 0 : number(-1, 1);
    c.samples.gz[i] = flat ? 0 : number(-1, 1);
    const glm::vec3 d = glm::normalize(glm::vec3(number(-1, 1), number(-1, 1), number(0.1, 1)));
    c.samples.dx[i] = d.x, c.samples.dy[i] = d.y, c.samples.dz[i] = d.z;
    c.set.ux[i] = d.x, c.set.uy[i] = d.y, c.set.uz[i] = d.z;
    c.set.depth_m[i] = s * number(-2, 1);
  }
  return c;
}

// The definition in average_directions.h, one sample after the other.
glm::vec3 twin(const Collected& c, std::uint32_t i, float s) {
  const std::uint32_t count = c.points.count, last = count > 32 ? count - 32 : 0;
  const std::uint32_t first = std::min(i > 16 ? i - 16 : 0, last);
  const float radius_m = field::kNeighbourVoxels * s, per_radius2 = 1.0f / (radius_m * radius_m);
  float sum[3] = {0, 0, 0};
  for (std::uint32_t n = first; n < std::min(first + 32, count); ++n) {
    const float dx = c.points.rx[n] - c.points.rx[i], dy = c.points.ry[n] - c.points.ry[i],
                dz = c.points.rz[n] - c.points.rz[i];
    const float near = std::max(0.0f, 1.0f - (dx * dx + dy * dy + dz * dz) * per_radius2);
    const float alike =
        std::max(0.0f, c.samples.gx[n] * c.samples.gx[i] + c.samples.gy[n] * c.samples.gy[i] +
                           c.samples.gz[n] * c.samples.gz[i]);
    const float weight = (near * alike) * (near * alike);
    sum[0] += weight * c.samples.gx[n];
    sum[1] += weight * c.samples.gy[n];
    sum[2] += weight * c.samples.gz[n];
  }
  const float length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  const float fraction = std::min(1.0f, length / 1e-3f);
  const float rest = (1.0f - fraction) * 1e-3f;
  const float own[3] = {c.samples.dx[i], c.samples.dy[i], c.samples.dz[i]};
  for (int axis = 0; axis < 3; ++axis) sum[axis] = fraction * sum[axis] + rest * own[axis];
  const float size = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
  return {sum[0] / size, sum[1] / size, sum[2] / size};
}

class AverageDirectionsOnEveryTarget : public EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, AverageDirectionsOnEveryTarget,
                         testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(AverageDirectionsOnEveryTarget, EqualTheirScalarTwinBitForBit) {
  constexpr float kS = 0.005f;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const auto count = static_cast<std::uint32_t>(random() % (seed % 2 ? 40 : 500));
    Collected c = random_contacts(random, count, kS);
    const field::ContactSet before = c.set;
    field::average_directions(c.points, c.samples, kS, -kS, c.set);
    for (std::uint32_t i = 0; i < count; ++i) {
      const field::Contact contact = c.set[i];
      const glm::vec3 expected = contact.depth_m > -kS ? twin(c, i, kS) : before[i].direction;
      ASSERT_EQ(contact.direction, expected) << "contact " << i << " of " << count;
    }
  }
}

}  // namespace
}  // namespace forcelayer::test
