// The objects that a frame names, against a twin that asks for every contact; and what the
// statistics of a run keep of them and of the seat.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "runtime/loop/loop_statistics.h"
#include "runtime/model/touched_objects.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.001;  // voxel size, m

// Objects in slabs along x; the last of them has none.
class Slabs final : public field::ContactProbe {
 public:
  explicit Slabs(double width_m) : width_m_(width_m) {}
  void query_pose(const Pose&, field::ContactSet&) noexcept override {}
  std::uint32_t object_near(const glm::dvec3& world_m) const noexcept override {
    ++asked;
    return of(world_m);
  }
  std::uint32_t of(const glm::dvec3& world_m) const {
    const auto slab = static_cast<std::uint32_t>(std::max(0.0, world_m.x / width_m_));
    return slab < 6 ? slab + 1 : 0;
  }
  mutable std::uint32_t asked = 0;

 private:
  double width_m_;
};

// Contacts in the shell's order, which keeps neighbors together; about half of them have depth.
void fill(field::ContactSet& set, std::uint32_t count, std::mt19937_64& random) {
  std::uniform_real_distribution<float> unit(0, 1);
  set.reserve(count);
  set.count = count;
  set.seat_open = true;
  for (std::uint32_t i = 0; i < count; ++i) {
    set.rx[i] = 0.1f * static_cast<float>(i) / static_cast<float>(count);
    set.ry[i] = unit(random), set.rz[i] = unit(random);
    const glm::vec3 u = glm::normalize(glm::vec3(unit(random), unit(random), 1));
    set.ux[i] = u.x, set.uy[i] = u.y, set.uz[i] = u.z;
    set.depth_m[i] = static_cast<float>(kS) * (unit(random) - 0.5f);
    set.weight[i] = 0.5f + unit(random);
    set.point[i] = i;
    set.is_barred[i] = 0;
    set.of_seat[i] = unit(random) < 0.3f ? 1 : 0;
  }
}

TEST(TouchedObjects, AreThoseOfTheTwin) {
  const std::uint64_t seed = 20261124;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  const model::ContactLaw law{1000, 1, 1, {}};
  for (const std::uint32_t count : {0u, 1u, 7u, 400u, 401u, 4000u, 4001u}) {
    field::ContactSet set;
    fill(set, count, random);
    const Slabs slabs(0.1 / 6.5);
    const model::ContactTotals totals = model::contact_totals(set, law);
    // In every other set the guard keeps the part out of an object.
    const model::StoppedBy stop{count % 2 == 1 ? 3u : 0u, {2, -7, -30}};
    StepReport report;
    model::report_touched(set, totals, {&law, 1}, slabs, stop, report);
    EXPECT_LE(slabs.asked, model::kAskedContacts) << count;

    std::map<std::uint32_t, glm::dvec3> forces;
    double all_n = 0;
    glm::dvec3 left_n = stop.pull_n;
    std::uint32_t of_seat = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const field::Contact c = set[i];
      if (!(c.depth_m > 0)) continue;
      of_seat += set.of_seat[i];
      const double force_n = law.stiffness_n_per_m * law.areas_of(c) * double{c.depth_m};
      all_n = std::max(all_n, force_n);
      left_n += force_n * glm::dvec3(c.direction);
      const std::uint32_t object = slabs.of(glm::dvec3(c.arm_m));
      if (object == 0) continue;
      auto& sum = forces.try_emplace(object, glm::dvec3(0)).first->second;
      sum += force_n * glm::dvec3(c.direction);
    }
    if (stop.object != 0) forces.try_emplace(stop.object, glm::dvec3(0)).first->second -= left_n;
    EXPECT_EQ(report.seat_contacts, of_seat) << count;
    // A run lies on two objects at most; its other contacts go to the wrong one.
    const double run = std::ceil(totals.count / double{model::kAskedContacts});
    const double off_n = 1e-6 + 2 * (run - 1) * all_n;  // 1e-6: forces are kept as floats
    std::vector<double> strongest;
    for (const auto& [object, force_n] : forces) strongest.push_back(glm::length(force_n));
    std::sort(strongest.rbegin(), strongest.rend());
    for (std::size_t i = 0; i < report.touched.size(); ++i) {
      const TouchedObject& touched = report.touched[i];
      if (i >= strongest.size()) {
        EXPECT_EQ(touched.object, 0u) << count;
        continue;
      }
      ASSERT_TRUE(forces.count(touched.object)) << count << " " << touched.object;
      EXPECT_NEAR(double{touched.force_n}, glm::length(forces[touched.object]), off_n) << count;
      EXPECT_NEAR(double{touched.force_n}, strongest[i], off_n) << count;
    }
  }
}

TEST(TouchedObjects, OfARunAreCountedToTheLastThatFits) {
  loop::TouchedObjects touched;
  for (std::uint32_t n = 1; n <= loop::TouchedObjects::kKept + 3; ++n) touched.add({n, 1});
  touched.add({7, 5});
  touched.add({7, 2});
  EXPECT_EQ(touched.totals().size(), loop::TouchedObjects::kKept);
  EXPECT_EQ(touched.left_out(), 3u);
  EXPECT_EQ(touched.totals()[6].object, 7u);
  EXPECT_EQ(touched.totals()[6].frames, 3u);
  EXPECT_EQ(touched.totals()[6].max_force_n, 5);
}

// The guarantee begins where the seat closes, and anew where another opens and closes.
TEST(LoopStatistics, KnowsSinceWhenTheGuaranteeHolds) {
  loop::LoopStatistics s;
  Frame frame;
  const auto count = [&](double time_s, std::uint32_t seat_open, std::uint32_t seated,
                         std::uint32_t contacts, std::uint32_t seat_contacts) {
    frame.time_s = time_s;
    StepReport& report = frame.result.report;
    report.seat_open = seat_open;
    report.seated = seated;
    report.contacts = contacts;
    report.seat_contacts = seat_contacts;
    s.count(frame);
  };
  count(0.001, 1, 9, 4, 4);
  count(0.002, 1, 9, 0, 0);
  EXPECT_FALSE(s.guarantee_from_s);
  EXPECT_FALSE(s.first_contact);
  EXPECT_EQ(s.seated_frames, 2u);
  count(0.003, 0, 0, 0, 0);
  count(0.004, 0, 0, 0, 0);
  EXPECT_EQ(s.guarantee_from_s, 0.003);
  count(0.005, 1, 1, 5, 4);
  EXPECT_FALSE(s.guarantee_from_s);
  ASSERT_TRUE(s.first_contact);
  EXPECT_EQ(s.first_contact->time_s, 0.005);
  count(0.006, 0, 0, 1, 0);
  EXPECT_EQ(s.guarantee_from_s, 0.006);
  EXPECT_EQ(s.first_contact->time_s, 0.005);
  EXPECT_EQ(s.seated_frames, 3u);
  EXPECT_FALSE(s.first_penetration);
}

}  // namespace
}  // namespace forcelayer::test
