#include "tests/stress/cases.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <random>
#include <stdexcept>

#include "runtime/coupling/coupling.h"
#include "tests/stress/collisions.h"
#include "tests/stress/shapes.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::stress {
namespace {

constexpr double kS = 0.005;  // voxel size of most cases, m (paper 6.3)

using test::Random;
using test::random_direction;
using test::uniform;

int choice(Random& random, int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); }

glm::dquat random_turn(Random& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return glm::normalize(glm::dquat(w, x, y, z));
}

Pose at(const glm::dvec3& position_m) { return {position_m, {1, 0, 0, 0}}; }

// A frame of the scene in the world: any orientation, and an origin that is nowhere in particular
// on the lattice.
Pose random_frame(Random& random) {
  const glm::dvec3 origin(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  return {origin, random_turn(random)};
}

mesh::Mesh moved(const mesh::Mesh& mesh, const Pose& pose) {
  mesh::Mesh result;
  append(result, mesh, pose);
  return result;
}

std::shared_ptr<const BakedScene> scene_of(const mesh::Mesh& mesh, const Pose& frame,
                                           double s = kS) {
  return std::make_shared<BakedScene>(moved(mesh, frame), s);
}

// Parts are baked once for each shape and voxel size.
std::shared_ptr<const BakedPart> part_of(const std::string& name, const mesh::Mesh& mesh,
                                         double s = kS) {
  static std::map<std::pair<std::string, double>, std::shared_ptr<const BakedPart>> parts;
  auto& part = parts[{name, s}];
  if (!part) part = std::make_shared<BakedPart>(mesh, s);
  return part;
}

std::shared_ptr<const BakedPart> ball(double radius_voxels = 4, double s = kS) {
  return part_of("ball" + std::to_string(radius_voxels), sphere(radius_voxels * s, 24), s);
}
std::shared_ptr<const BakedPart> block(double s = kS) {
  return part_of("block", box(glm::dvec3(4, 3, 2) * s), s);
}
std::shared_ptr<const BakedPart> bar(double s = kS) {
  return part_of("bar", box(glm::dvec3(10, 1.2, 1.2) * s), s);
}

std::shared_ptr<const BakedPart> some_part(Random& random, double s = kS) {
  switch (choice(random, 3)) {
    case 0:
      return ball(4, s);
    case 1:
      return block(s);
    default:
      return bar(s);
  }
}

// From one pose to another between two times, still before and after.
Pose glide(const Pose& a, const Pose& b, double from_s, double to_s, double t_s) {
  const double fraction = std::clamp((t_s - from_s) / (to_s - from_s), 0.0, 1.0);
  return {glm::mix(a.position_m, b.position_m, fraction),
          glm::slerp(a.orientation, b.orientation, fraction)};
}

// Plane through the frame's origin, free above (z > 0).
mesh::Mesh slab(double half_m, double thickness_m) {
  return moved(box({half_m, half_m, thickness_m / 2}), at({0, 0, -thickness_m / 2}));
}

// A valley along y with walls at `half_angle` from the vertical plane x = 0, its line at the
// origin.
mesh::Mesh valley(double half_angle, double size_m) {
  const double x = size_m * std::sin(half_angle), z = size_m * std::cos(half_angle);
  mesh::Mesh mesh;
  // Each wall is a wedge of solid beside the valley.
  append(
      mesh,
      prism({{0, 0}, {0, -size_m / 4}, {x + size_m / 3, -size_m / 4}, {x + size_m / 3, z}, {x, z}},
            size_m));
  append(
      mesh,
      prism(
          {{0, 0}, {-x, z}, {-x - size_m / 3, z}, {-x - size_m / 3, -size_m / 4}, {0, -size_m / 4}},
          size_m));
  return mesh;
}

// A conical pit about z, its tip at the origin.
mesh::Mesh pit(double half_angle, double size_m) {
  const double r = size_m * std::sin(half_angle), z = size_m * std::cos(half_angle);
  return revolved(
      {{0, 0}, {0, -size_m / 4}, {r + size_m / 3, -size_m / 4}, {r + size_m / 3, z}, {r, z}}, 48);
}

// Stairs along x: treads and risers of `step_m`, on a solid.
mesh::Mesh stairs(double step_m, int steps, double half_width_m) {
  mesh::Mesh mesh;
  for (int i = 0; i < steps; ++i) {
    const double x = (i - steps / 2.0) * step_m, top = (i - steps / 2) * step_m;
    const double bottom = -(steps / 2 + 3) * step_m;
    append(mesh, box({step_m / 2 + 1e-6, half_width_m, (top - bottom) / 2}),
           at({x, 0, (top + bottom) / 2}));
  }
  return mesh;
}

Trial basic(Random& random, const mesh::Mesh& mesh, const std::shared_ptr<const BakedPart>& part,
            Pose& frame, double s = kS) {
  frame = random_frame(random);
  Trial trial;
  trial.scene = scene_of(mesh, frame, s);
  trial.part = part;
  return trial;
}

Trial press_hold(std::uint64_t seed) { return press_trial(seed, kS); }

Trial fast_impact(std::uint64_t seed) {
  Random random(seed);
  Pose frame;
  Trial trial = basic(random, slab(40 * kS, 8 * kS), some_part(random), frame);
  const glm::dquat turn = random_turn(random);
  const double speed_mps = std::pow(10.0, uniform(random, -0.5, 1.0));
  const double top = 25 * kS, bottom = -10 * kS, period_s = 2 * (top - bottom) / speed_mps + 0.2;
  const Pose high = frame * Pose{{0, 0, top}, turn}, low = frame * Pose{{0, 0, bottom}, turn};
  trial.start = high;
  trial.duration_s = 2;
  trial.target = [=](double t) {
    const double phase = std::fmod(t, period_s), fall_s = (top - bottom) / speed_mps;
    return phase < fall_s + 0.1 ? glide(high, low, 0, fall_s, phase)
                                : glide(low, high, fall_s + 0.1, 2 * fall_s + 0.1, phase);
  };
  return trial;
}

Trial slide_plane(std::uint64_t seed) { return slide_trial(seed, seed % 2 ? 8 : 1); }

Trial slide_stairs(std::uint64_t seed) {
  Random random(seed);
  Pose frame;
  Trial trial = basic(random, stairs(6 * kS, 12, 12 * kS), ball(), frame);
  const glm::dquat turn = random_turn(random);
  // Along the noses of the steps, pressed in.
  const glm::dvec3 along = glm::normalize(glm::dvec3(1, 0, 1)),
                   up = glm::normalize(glm::dvec3(-1, 0, 1));
  const double depth = uniform(random, 1, 4) * kS;
  const glm::dvec3 first = along * (-20.0 * kS) + up * (16.0 * kS);
  const Pose high = frame * Pose{first, turn};
  const Pose low = frame * Pose{first - up * (10.0 * kS + depth), turn};
  const Pose end = frame * Pose{first - up * (10.0 * kS + depth) + along * (40.0 * kS), turn};
  trial.start = high;
  trial.duration_s = 3.5;
  trial.slide_from_s = 0.5;
  trial.slide_direction = frame.orientation * along;
  trial.target = [=](double t) {
    return t < 0.5 ? glide(high, low, 0, 0.4, t) : glide(low, end, 0.5, 3.5, t);
  };
  return trial;
}

Trial wedge(std::uint64_t seed) {
  Random random(seed);
  const double half_angle = uniform(random, 2.5, 45) * M_PI / 180;
  Pose frame;
  Trial trial = basic(random, valley(half_angle, 50 * kS), some_part(random), frame);
  const glm::dquat turn = random_turn(random);
  const Pose high = frame * Pose{{0, 0, 65 * kS}, turn};
  const Pose low =
      frame * Pose{{uniform(random, -2, 2) * kS, 0, uniform(random, -4, 10) * kS}, turn};
  trial.start = high;
  trial.duration_s = 3;
  trial.hold_from_s = 1;
  trial.target = [=](double t) { return t < 1 ? glide(high, low, 0, 0.9, t) : low; };
  return trial;
}

Trial peg(std::uint64_t seed) {
  const std::array<double, 5> clearances{0.5, 1, 2, 5, 10};
  return peg_trial(seed, clearances[seed % clearances.size()]);
}

Trial cone(std::uint64_t seed) {
  Random random(seed);
  const double half_angle = uniform(random, 10, 70) * M_PI / 180;
  Pose frame;
  Trial trial = basic(random, pit(half_angle, 40 * kS), ball(), frame);
  const glm::dquat turn = random_turn(random);
  const Pose high = frame * Pose{{0, 0, 55 * kS}, turn};
  const Pose low =
      frame * Pose{{uniform(random, -2, 2) * kS, uniform(random, -2, 2) * kS, 0}, turn};
  trial.start = high;
  trial.duration_s = 3;
  trial.hold_from_s = 1;
  trial.target = [=](double t) { return glide(high, low, 0, 0.9, t); };
  return trial;
}

// A sheet without thickness, hit and pushed at up to 100 m/s.
Trial thin_wall(std::uint64_t seed) {
  Random random(seed);
  Pose frame;
  Trial trial = basic(random, sheet(40 * kS, 40 * kS), some_part(random), frame);
  const glm::dquat turn = random_turn(random);
  const double speed_mps = std::pow(10.0, uniform(random, -0.5, 2));
  const glm::dvec3 aside(uniform(random, -8, 8) * kS, uniform(random, -8, 8) * kS, 0);
  const Pose high = frame * Pose{glm::dvec3(0, 0, 25 * kS), turn};
  const Pose low = frame * Pose{aside - glm::dvec3(0, 0, 25 * kS), turn};
  trial.start = high;
  trial.duration_s = 1.5;
  trial.target = [=](double t) { return glide(high, low, 0.1, 0.1 + 50 * kS / speed_mps, t); };
  return trial;
}

Trial spun_bar(std::uint64_t seed) {
  Random random(seed);
  mesh::Mesh posts;
  append(posts, box(glm::dvec3(3, 30, 3) * kS), at({25 * kS, 0, 20 * kS}));
  append(posts, box(glm::dvec3(3, 3, 30) * kS), at({-16 * kS, 16 * kS, 0}));
  Pose frame;
  const auto part = part_of("long bar", box(glm::dvec3(30, 1, 1) * kS));
  Trial trial = basic(random, posts, part, frame);
  const double rate_radps = uniform(random, 5, 150);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(0.2, 1, 0.1) + 0.3 * random_direction(random));
  const Pose start = frame * at({0, 0, -12 * kS});
  trial.start = start;
  trial.duration_s = 2;
  trial.target = [=](double t) {
    const double spun = rate_radps * std::max(0.0, t - 0.1);
    return start * Pose{{0, 0, 0}, coupling::rotation_by(axis * spun)};
  };
  return trial;
}

Trial two_surfaces(std::uint64_t seed) {
  Random random(seed);
  mesh::Mesh corner = slab(40 * kS, 8 * kS);
  append(corner, box(glm::dvec3(4, 40, 20) * kS), at({-20 * kS, 0, 12 * kS}));
  Pose frame;
  Trial trial = basic(random, corner, block(), frame);
  const double depth = uniform(random, 1, 8) * kS;
  const glm::dquat turn = coupling::rotation_by(0.1 * random_direction(random));
  const Pose start = frame * Pose{{0, -20 * kS, 14 * kS}, turn};
  const Pose in = frame * Pose{{-8 * kS - depth, -20 * kS, 4.5 * kS - depth}, turn};
  const Pose end = frame * Pose{{-8 * kS - depth, 20 * kS, 4.5 * kS - depth}, turn};
  trial.start = start;
  trial.duration_s = 3;
  trial.slide_from_s = 0.6;
  trial.slide_direction = frame.orientation * glm::dvec3(0, 1, 0);
  trial.target = [=](double t) {
    return t < 0.6 ? glide(start, in, 0, 0.5, t) : glide(in, end, 0.6, 3, t);
  };
  return trial;
}

// A plate and a wire thinner than a voxel, pressed onto an edge and slid along it.
Trial thin_part(std::uint64_t seed) {
  Random random(seed);
  const bool wire = choice(random, 2) == 0;
  const auto part = wire ? part_of("wire", cylinder(0.15 * kS, 10 * kS, 8))
                         : part_of("plate", box(glm::dvec3(8, 6, 0.1) * kS));
  mesh::Mesh mesh = slab(30 * kS, 8 * kS);
  append(mesh, box(glm::dvec3(1, 20, 4) * kS), at({0, 0, 4 * kS}));
  Pose frame;
  Trial trial = basic(random, mesh, part, frame);
  const glm::dquat turn = random_turn(random);
  const Pose start = frame * Pose{{0, -8 * kS, 26 * kS}, turn};
  const Pose in = frame * Pose{{2 * kS, -8 * kS, 4 * kS}, turn};
  const Pose end = frame * Pose{{-2 * kS, 8 * kS, 2 * kS}, turn};
  trial.start = start;
  trial.duration_s = 3.5;
  trial.hold_from_s = 2.5;
  trial.target = [=](double t) {
    return t < 0.8 ? glide(start, in, 0, 0.7, t) : glide(in, end, 0.8, 2.4, t);
  };
  return trial;
}

mesh::Mesh congested(Random& random) {
  mesh::Mesh mesh;
  for (int i = 0; i < 14; ++i) {
    const Pose pose{random_direction(random) * uniform(random, 14, 26) * kS, random_turn(random)};
    switch (choice(random, 3)) {
      case 0:
        append(
            mesh,
            box(glm::dvec3(uniform(random, 1, 6), uniform(random, 1, 6), uniform(random, 0.2, 3)) *
                kS),
            pose);
        break;
      case 1:
        append(mesh, cylinder(uniform(random, 0.3, 3) * kS, uniform(random, 5, 16) * kS, 12), pose);
        break;
      default:
        append(mesh, sheet(uniform(random, 3, 8) * kS, uniform(random, 3, 8) * kS), pose);
    }
  }
  return mesh;
}

// A sum of sines of random phase: a hand that never rests and never jumps.
std::function<Pose(double)> wandering(Random& random, const Pose& about, double reach_m,
                                      double turn_rad, double slowest_hz, double fastest_hz) {
  struct Wave {
    double hz, phase;
    glm::dvec3 way, turn;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 6; ++i) {
    const double fraction = i / 5.0;
    const double hz = slowest_hz * std::pow(fastest_hz / slowest_hz, fraction);
    const double size = std::pow(0.6, i);
    waves.push_back({hz, uniform(random, 0, 2 * M_PI), random_direction(random) * reach_m * size,
                     random_direction(random) * turn_rad * size});
  }
  return [=](double t) {
    glm::dvec3 way(0), turn(0);
    for (const Wave& w : waves) {
      const double x = std::sin(2 * M_PI * w.hz * t + w.phase) - std::sin(w.phase);
      way += w.way * x;
      turn += w.turn * x;
    }
    return Pose{about.position_m + way, coupling::rotation_by(turn) * about.orientation};
  };
}

Trial shaking(std::uint64_t seed) {
  Random random(seed);
  Pose frame;
  const mesh::Mesh mesh = congested(random);
  Trial trial = basic(random, mesh, block(), frame);
  trial.start = frame;
  trial.duration_s = 4;
  trial.target = wandering(random, frame, 10 * kS, 0.5, 0.7, 12);
  return trial;
}

Trial random_hand(std::uint64_t seed) {
  Random random(seed);
  Pose frame;
  const mesh::Mesh mesh = congested(random);
  Trial trial = basic(random, mesh, some_part(random), frame);
  trial.start = frame;
  trial.duration_s = 5;
  trial.target = wandering(random, frame, uniform(random, 5, 30) * kS, uniform(random, 0.2, 3), 0.2,
                           uniform(random, 2, 20));
  return trial;
}

// A nut turned onto a bolt by the hand, its thread's flanks a few voxels apart.
Trial nut_on_bolt(std::uint64_t seed) {
  Random random(seed);
  constexpr double kFine = 0.001;
  constexpr double kRoot = 0.016, kDepth = 0.008, kPitch = 0.026, kGap = 0.0055;
  mesh::Mesh bolt = cylinder(kRoot, 0.08, 32);
  append(bolt, thread(kRoot, kDepth, kPitch, 5, 32));
  mesh::Mesh nut = tube(kRoot + kDepth + kGap, kRoot + kDepth + kGap + 0.006, 0.02, 32);
  append(nut, thread(kRoot + kDepth + kGap, -kDepth, kPitch, 1.4, 32));
  Pose frame;
  Trial trial = basic(random, bolt, part_of("nut", nut, kFine), frame, kFine);
  // Half a pitch up, the nut's ridge lies in the bolt's groove.
  const Pose start = frame * at({0, 0, kPitch / 2});
  trial.start = start;
  trial.duration_s = 3;
  const double turns = uniform(random, 0.3, 1.2), pull = uniform(random, -1, 1) * 0.004;
  trial.target = [=](double t) {
    const double fraction = std::clamp((t - 0.2) / 2.2, 0.0, 1.0);
    const double angle = 2 * M_PI * turns * fraction;
    return frame * Pose{{0, 0, kPitch * (0.5 + turns * fraction) + pull * fraction},
                        coupling::rotation_by({0, 0, angle})};
  };
  return trial;
}

// A device that fails in every way: NaN, infinities, denormals and huge numbers anywhere in the
// input, jumps of up to a meter, lost frames, and a clock that stands still or leaps.
Trial bad_input(std::uint64_t seed) {
  Random random(seed);
  Trial trial = random_hand(seed);
  trial.duration_s = 2;
  trial.disturb = [random = Random(seed)](StepInput& input, double& dt_s) mutable {
    if (choice(random, 20) != 0) return;
    constexpr double kBad[] = {NAN, INFINITY, -INFINITY, 5e-324, 1e-310, 1e300, -1e300, 1e18};
    const double bad = kBad[choice(random, 8)];
    const int axis = choice(random, 3);
    switch (choice(random, 8)) {
      case 0:
        input.world_from_handle.position_m[axis] = bad;
        break;
      case 1:
        input.world_from_handle.orientation[axis] = bad;
        break;
      case 2:
        input.handle_velocity.linear_mps[axis] = bad;
        break;
      case 3:
        input.handle_velocity.angular_radps[axis] = bad;
        break;
      case 4:
        input.world_from_handle.position_m += random_direction(random) * uniform(random, 0, 1);
        break;
      case 5:
        input.world_from_handle.orientation = random_turn(random);
        break;
      case 6:
        input.valid = 0;
        break;
      default: {
        constexpr double kTimes[] = {0, 5e-324, 1e-12, 0.1, 10};
        dt_s = kTimes[choice(random, 5)];
      }
    }
  };
  return trial;
}

// The paper's setting at the far ends of what a user may set.
Trial extremes(std::uint64_t seed) {
  Random random(seed);
  Trial trial = rest_trial(seed);
  trial.settings["mass_kg"] = std::pow(10.0, uniform(random, -3, 2));
  trial.settings["coupling_n_per_m"] = std::pow(10.0, uniform(random, 1, 6));
  trial.settings["coupling_ns_per_m"] = std::pow(10.0, uniform(random, -3, 4));
  trial.settings["coupling_nms_per_rad"] = std::pow(10.0, uniform(random, -7, 1));
  trial.rate_hz = std::pow(10.0, uniform(random, 2, 4));
  return trial;
}

constexpr std::array<Case, 18> kCases{{
    {"press-hold", "a part pressed onto an oblique plane and held", press_hold},
    {"fast-impact", "a plane hit at 0.3 to 10 m/s, again and again", fast_impact},
    {"slide-plane", "slid over an oblique plane, 1 or 8 voxels deep", slide_plane},
    {"slide-stairs", "slid over the noses of stairs", slide_stairs},
    {"wedge", "pressed into a valley of 5 to 90 degrees and held", wedge},
    {"peg-in-hole", "a square peg, 0.5 to 10 voxels of clearance", peg},
    {"sphere-in-cone", "a ball pressed into a pit and held", cone},
    {"thin-wall", "a sheet hit at 0.3 to 100 m/s", thin_wall},
    {"spun-bar", "a long bar spun against posts at 5 to 150 rad/s", spun_bar},
    {"two-surfaces", "slid along a corner (paper 6.4)", two_surfaces},
    {"thin-part", "a plate or a wire thinner than a voxel over a rib", thin_part},
    {"shaking-hand", "shaken in a congested scene", shaking},
    {"nut-on-bolt", "a nut turned and pulled on a bolt", nut_on_bolt},
    {"random-hand", "a hand that wanders through a congested scene", random_hand},
    {"bad-input", "NaN, infinities, denormals, jumps, lost frames, a clock that stands or leaps",
     bad_input},
    {"collisions", "a simulated hand strikes a pump against an aircraft bay, 0.05 to 0.5 m/s",
     collision_trial},
    {"rest", "a random part on a plane, in a wedge or a pit, and held", rest_trial},
    {"extremes", "rest with any mass, stiffness, damping and rate", extremes},
}};

}  // namespace

std::span<const Case> all_cases() { return kCases; }

const Case& case_named(std::string_view name) {
  for (const Case& c : kCases) {
    if (c.name == name) return c;
  }
  throw std::out_of_range("no stress case is called " + std::string(name));
}

Trial rest_trial(std::uint64_t seed) {
  Random random(seed);
  const double half_angle = uniform(random, 5, 45) * M_PI / 180;
  const int surface = choice(random, 3);
  const auto part = some_part(random);
  Pose frame;
  const mesh::Mesh mesh = surface == 0   ? slab(30 * kS, 8 * kS)
                          : surface == 1 ? valley(half_angle, 45 * kS)
                                         : pit(half_angle, 45 * kS);
  Trial trial = basic(random, mesh, part, frame);
  const double start_z = surface == 0 ? 16 * kS : 60 * kS;
  const double depth = uniform(random, 0.5, 8) * kS;
  const glm::dvec3 aside(uniform(random, -2, 2) * kS, uniform(random, -2, 2) * kS, 0);
  const Pose start = frame * Pose{{0, 0, start_z}, random_turn(random)};
  const glm::dquat nudge = coupling::rotation_by(0.3 * random_direction(random));
  Pose end =
      frame * Pose{aside + glm::dvec3(0, 0, surface == 0 ? -depth : 4 * kS - depth), {1, 0, 0, 0}};
  end.orientation = nudge * start.orientation;
  trial.start = start;
  trial.duration_s = 3.4;
  trial.hold_from_s = 0.4;
  trial.target = [=](double t) { return glide(start, end, 0, 0.4, t); };
  return trial;
}

Trial slide_trial(std::uint64_t seed, double depth_voxels) {
  Random random(seed);
  Pose frame;
  const auto part = some_part(random);
  Trial trial = basic(random, slab(50 * kS, 8 * kS), part, frame);
  const glm::dquat turn = random_turn(random);
  // The lowest point of the part touches the force layer's middle about 2.5 voxels up.
  double lowest = 0;
  for (const mesh::Vec3d& v : part->mesh().vertices) {
    lowest = std::min(lowest, (turn * glm::dvec3(v[0], v[1], v[2])).z);
  }
  const double touch = 2.5 * kS - lowest, depth = depth_voxels * kS;
  const Pose start = frame * Pose{{-25 * kS, 0, touch + 6 * kS}, turn};
  const Pose in = frame * Pose{{-25 * kS, 0, touch - depth}, turn};
  const Pose end = frame * Pose{{25 * kS, 0, touch - depth}, turn};
  trial.start = start;
  trial.duration_s = 2.6;
  trial.slide_from_s = 0.6;
  trial.slide_direction = frame.orientation * glm::dvec3(1, 0, 0);
  trial.target = [=](double t) {
    return t < 0.6 ? glide(start, in, 0, 0.5, t) : glide(in, end, 0.6, 2.6, t);
  };
  return trial;
}

Trial peg_trial(std::uint64_t seed, double clearance_voxels) {
  Random random(seed);
  const double half = 3 * kS;  // of the peg's section
  // Oblique to the grid the layers lie up to sqrt(3) times as far out, plus what the geometric
  // voxels add: the room that is left beyond them is the clearance.
  const glm::dquat turn = random_turn(random);
  const glm::dmat3 axes = glm::mat3_cast(turn);
  const auto reach = [&](const glm::dvec3& n) {
    // From the wall to where the force layer's middle begins to push: 2.5 layers and half a voxel.
    return (std::abs(n.x) + std::abs(n.y) + std::abs(n.z)) * 3.0 * kS;
  };
  const double room_x = half + reach(axes[0]) + clearance_voxels * kS / 2;
  const double room_y = half + reach(axes[1]) + clearance_voxels * kS / 2;
  const double wall = 4 * kS, deep = 14 * kS;
  mesh::Mesh hole;
  append(hole, box({wall / 2, room_y + wall, deep}), at({room_x + wall / 2, 0, 0}));
  append(hole, box({wall / 2, room_y + wall, deep}), at({-room_x - wall / 2, 0, 0}));
  append(hole, box({room_x + wall, wall / 2, deep}), at({0, room_y + wall / 2, 0}));
  append(hole, box({room_x + wall, wall / 2, deep}), at({0, -room_y - wall / 2, 0}));
  const Pose frame{{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)}, turn};
  Trial trial;
  trial.scene = scene_of(hole, frame);
  trial.part = part_of("peg", box({half, half, 12 * kS}));
  // The hand misses the middle by more than the clearance, and tilts: the walls must guide the peg.
  const double miss = (1 + 0.5 * clearance_voxels) * kS;
  const glm::dvec3 aside(uniform(random, -1, 1) * miss, uniform(random, -1, 1) * miss, 0);
  const glm::dquat tilt = coupling::rotation_by(0.02 * random_direction(random));
  const Pose start = frame * at(glm::dvec3(0, 0, deep + 12 * kS + 5 * kS));
  Pose end = frame * at(aside);
  end.orientation = tilt * end.orientation;
  trial.start = start;
  trial.duration_s = 3;
  trial.slide_from_s = 0;
  trial.slide_direction = frame.orientation * glm::dvec3(0, 0, -1);
  trial.target = [=](double t) { return glide(start, end, 0, 2.5, t); };
  return trial;
}

Trial press_trial(std::uint64_t seed, double s) {
  Random random(seed);
  Pose frame;
  Trial trial = basic(random, slab(20 * s, 8 * s), some_part(random, s), frame, s);
  const glm::dquat turn = random_turn(random);
  const Pose high = frame * Pose{{0, 0, 18 * s}, turn};
  const Pose low = frame * Pose{{0, 0, -0.05}, turn};  // far more stretch than 15 N need
  trial.start = high;
  trial.duration_s = 3;
  trial.hold_from_s = 1;
  trial.target = [=](double t) { return glide(high, low, 0, 0.9, t); };
  return trial;
}

}  // namespace forcelayer::stress
