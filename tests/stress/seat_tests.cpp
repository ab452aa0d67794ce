// Parts that start installed: a hand that holds still, one that pushes at random, one that takes
// the part out, and one that puts it back. The solids are known as formulas, so depth is exact. A
// scene is turned at random against the grid. FORCELAYER_LONG_TESTS=1: two hundred pairs, ten
// seconds each.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <random>
#include <vector>

#include "forcelayer/run.h"
#include "runtime/coupling/coupling.h"
#include "runtime/model/simulation.h"
#include "runtime/run/derive_parameters.h"
#include "tests/stress/baked.h"
#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

constexpr double kDt = 0.001;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  glm::dvec3 vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  glm::dquat turn(double most_rad) {
    return coupling::rotation_by(glm::normalize(vector(1)) * uniform(0, most_rad));
  }

 private:
  std::mt19937_64 engine_;
};

Pose at(double x, double y, double z) { return {{x, y, z}, {1, 0, 0, 0}}; }

// A part where it is installed, in the pair's own frame: it comes out along +z.
struct Installed {
  const char* kind;
  mesh::Mesh scene, part;
  Pose pair_from_part;
  double removal_m;  // as far as it has to go to be clear of everything
  std::function<double(const glm::dvec3&)>
      depth_m;  // of a place in the solids; not above 0: outside
};

double box_depth_m(const glm::dvec3& p, const glm::dvec3& middle, const glm::dvec3& half) {
  const glm::dvec3 in = half - glm::abs(p - middle);
  return std::min({in.x, in.y, in.z});
}

double radius_of(const glm::dvec3& p) { return std::hypot(p.x, p.y); }

// Depth in a body of revolution: a cylinder of `outer` between two heights with a bore of `bore`.
double bored_depth_m(const glm::dvec3& p, double bore, double outer, double low, double high) {
  const double r = radius_of(p);
  return std::min({r - bore, outer - r, p.z - low, high - p.z});
}

// The pairs are made of features of three to thirty voxels: `unit` is half a voxel.
constexpr double kMm = 1e-3;
constexpr int kSegments = 48;  // flat to 0.2% of a radius

Installed block_on_slab(double unit, double gap, Random& random) {
  const glm::dvec3 half{random.uniform(10, 25) * unit, random.uniform(10, 25) * unit,
                        random.uniform(1, 15) * unit};
  Installed pair{"block on slab", {}, box(half), at(0, 0, half.z + gap), 40 * unit, {}};
  const glm::dvec3 slab{60 * unit, 60 * unit, 12 * unit};
  append(pair.scene, box(slab), at(0, 0, -slab.z));
  pair.depth_m = [slab](const glm::dvec3& p) { return box_depth_m(p, {0, 0, -slab.z}, slab); };
  return pair;
}

Installed bracket_on_sheet(double unit, double gap, Random& random) {
  const double a = random.uniform(20, 40) * unit, t = random.uniform(3, 8) * unit;
  Installed pair{"bracket on sheet",
                 sheet(60 * unit, 60 * unit),
                 prism({{0, 0}, {a, 0}, {a, t}, {t, t}, {t, a}, {0, a}}, 15 * unit),
                 at(-a / 2, 0, gap),
                 40 * unit,
                 {}};
  // What is below the sheet has gone through it.
  pair.depth_m = [unit](const glm::dvec3& p) {
    return std::max(std::abs(p.x), std::abs(p.y)) < 60 * unit ? -p.z : -1;
  };
  return pair;
}

Installed pin_in_blind_hole(double unit, double gap, Random& random) {
  const double bore = random.uniform(6, 15) * unit, deep = random.uniform(10, 30) * unit;
  const double outer = 40 * unit, low = -deep - 15 * unit;
  Installed pair{
      "pin in blind hole",
      revolved({{0, low}, {outer, low}, {outer, 0}, {bore, 0}, {bore, -deep}, {0, -deep}},
               kSegments),
      cylinder(bore - gap, deep, kSegments),
      at(0, 0, gap),
      deep + 25 * unit,
      {}};
  pair.depth_m = [=](const glm::dvec3& p) {
    const double r = radius_of(p);
    const double to_hole = std::hypot(std::max(r - bore, 0.0), std::max(-deep - p.z, 0.0));
    return std::min({outer - r, p.z - low, -p.z, r < bore && p.z > -deep ? -1.0 : to_hole});
  };
  return pair;
}

Installed pin_in_through_hole(double unit, double gap, Random& random) {
  const double bore = random.uniform(5, 15) * unit, half = random.uniform(5, 15) * unit;
  Installed pair{"pin in through hole",
                 tube(bore, 40 * unit, half, kSegments),
                 cylinder(bore - gap, half + 10 * unit, kSegments),
                 at(0, 0, 0),
                 2 * half + 40 * unit,
                 {}};
  pair.depth_m = [=](const glm::dvec3& p) {
    return bored_depth_m(p, bore, 40 * unit, -half, half);
  };
  return pair;
}

Installed ring_on_shaft(double unit, double gap, Random& random) {
  const double shaft = random.uniform(5, 15) * unit, half = 25 * unit;
  Installed pair{"ring on shaft",
                 cylinder(shaft, half, kSegments),
                 tube(shaft + gap, shaft + gap + 8 * unit, random.uniform(3, 8) * unit, kSegments),
                 at(0, 0, random.uniform(-10, 10) * unit),
                 half + 45 * unit,
                 {}};
  pair.depth_m = [=](const glm::dvec3& p) {
    return std::min(shaft - radius_of(p), half - std::abs(p.z));
  };
  return pair;
}

Installed cover_on_box(double unit, double gap, Random& random) {
  const double post = random.uniform(12, 25) * unit, rim = random.uniform(8, 20) * unit;
  const double wall = random.uniform(2, 6) * unit, inner = post + gap;
  Installed pair{"cover on box",
                 {},
                 revolved({{inner, -rim},
                           {inner + wall, -rim},
                           {inner + wall, wall},
                           {0, wall},
                           {0, 0},
                           {inner, 0}},
                          kSegments),
                 at(0, 0, gap),
                 rim + 30 * unit,
                 {}};
  append(pair.scene, cylinder(post, 20 * unit, kSegments), at(0, 0, -20 * unit));
  pair.depth_m = [=](const glm::dvec3& p) {
    return std::min({post - radius_of(p), -p.z, p.z + 40 * unit});
  };
  return pair;
}

Installed bolt_through_plates(double unit, double gap, Random& random) {
  const double bore = random.uniform(5, 10) * unit, shank = bore - gap, head = bore + 6 * unit;
  Installed pair{"bolt through plates",
                 {},
                 revolved({{0, -36 * unit},
                           {shank, -36 * unit},
                           {shank, 0},
                           {head, 0},
                           {head, 8 * unit},
                           {0, 8 * unit}},
                          kSegments),
                 at(0, 0, gap),
                 70 * unit,
                 {}};
  append(pair.scene, tube(bore, 35 * unit, 6 * unit, kSegments), at(0, 0, -6 * unit));
  append(pair.scene, tube(bore, 35 * unit, 6 * unit, kSegments), at(0, 0, -24 * unit));
  pair.depth_m = [=](const glm::dvec3& p) {
    return std::max(bored_depth_m(p, bore, 35 * unit, -12 * unit, 0),
                    bored_depth_m(p, bore, 35 * unit, -30 * unit, -18 * unit));
  };
  return pair;
}

constexpr std::array kMakers = {block_on_slab,       bracket_on_sheet, pin_in_blind_hole,
                                pin_in_through_hole, ring_on_shaft,    cover_on_box,
                                bolt_through_plates};

mesh::Mesh moved(const mesh::Mesh& mesh, const Pose& pose) {
  mesh::Mesh result;
  append(result, mesh, pose);
  return result;
}

// A pair in its place in the world, baked, with the part in a prescribed hand.
class SeatTrial {
 public:
  SeatTrial(const Installed& pair, const Pose& world_from_pair, double voxel_size_m)
      : pair_(pair),
        voxel_size_m_(voxel_size_m),
        world_from_pair_(world_from_pair),
        start_(world_from_pair * pair.pair_from_part) {
    const BakedScene scene(moved(pair.scene, world_from_pair), voxel_size_m);
    const BakedPart part(pair.part, voxel_size_m);
    RunRequest request;
    request.without_guarantee = true;
    auto run = open_run(scene.open(test::VoxelKind::kFull), part.open(), request);
    if (!run) throw std::runtime_error(to_line(run.error()));
    simulation_ = run->release_simulation();
    const PshellView& shell = simulation_->shell().view();
    for (std::uint64_t i = 0; i < shell.point_count; ++i) {
      points_.push_back(glm::dvec3(shell.x[i], shell.y[i], shell.z[i]));
    }
  }

  // Takes hold where the part is installed. False: the start is refused.
  Status begin() {
    PartStart start;
    start.world_from_part = start_;
    auto begun = simulation_->begin(start, start_);
    if (!begun) return begun.error();
    state_ = *begun;
    input_ = {};
    input_.world_from_handle = start_;
    input_.valid = kInputValid;
    return {};
  }

  StepResult step_to(const Pose& handle) {
    const Pose& last = input_.world_from_handle;
    input_.handle_velocity = {
        (handle.position_m - last.position_m) / kDt,
        coupling::rotation_vector(handle.orientation * glm::conjugate(last.orientation)) / kDt};
    input_.world_from_handle = handle;
    return simulation_->step(state_, input_, kDt);
  }

  // Of the deepest shell point, m; negative: outside.
  double depth_m() const {
    const Pose pair_from_center = inverse(world_from_pair_) * state_.world_from_center;
    double deepest = -1;
    for (const glm::dvec3& p : points_) {
      deepest = std::max(
          deepest, pair_.depth_m(pair_from_center.position_m + pair_from_center.orientation * p));
    }
    return deepest;
  }

  // The farthest that a shell point is from where it is installed, m.
  double moved_m() const {
    const Pose now = simulation_->world_from_part(state_.world_from_center);
    const Pose from_start = now * inverse(start_);
    const glm::dvec3 center = simulation_->world_from_center(start_).position_m;
    const glm::dvec3 there = from_start.position_m + from_start.orientation * center;
    return glm::length(there - center) +
           glm::length(coupling::rotation_vector(from_start.orientation)) *
               simulation_->shell().header().bounding_radius_m;
  }

  glm::dvec3 out() const { return world_from_pair_.orientation * glm::dvec3(0, 0, 1); }
  double way_out_m() const {
    return glm::dot(
        state_.world_from_center.position_m - simulation_->world_from_center(start_).position_m,
        out());
  }
  const Pose& start() const { return start_; }
  const State& state() const { return state_; }
  double voxel_size_m() const { return voxel_size_m_; }
  const model::Simulation& simulation() const { return *simulation_; }

 private:
  const Installed& pair_;
  double voxel_size_m_;
  Pose world_from_pair_, start_;
  std::unique_ptr<model::Simulation> simulation_;
  std::vector<glm::dvec3> points_;  // from the centroid, part axes
  State state_;
  StepInput input_;
};

struct SeatOutcome {
  int pairs = 0, refused = 0, came_out = 0, went_back = 0, tried_back = 0, deep = 0;
  double drift = 0, still_force_n = 0, depth = 0;  // largest; voxels
};

// The handle's way at random about where the part is installed.
Pose wandering(const Pose& start, double time_s, const std::array<glm::dvec3, 4>& phases) {
  const auto wave = [&](int n, double hz) {
    const glm::dvec3 turns = 2 * M_PI * (hz * time_s + phases[static_cast<std::size_t>(n)]);
    return glm::dvec3(std::sin(turns.x), std::sin(1.3 * turns.y), std::sin(0.7 * turns.z)) -
           glm::dvec3(std::sin(2 * M_PI * phases[static_cast<std::size_t>(n)].x),
                      std::sin(1.3 * 2 * M_PI * phases[static_cast<std::size_t>(n)].y),
                      std::sin(0.7 * 2 * M_PI * phases[static_cast<std::size_t>(n)].z));
  };
  const double ramp = std::min(1.0, time_s);
  return {
      start.position_m + ramp * 0.008 * (wave(0, 0.5) + 0.4 * wave(1, 2.1)),
      coupling::rotation_by(ramp * 0.15 * (wave(2, 0.4) + 0.4 * wave(3, 1.7))) * start.orientation};
}

void hold_still(SeatTrial& trial, SeatOutcome& outcome) {
  ASSERT_TRUE(trial.begin());
  for (int i = 0; i < 500; ++i) {
    const StepResult result = trial.step_to(trial.start());
    outcome.still_force_n = std::max(outcome.still_force_n, glm::length(result.wrench.force_n));
  }
  const double drift = trial.moved_m() / trial.voxel_size_m();
  EXPECT_LT(drift, 0.2);
  outcome.drift = std::max(outcome.drift, drift);
}

void push_at_random(SeatTrial& trial, Random& random, double seconds, SeatOutcome& outcome) {
  ASSERT_TRUE(trial.begin());
  const double at_start_m = std::max(0.0, trial.depth_m());
  std::array<glm::dvec3, 4> phases;
  for (glm::dvec3& phase : phases) phase = random.vector(1);
  double deepest_m = 0;
  for (int i = 0; i < static_cast<int>(seconds / kDt); ++i) {
    trial.step_to(wandering(trial.start(), i * kDt, phases));
    if (i % 10 == 0) deepest_m = std::max(deepest_m, trial.depth_m());
  }
  const double depth = (deepest_m - at_start_m) / trial.voxel_size_m();
  // 0.6 but in bores with less play than interpolation is off in the corner at their bottom.
  EXPECT_LT(depth, 0.7);
  outcome.deep += depth > 0.6;
  outcome.depth = std::max(outcome.depth, depth);
}

void take_out(SeatTrial& trial, double way_m, SeatOutcome& outcome) {
  ASSERT_TRUE(trial.begin());
  constexpr double kSpeed = 0.03;
  const int frames = static_cast<int>(way_m / kSpeed / kDt);
  for (int i = 0; i <= frames + 500; ++i) {
    Pose handle = trial.start();
    handle.position_m += std::min(i, frames) * kDt * kSpeed * trial.out();
    trial.step_to(handle);
  }
  const bool is_out =
      trial.way_out_m() > way_m - 0.5 * trial.voxel_size_m() && trial.state().seat == kSeatClosed;
  EXPECT_TRUE(is_out) << "went " << trial.way_out_m() << " of " << way_m << " m, seat "
                      << trial.state().seat;
  outcome.came_out += is_out;
}

// Half of the force layer out, and back: the seat is open all the while.
void put_back(SeatTrial& trial, SeatOutcome& outcome) {
  ASSERT_TRUE(trial.begin());
  const double way_m = 1.5 * trial.voxel_size_m();
  constexpr int kFrames = 1000;
  for (int i = 0; i <= 2 * kFrames + 500; ++i) {
    Pose handle = trial.start();
    const double share = i < kFrames ? i / double{kFrames} : 2 - i / double{kFrames};
    handle.position_m += std::max(0.0, share) * way_m * trial.out();
    trial.step_to(handle);
    if (trial.state().seat == kSeatClosed) return;
  }
  ++outcome.tried_back;
  const bool is_back = trial.moved_m() < 0.3 * trial.voxel_size_m();
  EXPECT_TRUE(is_back) << trial.moved_m();
  outcome.went_back += is_back;
}

TEST(Seat, InstalledPartsRestAreHeldAndComeOut) {
  const bool is_long = std::getenv("FORCELAYER_LONG_TESTS") != nullptr;
  const int pairs = is_long ? 203 : 14;
  std::map<std::string, SeatOutcome> outcomes;
  for (int seed = 0; seed < pairs; ++seed) {
    Random random(static_cast<std::uint64_t>(seed) + 1);
    const double voxel_size_m = random.uniform(1, 5) * kMm;
    const double gap_m = random.uniform(0, 1) * kMm;
    const Installed pair =
        kMakers[static_cast<std::size_t>(seed) % kMakers.size()](0.5 * voxel_size_m, gap_m, random);
    const Pose world_from_pair{random.vector(0.1), random.turn(3)};
    SCOPED_TRACE(::testing::Message()
                 << "seed " << seed << ", " << pair.kind << ", voxels of " << voxel_size_m * 1000
                 << " mm, gap " << gap_m * 1000 << " mm");
    SeatOutcome& outcome = outcomes[pair.kind];
    ++outcome.pairs;
    SeatTrial trial(pair, world_from_pair, voxel_size_m);
    if (const Status begun = trial.begin(); !begun) {
      std::printf("seed %d refused: %s\n", seed, to_line(begun.error()).c_str());
      ++outcome.refused;
      continue;
    }
    hold_still(trial, outcome);
    push_at_random(trial, random, is_long ? 10 : 2, outcome);
    take_out(trial, pair.removal_m, outcome);
    put_back(trial, outcome);
  }
  std::printf("%-20s %5s %7s %8s %9s %8s %9s %9s\n", "pair", "pairs", "refused", "drift",
              "still, N", "depth", "came out", "went back");
  for (const auto& [kind, o] : outcomes) {
    std::printf("%-20s %5d %7d %8.3f %9.3f %8.3f %6d %9d %5d/%d\n", kind.c_str(), o.pairs,
                o.refused, o.drift, o.still_force_n, o.depth, o.deep, o.came_out, o.went_back,
                o.tried_back);
  }
}

}  // namespace
}  // namespace forcelayer::stress
