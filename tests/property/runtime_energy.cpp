// Energy that the scene gives to the hand, in random soaks with the default parameters. Work at the
// port is counted as the report counts it, and less what the device's own damping takes from the
// hand meanwhile: it is declared, and the stiffness is derived from it. What is left is all that a
// hand could be given.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "tests/support/grip_map.h"
#include "tests/support/sanitized.h"

namespace forcelayer::test {
namespace {

constexpr double kS = kPlaneVoxelM, kDt = 0.001;

// By contact episode: the peak of the work, and that of the work less the device's damping.
class Episodes {
 public:
  void see(HeldPart& held) {
    const StepReport& report = held.frame().result.report;
    const DeviceCapabilities& device = held.device().capabilities();
    const PortWork& work = held.work();
    const double net_j = work.given_j - device.damping_ns_per_m * work.speed2_s -
                         device.damping_nms_per_rad * work.turning2_s;
    peak_j_ = std::max(peak_j_, work.given_j);
    net_peak_j = std::max(net_peak_j, net_j);
    fastest_mps_ = std::max(fastest_mps_, speed_mps(held.frame()));
    if (report.interior + report.surface + report.proximity > 0) return;
    worst_j = std::max(worst_j, peak_j_);
    peak_j_ = 0;
    held.work() = {};
    held.work().see(held.device().pose(), held.frame().device_wrench, kDt);
  }

  double worst_j = 0, net_peak_j = 0;
  double fastest_mps() const { return fastest_mps_; }

 private:
  double speed_mps(const Frame& frame) {
    const glm::dvec3 at_m = frame.input.world_from_handle.position_m;
    const double speed = last_m_ ? glm::length(at_m - *last_m_) / kDt : 0;
    last_m_ = at_m;
    return speed;
  }

  std::optional<glm::dvec3> last_m_;
  double peak_j_ = 0, fastest_mps_ = 0;
};

// A floor, a wall and a low step, the block above them. They go on beyond every place to which a
// loose hand flies: a solid that the map's edge cuts has no force layer on the cut, and a part that
// comes back there stops dead.
VoxelScene corner() {
  return distance_scene(
      kS, {-40, -40, -14}, {80, 112, 60},
      [](const glm::dvec3& p) {
        const double step = std::max(p.z - 5.3 * kS, 12.6 * kS - p.y);
        return std::min({p.z - 0.3 * kS, 30.6 * kS - p.x, step});
      },
      2, DistanceDefinition(2));
}

HeldPartOptions above_the_corner(int hand) {
  HeldPartOptions options;
  options.start.position_m = glm::dvec3(0, 0, 22) * kS;
  if (hand == 1) options.hand = devices::SimHandParameters{};
  if (hand == 2) options.hand = devices::loose_grip();
  return options;
}

struct Soak {
  Episodes episodes;
  double generated_j = 0, kinetic_j = 0;  // the latter of the apparent mass at the fastest speed
};

// Two seconds of a hand that goes from place to place at random, prescribed, firm or loose.
Soak soak(std::uint64_t seed) {
  Random random(seed);
  HeldPart held(corner(), block(), above_the_corner(static_cast<int>(seed % 3)));
  const Pose start = held.start_handle();
  for (int i = 0; i < 300; ++i) held.tick(start);
  Soak out;
  const double fastest_mps = std::array{0.3, 1.0, 2.0, 4.0}[seed / 3 % 4];
  Pose from = start, to = start;
  int left = 0, frames = 1;
  for (int i = 0; i < 2000; ++i) {
    if (left == 0) {
      from = to;
      const glm::dvec3 way_m{uniform(random, -0.1, 0.2), uniform(random, -0.1, 0.2),
                             uniform(random, -0.11, 0.02)};
      to = {start.position_m + way_m,
            coupling::rotation_by(random_direction(random) * uniform(random, 0, 0.6)) *
                start.orientation};
      const double speed_mps = fastest_mps * uniform(random, 0.2, 1);
      const double length_m = glm::length(to.position_m - from.position_m);
      left = frames = 1 + static_cast<int>(length_m / (speed_mps * kDt));
    }
    --left;
    const double fraction = 1 - static_cast<double>(left) / frames;
    held.tick({from.position_m + fraction * (to.position_m - from.position_m),
               glm::normalize(glm::slerp(from.orientation, to.orientation, fraction))});
    out.episodes.see(held);
  }
  const double fastest = out.episodes.fastest_mps();
  out.kinetic_j = 0.5 * held.parameters().mass_kg * fastest * fastest;
  out.generated_j = held.frame().generated_j;
  return out;
}

// Up to 115 mJ in an episode are generated here at 4 m/s, and none of it is left to the hand. It is
// kinetic energy of the part's apparent mass (12 g), which the hand did not feel in free space and
// brakes near a surface. The 115 mJ are of seed 9, where the moving mass has 95 mJ without its
// turn: the rest is not explained.
TEST(Energy, WhatASoakGeneratesTheDevicesDampingTakes) {
  double generated_j = 0;
  for (std::uint64_t seed = kSanitized ? 21 : 1; seed <= (kSanitized ? 23 : 24); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Soak out = soak(seed);
    EXPECT_LT(out.episodes.net_peak_j, 1e-6);
    EXPECT_LE(out.episodes.worst_j, 2 * out.kinetic_j + 1e-4);
    generated_j += out.generated_j;
  }
  EXPECT_GT(generated_j, 0.001);
}

// Frames of several motions, whose first ones pulled to where the hand is at the end of the frame,
// generated 30, 83, 121 and 25 mJ in these soaks of loose hands.
TEST(Energy, FramesOfSeveralMotionsGenerateLittle) {
  double generated_j = 0;
  for (const std::uint64_t seed : {32, 92, 107, 119}) generated_j += soak(seed).generated_j;
  EXPECT_LT(generated_j, 0.05);
}

// In free space the part follows a hand that moves evenly, and never runs ahead of it, however many
// motions a frame takes: it would have kinetic energy that the hand never gave it.
TEST(Energy, ThePartNeverRunsAheadOfTheHand) {
  for (const double speed_mps : {2.8, 3.6}) {  // two motions in a frame
    SCOPED_TRACE(testing::Message() << speed_mps << " m/s");
    HeldPartOptions options = above_the_corner(0);
    options.start.position_m = glm::dvec3(20, 0, 30) * kS;
    HeldPart held(corner(), block(), options);
    const Pose start = held.start_handle();
    for (int i = 0; i < 300; ++i) held.tick(start);
    Pose hand = start;
    for (int i = 1; i <= 60; ++i) {
      hand.position_m = start.position_m - glm::dvec3(speed_mps * kDt * i, 0, 0);
      const glm::dvec3 part_m = held.tick(hand).result.report.world_from_center.position_m;
      EXPECT_LT(options.start.position_m.x - part_m.x, speed_mps * kDt * i) << "frame " << i;
    }
  }
}

}  // namespace
}  // namespace forcelayer::test
