// The parts of the default model, each against what it must be.
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "runtime/coupling/coupling_angle.h"
#include "runtime/coupling/passivity.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/model/contact_force.h"
#include "runtime/model/motion_allowance.h"
#include "runtime/model/principal_inertia.h"
#include "runtime/model/rigid_body.h"
#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::test {
namespace {

glm::dmat3 random_inertia(std::mt19937_64& random) {
  model::PrincipalInertia inertia;
  inertia.axes = glm::mat3_cast(random_orientation(random));
  for (int axis = 0; axis < 3; ++axis) {
    inertia.moments[axis] = std::pow(10.0, uniform(random, -6, -3));
  }
  return model::tensor_of(inertia);
}

coupling::Vector6 random_vector(std::mt19937_64& random) {
  return coupling::vector6(random_direction(random), random_direction(random) * 20.0);
}

model::StepSystem random_system(std::mt19937_64& random) {
  model::StepSystem system;
  const glm::dmat3 inertia = random_inertia(random);
  for (int row = 0; row < 3; ++row) {
    system.inertia.lower[coupling::Symmetric6::at(row, row)] = 0.012;
    for (int column = 0; column <= row; ++column)
      system.inertia.lower[coupling::Symmetric6::at(3 + row, 3 + column)] = inertia[column][row];
  }
  system.momentum = system.inertia * random_vector(random);
  system.translation = {2000, glm::dmat3(8.0), 15};
  system.rotation = {0.5, glm::dmat3(1e-3), 0.1};
  system.displacement.displacement = random_direction(random) * uniform(random, 0, 0.02);
  system.angle.displacement = random_direction(random) * uniform(random, 0, 1);
  // Half of them held by the centroid.
  system.arm_m = random_direction(random) * std::max(0.0, uniform(random, -0.1, 0.1));
  system.dt_s = 0.001;
  return system;
}

// The coupling's rows of a system, with the clamp's secant at `v`.
void add_coupling(const model::StepSystem& system, const coupling::Vector6& v,
                  coupling::Symmetric6& matrix, coupling::Vector6& impulse) {
  coupling::add_force(system.translation, system.displacement, system.arm_m, v, system.dt_s, matrix,
                      impulse);
  coupling::add_torque(system.rotation, system.angle, v, system.dt_s, matrix, impulse);
}

std::vector<model::ContactRow> random_rows(std::mt19937_64& random) {
  std::vector<model::ContactRow> rows(static_cast<std::size_t>(uniform(random, 0, 40)));
  for (model::ContactRow& row : rows) {
    const glm::dvec3 n = random_direction(random);
    row.j = coupling::vector6(n, glm::cross(random_direction(random) * 0.03, n));
    row.weight = std::pow(10.0, uniform(random, -4, 1));
    row.onset = uniform(random, -1, 1);
  }
  return rows;
}

model::ContactRows columns_of(const std::vector<model::ContactRow>& rows) {
  model::ContactRows columns;
  columns.reserve(rows.size());
  for (const model::ContactRow& row : rows) columns.add(row);
  return columns;
}

void use_vectors(std::int64_t targets) {  // 0: all
  hwy::SetSupportedTargetsForTest(targets);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

// Rows of points side by side, as a shell has them, of a part that bends; some are far from
// pushing.
std::vector<model::ContactRow> rows_side_by_side(std::mt19937_64& random) {
  std::vector<model::ContactRow> rows(static_cast<std::size_t>(uniform(random, 0, 1500)));
  const glm::dvec3 axis = random_direction(random);
  const double bend_rad = uniform(random, 0, 0.05), gap_mps = uniform(random, -0.05, 0.5);
  glm::dvec3 n = random_direction(random);
  for (model::ContactRow& row : rows) {
    n = glm::normalize(n + bend_rad * glm::cross(axis, n));
    row.j = coupling::vector6(n, glm::cross(-0.03 * n + 0.01 * random_direction(random), n));
    row.weight = std::pow(10.0, uniform(random, -4, 1));
    row.onset = uniform(random, 0, 0.05) - gap_mps;
  }
  return rows;
}

// Sums in eight columns, added in the order of ContactRows.
double sum_of_eight(const std::array<double, 8>& c) {
  return ((c[0] + c[4]) + (c[2] + c[6])) + ((c[1] + c[5]) + (c[3] + c[7]));
}

// Energy, and the sum over the rows that push, one row after the other.
double sum_plainly(const std::vector<model::ContactRow>& rows, const coupling::Vector6& v,
                   model::ContactRowSum& sum) {
  std::array<double, 8> energy{};
  std::array<std::array<double, 8>, 27> sums{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const model::ContactRow& row = rows[i];
    double speed = row.j[0] * v[0];
    for (std::size_t k = 1; k < 6; ++k) speed += row.j[k] * v[k];
    const double short_of = row.onset - speed;
    if (!(short_of > 0)) continue;
    energy[i % 8] += 0.5 * row.weight * (short_of * short_of);
    for (std::size_t k = 0, n = 0; k < 6; ++k) {
      const double weighted = row.weight * row.j[k];
      for (std::size_t l = 0; l <= k; ++l, ++n) sums[n][i % 8] += weighted * row.j[l];
      sums[21 + k][i % 8] += weighted * row.onset;
    }
  }
  for (std::size_t n = 0; n < 21; ++n) sum.matrix.lower[n] = sum_of_eight(sums[n]);
  for (std::size_t n = 0; n < 6; ++n) sum.impulse[n] = sum_of_eight(sums[21 + n]);
  return sum_of_eight(energy);
}

// Rows that push nothing are left out by the box around them: no bit changes.
TEST(ContactRows, ThatPushNothingAreLeftOutBitForBit) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    std::vector<model::ContactRow> rows = rows_side_by_side(random), all = rows;
    std::vector<coupling::Vector6> velocities(4);
    for (coupling::Vector6& v : velocities) {
      v = coupling::vector6(random_direction(random) * uniform(random, 0, 0.5),
                            random_direction(random) * uniform(random, 0, 3));
    }
    velocities.push_back({});
    // Rows on the threshold, and one representable step away from it.
    for (int n = 0; n < 200 && !rows.empty(); ++n) {
      model::ContactRow row = rows[n * 7919u % rows.size()];
      const coupling::Vector6& v = velocities[random() % velocities.size()];
      row.onset = row.j[0] * v[0];
      for (std::size_t k = 1; k < 6; ++k) row.onset += row.j[k] * v[k];
      if (n % 3 == 1) row.onset = std::nextafter(row.onset, 1.0);
      if (n % 3 == 2) row.onset = std::nextafter(row.onset, -1.0);
      // Alone in a box, of which no other row widens the box.
      for (int same = 0; same < (n < 4 ? 64 : 1); ++same) all.push_back(row);
    }
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      use_vectors(target);
      model::ContactRows columns;
      columns.reserve(all.size());
      std::size_t added = 0;
      // As a solve does: contacts found later are added to rows that have been summed.
      for (const std::size_t end : {rows.size(), all.size()}) {
        for (; added < end; ++added) columns.add(all[added]);
        const std::vector<model::ContactRow> there(all.begin(),
                                                   all.begin() + static_cast<std::ptrdiff_t>(end));
        for (const coupling::Vector6& v : velocities) {
          model::ContactRowSum sum;
          const double energy_j = sum_plainly(there, v, sum);
          EXPECT_EQ(columns.energy_j(v), energy_j);
          const model::ContactRowSum& found = columns.pushing();
          EXPECT_EQ(0, std::memcmp(&found, &sum, sizeof sum));
        }
      }
    }
    use_vectors(0);
  }
}

// A row that is not a number pushes nothing, and hides no row beside it.
TEST(ContactRows, ThatAreNoNumbersHideNoOthers) {
  for (const std::size_t bad : {0u, 5u, 63u}) {
    model::ContactRow row;
    row.j = {1, 0, 0, 0, 0, 0};
    row.weight = 1, row.onset = 0.5;
    std::vector<model::ContactRow> rows(64, row);
    for (std::size_t k = 0; k < 7; ++k) {
      std::vector<model::ContactRow> with_bad = rows;
      (k < 6 ? with_bad[bad].j[k] : with_bad[bad].onset) = NAN;
      model::ContactRows columns = columns_of(with_bad);
      EXPECT_EQ(columns.energy_j({}), 63 * 0.125);
    }
  }
}

// Every vector width gives the bits of the narrowest, and these are what one row after the other
// gives, but for the order of the sums; a set of rows that push that comes again, or changes, is
// noticed.
TEST(ContactRows, AreSummedAsOneAfterTheOther) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const std::vector<model::ContactRow> rows = random_rows(random);
    const coupling::Vector6 velocities[] = {random_vector(random), random_vector(random)};
    std::vector<double> energies_j;  // of the first width, then of all others
    std::vector<model::ContactRowSum> sums;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      use_vectors(target);
      model::ContactRows columns = columns_of(rows);
      const bool first = energies_j.size() < 4;
      for (const int at : {0, 1, 2, 3}) {
        const int which = at == 1 || at == 2;
        const coupling::Vector6& v = velocities[which];
        double energy_j = 0;
        model::ContactRowSum sum;
        for (const model::ContactRow& row : rows) {
          const double short_of = row.onset - coupling::dot(row.j, v);
          if (!(short_of > 0)) continue;
          energy_j += 0.5 * row.weight * short_of * short_of;
          sum.matrix.add_outer(row.j, row.weight);
          for (int i = 0; i < 6; ++i) sum.impulse[i] += row.weight * row.onset * row.j[i];
        }
        const double found_j = columns.energy_j(v);
        const model::ContactRowSum& found = columns.pushing();
        EXPECT_NEAR(found_j, energy_j, 1e-14 * energy_j);
        const double scale = sum.matrix.lower[0] + sum.matrix.lower[2] + sum.matrix.lower[5];
        for (std::size_t i = 0; i < 21; ++i) {
          EXPECT_NEAR(found.matrix.lower[i], sum.matrix.lower[i], 1e-14 * scale) << i;
        }
        for (std::size_t i = 0; i < 6; ++i) {
          EXPECT_NEAR(found.impulse[i], sum.impulse[i], 1e-14 * scale) << i;
        }
        if (first) energies_j.push_back(found_j), sums.push_back(found);
        EXPECT_EQ(found_j, energies_j[at]);
        EXPECT_EQ(0, std::memcmp(&found, &sums[at], sizeof found));
      }
    }
    use_vectors(0);
  }
}

field::ContactSet random_set(std::mt19937_64& random, double voxel_size_m) {
  field::ContactSet set;
  const auto room = static_cast<std::uint32_t>(uniform(random, 0, 60));
  set.reserve(room);
  // Beyond the last contact stands anything.
  for (auto* column :
       {&set.rx, &set.ry, &set.rz, &set.ux, &set.uy, &set.uz, &set.depth_m, &set.weight}) {
    std::fill(column->begin(), column->end(), 1e30f);
  }
  const double deepest = uniform(random, -0.5, 1);  // voxels: from none to all touch
  for (; set.count < room; ++set.count) {
    const std::uint32_t i = set.count;
    const glm::vec3 arm_m(random_direction(random) * 0.03), push(random_direction(random));
    set.rx[i] = arm_m.x, set.ry[i] = arm_m.y, set.rz[i] = arm_m.z;
    set.ux[i] = push.x, set.uy[i] = push.y, set.uz[i] = push.z;
    set.depth_m[i] = static_cast<float>(uniform(random, deepest - 1, deepest) * voxel_size_m);
    set.weight[i] = static_cast<float>(uniform(random, 0.25, 4));
  }
  return set;
}

// That of three voxels of foam.
field::ForceCurve foam_curve(double voxel_size_m) {
  const DistanceDefinition definition(2, 6, 3);
  VoxelScene scene = distance_scene(
      voxel_size_m, {0, 0, -4}, {8, 8, 16}, [](const glm::dvec3& p) { return p.z; }, 2, definition);
  for (int i = 0; i * definition.quantum < 3; ++i) {
    scene.distances.compliance.push_back(static_cast<float>(i * i));
  }
  return field::ForceCurve(make_voxmap(scene));
}

// The definitions in contact_force.h, one contact after the other.
struct SetTwin {
  model::ContactTotals totals;
  double energy_j = 0;
  std::vector<model::ContactRow> rows;
  coupling::Vector6 brake{};
  double brake_allowed = 0;
};

SetTwin twin_of(const field::ContactSet& set, const model::ContactLaw& law,
                const coupling::Vector6& velocity, double dt_s, double reach_m) {
  SetTwin twin;
  for (std::uint32_t i = 0; i < set.count; ++i) {
    const field::Contact c = set[i];
    const double depth_m = double{c.depth_m} - law.begin_m;
    twin.totals.count += depth_m > 0;
    twin.totals.depth_m = std::max(twin.totals.depth_m, static_cast<float>(depth_m));
  }
  for (std::uint32_t i = 0; i < set.count; ++i) {
    const field::Contact c = set[i];
    const double depth_m = double{c.depth_m} - law.begin_m;
    if (depth_m > 0) {
      twin.energy_j += law.stiffness_n_per_m * std::max(law.min_areas, double{c.weight}) *
                       law.curve.energy_m2(depth_m);
    }
    if (!(depth_m < -reach_m)) {
      twin.rows.push_back(model::spring_row(c, law.curve.force_m(depth_m), law, dt_s));
    }
    const coupling::Vector6 j = model::separation_row(c);
    const double allowed_mps = -double{c.depth_m} / (model::kBrakeFrames * dt_s);
    const double excess_mps = -coupling::dot(j, velocity) - allowed_mps;
    if (!(c.depth_m < 0 && excess_mps > 0)) continue;
    for (int k = 0; k < 6; ++k) twin.brake[k] += c.weight * excess_mps * j[k];
    twin.brake_allowed += c.weight * excess_mps * allowed_mps;
  }
  return twin;
}

// Every vector width gives the bits of the narrowest, and these are what one contact after the
// other gives, but for the order of the sums. Rows are the same bits.
TEST(ContactForce, OfASetIsThatOfOneContactAfterTheOther) {
  constexpr double kS = 0.005, kDtS = 0.001;
  const model::ContactLaw straight{8000, 6, 1, {}}, soft{8000, 6, 0, foam_curve(kS)},
      core{180'000, 6, 1, {}, 0.3 * kS};
  ASSERT_FALSE(soft.curve.is_straight());
  std::size_t rows_seen = 0, brakes_seen = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const field::ContactSet set = random_set(random, kS);
    const model::ContactLaw& law = seed % 3 == 0 ? soft : seed % 3 == 1 ? core : straight;
    const double reach_m = uniform(random, 0, 1) * kS;
    const coupling::Vector6 velocity = random_vector(random);
    const model::StepSystem system = random_system(random);
    const SetTwin twin = twin_of(set, law, velocity, kDtS, reach_m);
    rows_seen += twin.rows.size();
    model::ContactTotals first;
    model::ContactRow first_brake;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      use_vectors(target);
      const model::ContactTotals totals = model::contact_totals(set, law);
      EXPECT_EQ(totals.count, twin.totals.count);
      EXPECT_EQ(totals.depth_m, twin.totals.depth_m);
      EXPECT_NEAR(model::contact_energy_j(totals, law), twin.energy_j, 1e-14 * twin.energy_j);

      model::ContactRows rows;
      rows.reserve(set.count + 1);
      rows.add(model::ContactRow{});  // so that they do not start where a vector would
      model::add_contact_rows(set, law, kDtS, reach_m, rows);
      ASSERT_EQ(rows.size(), twin.rows.size() + 1);
      const model::ContactRowColumns end = rows.next();
      for (std::size_t n = 0; n < twin.rows.size(); ++n) {
        const model::ContactRow& row = twin.rows[n];
        const std::ptrdiff_t at =
            static_cast<std::ptrdiff_t>(n) - static_cast<std::ptrdiff_t>(twin.rows.size());
        for (std::size_t k = 0; k < 6; ++k) ASSERT_EQ(end.at[k][at], row.j[k]) << n;
        ASSERT_EQ(end.at[model::ContactRowColumns::kWeight][at], row.weight) << n;
        ASSERT_EQ(end.at[model::ContactRowColumns::kOnset][at], row.onset) << n;
      }
      for (const double* column : end.at) {
        for (int n = 0; n < 8; ++n) ASSERT_EQ(column[n], 0);  // rows that push nothing
      }

      model::ContactRow brake;
      const bool brakes = model::braking_row(set, system.inertia, velocity, kDtS, brake);
      ASSERT_EQ(brakes, coupling::dot(twin.brake, twin.brake) > 0);
      if (brakes) {
        double scale = 0;
        for (const double component : twin.brake) scale += std::abs(component);
        for (int k = 0; k < 6; ++k) EXPECT_NEAR(brake.j[k], twin.brake[k], 1e-13 * scale);
        EXPECT_NEAR(brake.onset, -twin.brake_allowed, 1e-14 * twin.brake_allowed);
        EXPECT_NEAR(brake.weight * coupling::dot(brake.j, coupling::solve(system.inertia, brake.j)),
                    0.5, 1e-14);
      }
      if (target == hwy::SupportedAndGeneratedTargets().front()) {
        first = totals, first_brake = brake;
        brakes_seen += brakes;
      }
      EXPECT_EQ(totals.energy_m2, first.energy_m2);
      EXPECT_EQ(brake.j, first_brake.j);
      EXPECT_EQ(brake.onset, first_brake.onset);
    }
    use_vectors(0);
  }
  EXPECT_GT(rows_seen, 1000u);
  EXPECT_GT(brakes_seen, 30u);
}

// A corner that alone touches, and the same one while two thousand points of a slot are squeezed.
TEST(ContactForce, OfACornerIsNotChangedByWhatIsSqueezedElsewhere) {
  constexpr double kS = 0.005, kDtS = 0.001;
  const model::ContactLaw law{180'000, 6, 1, {}};
  model::ContactRow found[2];
  for (const bool slot : {false, true}) {
    std::mt19937_64 random(20261129);
    field::ContactSet set;
    set.reserve(2001);
    set.rx[0] = 0.02f, set.uz[0] = 1, set.depth_m[0] = 1e-4f, set.weight[0] = 0.3f;
    for (set.count = 1; set.count < (slot ? 2001u : 1u); ++set.count) {
      const std::uint32_t i = set.count;
      set.rx[i] = static_cast<float>(uniform(random, -0.03, 0.03));
      set.uy[i] = i % 2 == 0 ? 1.0f : -1.0f;
      set.depth_m[i] = static_cast<float>(0.3 * kS);
    }
    model::ContactRows rows;
    rows.reserve(set.count);
    model::add_contact_rows(set, law, kDtS, 0.5 * kS, rows);
    ASSERT_EQ(rows.size(), set.count);
    const model::ContactRowColumns end = rows.next();
    const auto back = static_cast<std::ptrdiff_t>(rows.size());
    found[slot] = {{},
                   end.at[model::ContactRowColumns::kWeight][-back],
                   end.at[model::ContactRowColumns::kOnset][-back]};
  }
  EXPECT_EQ(found[1].weight, found[0].weight);
  EXPECT_EQ(found[1].onset, found[0].onset);
  EXPECT_EQ(found[0].weight, kDtS * (kDtS * 180'000 + 6));  // in full, though its area is small
}

// At the solution the impulses balance: M (v - v0) = dt (coupling at v) + sum of contact impulses,
// with the clamp's secant at v itself.
// The impulse that is left over at the end of a step, over the largest in it.
double imbalance(const model::StepSystem& system, const std::vector<model::ContactRow>& rows,
                 const coupling::Vector6& v) {
  coupling::Symmetric6 matrix = system.inertia;
  coupling::Vector6 residual = system.momentum;
  add_coupling(system, v, matrix, residual);
  const coupling::Vector6 inner = matrix * v;
  double scale = 0, error = 0;
  for (const model::ContactRow& row : rows) {
    const double push = row.weight * std::max(0.0, row.onset - coupling::dot(row.j, v));
    for (int i = 0; i < 6; ++i) residual[i] += push * row.j[i];
  }
  for (int i = 0; i < 6; ++i) {
    const double unit = 1 / std::sqrt(system.inertia.lower[coupling::Symmetric6::at(i, i)]);
    error = std::max(error, std::abs(residual[i] - inner[i]) * unit);
    scale = std::max(scale, std::abs(inner[i]) * unit);
  }
  return error / scale;
}

// The secant of the clamp converges linearly: the iterations leave a few hundred-thousandths, at
// most 1.05e-4 was seen.
constexpr double kBalanced = 2e-4;

TEST(ContactSolver, BalancesImpulsesAtTheEndOfTheStep) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const model::StepSystem system = random_system(random);
    const std::vector<model::ContactRow> rows = random_rows(random);
    model::ContactRows columns = columns_of(rows);
    const coupling::Vector6 v = model::solve_velocity(system, columns, random_vector(random));
    EXPECT_LT(imbalance(system, rows, v), kBalanced);
  }
}

// A large flat part that touches its seat without depth: none of its rows pushes at rest, and all
// of them do at once, 1e5 times as hard as the part is heavy.
TEST(ContactSolver, APartThatTouchesWithAllItsPointsIsNotStuck) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    model::StepSystem system = random_system(random);
    system.momentum = {};
    system.displacement.displacement = {0.001, 0, -0.02};
    system.angle.displacement = {};
    system.arm_m = {};
    std::vector<model::ContactRow> rows(5000);
    const double weight = std::pow(10.0, uniform(random, -2, 0));
    for (model::ContactRow& row : rows) {
      const glm::dvec3 arm_m(uniform(random, -0.1, 0.1), uniform(random, -0.1, 0.1), -0.01);
      row.j = coupling::vector6({0, 0, 1}, glm::cross(arm_m, {0, 0, 1}));
      row.weight = weight;
    }
    model::ContactRows columns = columns_of(rows);
    const coupling::Vector6 v = model::solve_velocity(system, columns, {});
    EXPECT_GT(v[0], 1e-3);  // it slides
    EXPECT_LT(imbalance(system, rows, v), kBalanced);
  }
}

// The function that the solver minimises, for damping that is the same in all directions.
double energy_j(const model::StepSystem& system, const std::vector<model::ContactRow>& rows,
                const coupling::Vector6& v) {
  double sum = 0.5 * coupling::dot(v, system.inertia * v) - coupling::dot(v, system.momentum);
  const auto add_half = [&](const coupling::CouplingHalf& half,
                            const coupling::HalfStretch& stretch, const glm::dvec3& velocity) {
    const double slope = half.damping[0][0] + system.dt_s * half.stiffness;
    const double force = glm::length(half.stiffness * stretch.displacement +
                                     half.damping * stretch.target_velocity - slope * velocity);
    sum += system.dt_s / slope *
           (force <= half.limit ? 0.5 * force * force : half.limit * (force - 0.5 * half.limit));
  };
  const glm::dvec3 w = coupling::angular_part(v);
  add_half(system.translation, system.displacement,
           coupling::linear_part(v) + glm::cross(w, system.arm_m));
  add_half(system.rotation, system.angle, w);
  for (const model::ContactRow& row : rows) {
    const double short_of = std::max(0.0, row.onset - coupling::dot(row.j, v));
    sum += 0.5 * row.weight * short_of * short_of;
  }
  return sum;
}

// The solver written down without skill: every step judged by its energy, one row after the other,
// in extended precision, for ten times as many iterations.
using Wide6 = std::array<long double, 6>;

struct WideSystem {
  std::array<Wide6, 6> matrix{};
  Wide6 impulse{};
};

WideSystem wide_system(const model::StepSystem& system, const std::vector<model::ContactRow>& rows,
                       const Wide6& v) {
  coupling::Vector6 narrow;
  for (int i = 0; i < 6; ++i) narrow[i] = static_cast<double>(v[i]);
  coupling::Symmetric6 matrix = system.inertia;
  coupling::Vector6 impulse = system.momentum;
  add_coupling(system, narrow, matrix, impulse);
  WideSystem wide;
  for (int row = 0; row < 6; ++row) {
    wide.impulse[row] = impulse[row];
    for (int column = 0; column <= row; ++column) {
      wide.matrix[row][column] = wide.matrix[column][row] =
          matrix.lower[coupling::Symmetric6::at(row, column)];
    }
  }
  for (const model::ContactRow& row : rows) {
    long double speed = 0;
    for (int i = 0; i < 6; ++i) speed += row.j[i] * v[i];
    if (!(speed < row.onset)) continue;
    for (int i = 0; i < 6; ++i) {
      const long double scaled = static_cast<long double>(row.weight) * row.j[i];
      wide.impulse[i] += scaled * row.onset;
      for (int k = 0; k < 6; ++k) wide.matrix[i][k] += scaled * row.j[k];
    }
  }
  return wide;
}

Wide6 eliminated(WideSystem s) {
  for (int pivot = 0; pivot < 6; ++pivot) {
    for (int row = 0; row < 6; ++row) {
      if (row == pivot) continue;
      const long double factor = s.matrix[row][pivot] / s.matrix[pivot][pivot];
      for (int k = 0; k < 6; ++k) s.matrix[row][k] -= factor * s.matrix[pivot][k];
      s.impulse[row] -= factor * s.impulse[pivot];
    }
  }
  for (int i = 0; i < 6; ++i) s.impulse[i] /= s.matrix[i][i];
  return s.impulse;
}

// The function that the solver minimises, for damping that is the same in all directions.
long double energy_of(const model::StepSystem& system, const std::vector<model::ContactRow>& rows,
                      const Wide6& v) {
  long double sum = 0;
  for (int row = 0; row < 6; ++row) {
    sum -= v[row] * system.momentum[row];
    for (int column = 0; column < 6; ++column) {
      const int at = coupling::Symmetric6::at(std::max(row, column), std::min(row, column));
      sum += 0.5L * v[row] * system.inertia.lower[at] * v[column];
    }
  }
  const long double arm[] = {system.arm_m.x, system.arm_m.y, system.arm_m.z};
  const auto add_half = [&](const coupling::CouplingHalf& half,
                            const coupling::HalfStretch& stretch, int first) {
    const long double slope = half.damping[0][0] + system.dt_s * half.stiffness;
    long double square = 0;
    for (int i = 0; i < 3; ++i) {
      // The grip's velocity: v + w x arm.
      long double velocity = v[first + i];
      if (first == 0) {
        velocity += v[3 + (i + 1) % 3] * arm[(i + 2) % 3] - v[3 + (i + 2) % 3] * arm[(i + 1) % 3];
      }
      const long double force = half.stiffness * stretch.displacement[i] +
                                half.damping[0][0] * stretch.target_velocity[i] - slope * velocity;
      square += force * force;
    }
    const long double force = std::sqrt(square), limit = half.limit;
    sum += system.dt_s / slope * (force <= limit ? 0.5L * square : limit * (force - 0.5L * limit));
  };
  add_half(system.translation, system.displacement, 0);
  add_half(system.rotation, system.angle, 3);
  for (const model::ContactRow& row : rows) {
    long double short_of = row.onset;
    for (int i = 0; i < 6; ++i) short_of -= row.j[i] * v[i];
    if (short_of > 0) sum += 0.5L * row.weight * short_of * short_of;
  }
  return sum;
}

Wide6 wide_solution(const model::StepSystem& system, const std::vector<model::ContactRow>& rows,
                    const coupling::Vector6& guess) {
  Wide6 v{};
  std::copy(guess.begin(), guess.end(), v.begin());
  for (int iteration = 0; iteration < 120; ++iteration) {
    Wide6 next = eliminated(wide_system(system, rows, v));
    const long double before = energy_of(system, rows, v);
    for (int halving = 0; halving < 60 && energy_of(system, rows, next) > before; ++halving) {
      for (int i = 0; i < 6; ++i) next[i] = 0.5L * (v[i] + next[i]);
    }
    if (energy_of(system, rows, next) > before) break;
    v = next;
  }
  return v;
}

// Where the coupling is not clamped, the objective is quadratic piece by piece, and the iterations
// end at its very minimum: 1e-12 is rounding, in systems whose stiffest direction is 1e3 times its
// softest. Where rows come and go at every step they may be used up before (one seed of 200). The
// secant of a clamp converges linearly.
TEST(ContactSolver, IsThatOfExtendedPrecisionJudgedByEnergies) {
  int used_up = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    model::StepSystem system = random_system(random);
    const bool clamped = seed % 3 == 0;
    if (!clamped) system.translation.limit = system.rotation.limit = 1e9;
    const std::vector<model::ContactRow> rows = random_rows(random);
    model::ContactRows columns = columns_of(rows);
    const coupling::Vector6 guess = random_vector(random);
    const coupling::Vector6 v = model::solve_velocity(system, columns, guess);
    const Wide6 truth = wide_solution(system, rows, guess);
    double error = 0, size = 0;
    for (int i = 0; i < 6; ++i) {
      const double mass = system.inertia.lower[coupling::Symmetric6::at(i, i)];
      const auto off = static_cast<double>(v[i] - truth[i]);
      error += mass * off * off;
      size += mass * v[i] * v[i];
    }
    const double fraction = std::sqrt(error / size);
    if (!clamped && fraction > 1e-12) ++used_up;
    EXPECT_LT(fraction, 1e-4);
  }
  EXPECT_LE(used_up, 1);
}

TEST(ContactSolver, IsNeverWorseThanItsGuess) {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const model::StepSystem system = random_system(random);
    std::vector<model::ContactRow> rows = random_rows(random);
    model::ContactRows columns = columns_of(rows);
    // A guess beyond reason, and one that is the solution but for hard rows that come to it.
    coupling::Vector6 guess = random_vector(random);
    if (seed % 2 == 0) {
      guess = model::solve_velocity(system, columns, guess);
      for (int i = 0; i < 12; ++i) {
        model::ContactRow row;
        row.j = coupling::vector6(random_direction(random), random_direction(random) * 0.03);
        row.weight = std::pow(10.0, uniform(random, 0, 5));
        row.onset = coupling::dot(row.j, guess) - std::pow(10.0, uniform(random, -12, -2));
        rows.push_back(row);
      }
      columns = columns_of(rows);
    }
    const coupling::Vector6 v = model::solve_velocity(system, columns, guess);
    const double before_j = energy_j(system, rows, guess), after_j = energy_j(system, rows, v);
    EXPECT_TRUE(std::isfinite(after_j));
    // The sums' own rounding: terms of both signs, each a few times the larger one.
    EXPECT_LE(after_j, before_j + 1e-14 * (std::abs(before_j) + 1));
  }
}

TEST(RigidBody, KeepsAngularMomentumAndItsEnergyInBounds) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    model::PrincipalInertia inertia{glm::mat3_cast(random_orientation(random)), {}};
    for (int axis = 0; axis < 3; ++axis) inertia.moments[axis] = uniform(random, 1e-5, 4e-5);
    model::RigidMass mass{0.012, model::tensor_of(inertia), {}};
    mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
    Pose pose{{0, 0, 0}, random_orientation(random)};
    Twist velocity{{0, 0, 0}, random_direction(random) * 20.0};
    const glm::dvec3 momentum =
        model::turned(mass.inertia_kgm2, pose.orientation) * velocity.angular_radps;
    const double energy_j = model::kinetic_energy_j(mass, pose.orientation, velocity);
    double lowest = energy_j, highest = energy_j;
    for (int step = 0; step < 100000; ++step) {
      pose = model::advance(mass, pose, velocity, 1e-3);
      const double now = model::kinetic_energy_j(mass, pose.orientation, velocity);
      lowest = std::min(lowest, now);
      highest = std::max(highest, now);
    }
    const glm::dvec3 after =
        model::turned(mass.inertia_kgm2, pose.orientation) * velocity.angular_radps;
    // Rounding of 1e5 turns of the momentum into the body and back.
    EXPECT_LT(glm::length(after - momentum), 1e-9 * glm::length(momentum));
    // The midpoint rule swings by about the square of the angle per step (0.02), without drift.
    EXPECT_GT(lowest, 0.999 * energy_j);
    EXPECT_LT(highest, 1.001 * energy_j);
  }
}

// The guard's promise is about the rotation that is made: whatever the body's shape, it turns by no
// more than it may, and gains no energy by being held.
TEST(RigidBody, TurnsByNoMoreThanItMay) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    model::RigidMass mass{0.012, random_inertia(random), {}};
    mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
    const Pose pose{{0, 0, 0}, random_orientation(random)};
    const double asked_rad = std::pow(10.0, uniform(random, -3, 0));
    Twist velocity{{0, 0, 0}, random_direction(random) * (asked_rad / 1e-3)};
    const double energy_before_j = model::kinetic_energy_j(mass, pose.orientation, velocity);
    Twist free = velocity;
    const auto turned_rad = [&](const Pose& to) {
      return glm::length(
          coupling::rotation_vector(to.orientation * glm::conjugate(pose.orientation)));
    };
    const Pose unbounded = model::advance(mass, pose, free, 1e-3);
    const Pose bounded = model::advance(mass, pose, velocity, 1e-3, asked_rad);
    EXPECT_LE(turned_rad(bounded), asked_rad * (1 + 1e-9));
    if (bounded.orientation != unbounded.orientation) {
      ++held;
      EXPECT_GE(turned_rad(bounded), asked_rad * (1 - 1e-9));
      EXPECT_LE(model::kinetic_energy_j(mass, bounded.orientation, velocity),
                energy_before_j * (1 + 1e-9));
    } else {
      EXPECT_LE(turned_rad(unbounded), asked_rad * (1 + 1e-9));
    }
  }
  EXPECT_GT(held, 300);
}

// A needle spun far too fast for the step: momentum may be lost, energy is not gained.
TEST(RigidBody, ARotationTooFastForTheStepGainsNoEnergy) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    model::RigidMass mass{0.012, random_inertia(random), {}};
    mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
    Pose pose{{0, 0, 0}, random_orientation(random)};
    Twist velocity{{0, 0, 0}, random_direction(random) * std::pow(10.0, uniform(random, 1, 4))};
    const double energy_j = model::kinetic_energy_j(mass, pose.orientation, velocity);
    for (int step = 0; step < 5000; ++step) {
      pose = model::advance(mass, pose, velocity, 1e-3);
      ASSERT_LT(model::kinetic_energy_j(mass, pose.orientation, velocity), 1.5 * energy_j) << step;
    }
  }
}

// A quarter of the step, a sixteenth of the error: second order.
TEST(RigidBody, AsymmetricRotationIsOfSecondOrder) {
  model::RigidMass mass{0.012, glm::dmat3(0), {}};
  mass.inertia_kgm2[0][0] = 1e-5, mass.inertia_kgm2[1][1] = 2e-5, mass.inertia_kgm2[2][2] = 3e-5;
  mass.inverse_inertia_1pkgm2 = glm::inverse(mass.inertia_kgm2);
  const auto end = [&](int steps) {
    Pose pose;
    Twist velocity{{0, 0, 0}, {3, 10, 1}};
    for (int i = 0; i < steps; ++i) pose = model::advance(mass, pose, velocity, 0.5 / steps);
    return pose.orientation;
  };
  const glm::dquat truth = end(500000);
  const auto error = [&](int steps) {
    return glm::length(coupling::rotation_vector(end(steps) * glm::conjugate(truth)));
  };
  EXPECT_NEAR(std::log2(error(500) / error(2000)) / 2, 2, 0.1);
}

TEST(PrincipalInertia, TakesTensorsApartAndTogether) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::mt19937_64 random(seed);
    const glm::dmat3 tensor = random_inertia(random);
    const glm::dmat3 again = model::tensor_of(model::principal_inertia(tensor));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        EXPECT_NEAR(again[i][j], tensor[i][j], 1e-14 * 1e-3) << "seed " << seed;
  }
}

// Braking takes energy and never turns a velocity round, for any motion and any points.
TEST(Braking, OnlyRemovesEnergyAndNeverReverses) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    model::StepSystem system = random_system(random);
    system.translation = {1, glm::dmat3(0), 0};
    system.rotation = {1, glm::dmat3(0), 0};  // no coupling
    const coupling::Vector6 before = coupling::solve(system.inertia, system.momentum);
    field::ContactSet set;
    set.reserve(30);
    for (set.count = 0; set.count < 30; ++set.count) {
      const glm::vec3 arm_m(random_direction(random) * 0.03), push(random_direction(random));
      set.rx[set.count] = arm_m.x, set.ry[set.count] = arm_m.y, set.rz[set.count] = arm_m.z;
      set.ux[set.count] = push.x, set.uy[set.count] = push.y, set.uz[set.count] = push.z;
      set.depth_m[set.count] = static_cast<float>(-uniform(random, 0, 0.005));
    }
    model::ContactRow row;
    if (!model::braking_row(set, system.inertia, before, system.dt_s, row)) continue;
    model::ContactRows rows = columns_of({row});
    const coupling::Vector6 after = model::solve_velocity(system, rows, before);
    EXPECT_LE(coupling::dot(after, system.inertia * after),
              coupling::dot(before, system.inertia * before) * (1 + 1e-12));
    const double approach_before = -coupling::dot(row.j, before),
                 approach_after = -coupling::dot(row.j, after);
    EXPECT_LE(approach_after, approach_before * (1 + 1e-12));
    EXPECT_GE(approach_after, -1e-9 * approach_before);
  }
}

TEST(CouplingAngle, GoesOnPastHalfATurnAndFadesBeforeAWholeOne) {
  glm::dvec3 last(0);
  for (double angle = 0; angle < 1.99 * M_PI; angle += 0.01) {
    last = coupling::continuous_angle({1, 0, 0, 0}, coupling::rotation_by({0, 0, angle}), last);
    EXPECT_NEAR(last.z, angle, 1e-9);
  }
  EXPECT_EQ(coupling::torque_fraction(M_PI), 1);
  EXPECT_EQ(coupling::torque_fraction(2 * M_PI), 0);
  EXPECT_NEAR(coupling::faded_angle_rad(2 * M_PI), M_PI / 4,
              1e-12);  // half of the last quarter turn
}

TEST(Allowance, EndsAtZeroWhenTheHandRests) {
  const model::AllowanceLaw law{0.05, 0.01};
  double allowance_j = 0.05;
  int frames = 0;
  for (; allowance_j > 0 && frames < 10000; ++frames)
    allowance_j = model::faded_allowance_j(allowance_j, 0, law, 0.001);
  EXPECT_LT(frames, 300);  // ln(1e9) = 21 time constants
  EXPECT_LE(model::faded_allowance_j(0, 1e9, law, 0.001), law.limit_j);
}

// A stretch of the coupling from before a contact is not felt when the contact begins, nor later.
TEST(Passivity, EntryIsContinuousAndWhatIsHeldBackOnlyShrinks) {
  glm::dvec3 held(0.01, 0, 0);
  EXPECT_EQ(glm::length(coupling::felt_stretch({0.01, 0, 0}, held, 0.001)), 0);
  EXPECT_NEAR(coupling::felt_stretch({0.03, 0, 0}, held, 0.001).x, 0.02, 1e-5);
  EXPECT_NEAR(coupling::felt_stretch({0.004, 0, 0}, held, 0.001).x, 0, 1e-12);
  EXPECT_LE(held.x, 0.004);
  EXPECT_NEAR(coupling::felt_stretch({0.01, 0, 0}, held, 0.001).x, 0.006, 1e-5);
  EXPECT_NEAR(coupling::felt_stretch({-0.01, 0, 0}, held, 0.001).x, -0.01, 1e-12);
  EXPECT_EQ(held.x, 0);
}

// The controller's damper takes no more than what was given, never drives, keeps within its limit,
// follows the need within its time constant, and takes all where the hand moves fast enough for it.
TEST(Passivity, TheControllerTakesBackWhatWasGivenAndNoMore) {
  int fast_enough = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const double limit = uniform(random, 0.1, 5), radius_m = uniform(random, 0.01, 0.1);
    coupling::EpisodeEnergy energy;
    Twist v{random_direction(random) * uniform(random, 0, 1),
            random_direction(random) * uniform(random, 0, 10)};
    double last = 0;
    for (int frame = 0; frame < 200; ++frame) {
      if (frame % 50 == 0) coupling::add_given(energy, uniform(random, -1e-3, 1e-3));
      const double before_j = energy.given_j;
      const Wrench damper = coupling::passivity_damping(energy, v, radius_m, limit, 0.001);
      const double power_w =
          glm::dot(damper.force_n, v.linear_mps) + glm::dot(damper.torque_nm, v.angular_radps);
      EXPECT_LE(power_w, 0);
      EXPECT_LE(-power_w * 0.001, std::max(0.0, before_j) * (1 + 1e-12));
      EXPECT_LE(glm::length(damper.force_n), limit * glm::length(v.linear_mps) * (1 + 1e-12));
      EXPECT_LE(std::abs(energy.damping_ns_per_m - last), limit * 0.001 / 0.006 * (1 + 1e-12));
      last = energy.damping_ns_per_m;
      coupling::add_given(energy, power_w * 0.001);
    }
    // Four gifts of at most 1 mJ, 50 frames apart; the first 20 frames after each rise to the
    // need.
    const double speed2 = glm::dot(v.linear_mps, v.linear_mps) +
                          radius_m * radius_m * glm::dot(v.angular_radps, v.angular_radps);
    if (limit * speed2 * 0.03 < 1e-3) continue;
    ++fast_enough;
    EXPECT_LE(energy.given_j, 1e-6);
  }
  EXPECT_GT(fast_enough, 100);
}

// With the hand at rest, or before any energy was given, it does nothing.
TEST(Passivity, TheControllerRestsWithTheHand) {
  coupling::EpisodeEnergy energy;
  coupling::add_given(energy, -1);
  const Wrench none = coupling::passivity_damping(energy, {{1, 0, 0}, {0, 0, 0}}, 0.1, 2, 0.001);
  EXPECT_EQ(none.force_n, glm::dvec3(0));
  coupling::add_given(energy, 2);
  const Wrench still = coupling::passivity_damping(energy, {}, 0.1, 2, 0.001);
  EXPECT_EQ(still.force_n, glm::dvec3(0));
  EXPECT_EQ(still.torque_nm, glm::dvec3(0));
}

TEST(HandleVelocityEstimate, DoesNotSeeAJumpAndEndsAtZero) {
  loop::HandleVelocity estimate;
  Pose pose;
  for (int i = 0; i < 10; ++i) estimate.update(pose, 0.001);
  pose.position_m.x = 0.01;  // a centimetre in one tick
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(estimate.update(pose, 0.001).linear_mps, glm::dvec3(0)) << i;
  }
  for (int i = 0; i < 100; ++i) {
    pose.position_m.x += 1e-4;
    estimate.update(pose, 0.001);
  }
  Twist v;
  for (int i = 0; i < 200; ++i) v = estimate.update(pose, 0.001);
  EXPECT_EQ(v.linear_mps, glm::dvec3(0));
}

}  // namespace
}  // namespace forcelayer::test
