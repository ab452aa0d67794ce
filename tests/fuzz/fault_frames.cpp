// fault_frames [--frames N] [--seed N] [--model default|paper]: a hand that wanders in and out of
// contact, on a device whose readings fail at random: missing, not calibrated, old, not finite, no
// rotation, far away, jumping, frozen, turning, claiming velocities; the loop late, the motors
// held, the clutch pressed. Each frame is judged from what was injected, without a look at the
// gate. One line of JSON at the end; status 1 where a promise was broken, which stderr says.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "forcelayer/run.h"
#include "runtime/loop/servo.h"
#include "tests/fuzz/interior_point.h"
#include "tests/support/point_part.h"
#include "tests/support/puppet_device.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005, kDt = 0.001;
constexpr int kStaleTicks = 5;

// The kinds of fault. The first ones must give zero in the frame in which they are read.
enum Kind {
  kAbsent,
  kUncalibrated,
  kNotANumber,
  kInfinite,
  kNoRotation,
  kFar,
  kJump,
  kZeroAtOnce,  // so many
  kOld = kZeroAtOnce,
  kFrozen,
  kTurn,
  kClaim,
  kLate,
  kHeld,
  kClutch,
  kKinds
};

std::unique_ptr<model::Simulation> simulation(Model model) {
  RunRequest request;
  request.model = model;
  request.device = puppet_capabilities();
  request.device.senses_velocity = true;
  request.without_guarantee = true;
  auto run = open_run(
      make_voxmap(offset_scene(kS, {0, 0, -2}, {48, 48, 8}, 2, [](Voxel v) { return v[2] <= 0; })),
      make_pshell(sphere_part(0.02, 120, kS)), request);
  if (!run) {
    std::fprintf(stderr, "%s\n", to_line(run.error()).c_str());
    std::exit(2);
  }
  return run->release_simulation();
}

struct Counts {
  std::uint64_t frames = 0, faulty = 0, touching = 0, with_force = 0, trips = 0, penetrations = 0;
  int broken = 0;

  void add(const Counts& more) {
    frames += more.frames;
    faulty += more.faulty;
    touching += more.touching;
    with_force += more.with_force;
    trips += more.trips;
    penetrations += more.penetrations;
    broken += more.broken;
  }
};

// One registration of the part. Each clutch takes hold of it elsewhere, so that the hand drifts: a
// campaign is many of these.
class Episode {
 public:
  Episode(Model model, std::uint64_t seed)
      : random_(seed),
        simulation_(simulation(model)),
        servo_(*simulation_, input_, simulation_->registered(hand_, hand_), limits_) {
    device_.senses_velocity(true);
    servo_.set_clutch_buttons(1);
    device_.sample.present = device_.sample.fresh = true;
    goal_ = hand_;
  }

  void run(std::uint64_t frames) {
    for (frame_ = 0; frame_ < frames && counts_.broken == 0; ++frame_) {
      move_hand();
      choose_fault();
      inject();
      Frame frame;
      if (!servo_.tick(frame)) breaks("the loop ended");
      judge(frame);
    }
    counts_.frames = frame_;
    counts_.trips = servo_.output().trips();
  }

  const Counts& counts() const { return counts_; }

 private:
  static unsigned long long ull(std::uint64_t n) { return n; }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  bool once_in(std::uint64_t n) { return random_() % n == 0; }

  void move_hand() {
    if (frame_ % 250 == 0) {
      goal_.orientation =
          glm::normalize(glm::dquat(1, between(-0.5, 0.5), between(-0.5, 0.5), between(-0.5, 0.5)));
      // Where the hand has the part at a place of our choice, wherever the clutch took hold of it.
      const glm::dvec3 part{between(0.05, 0.18), between(0.05, 0.18), between(0.015, 0.045)};
      goal_.position_m = part - goal_.orientation * servo_.state().handle_from_center.position_m;
    }
    const Pose before = hand_;
    hand_.position_m += 0.01 * (goal_.position_m - hand_.position_m);
    hand_.orientation = glm::normalize(glm::slerp(hand_.orientation, goal_.orientation, 0.01));
    const glm::dquat turn = hand_.orientation * glm::conjugate(before.orientation);
    velocity_ = {(hand_.position_m - before.position_m) / kDt,
                 2.0 * glm::dvec3(turn.x, turn.y, turn.z) * (turn.w < 0 ? -1.0 : 1.0) / kDt};
  }

  // Single bad frames, rows of them, and faults right after each other, as often.
  void choose_fault() {
    if (fault_left_ > 0) {
      --fault_left_;
      return;
    }
    kind_ = kKinds;
    const bool again = calm_left_ == 0;
    if (!again) --calm_left_;
    if (!again || !servo_armed_or_waiting()) return press_clutch_if_tripped();
    kind_ = static_cast<Kind>(random_() % kKinds);
    constexpr int kRows[] = {0, 0, 2, 5, 49, 249};
    fault_left_ = kRows[random_() % 6];
    constexpr int kCalms[] = {0, 1, 5, 30, 400, 1500};
    calm_left_ = kCalms[random_() % 6];
  }
  bool servo_armed_or_waiting() const { return servo_.output().state() != OutputState::kTripped; }
  void press_clutch_if_tripped() {
    if (servo_armed_or_waiting() || !once_in(50)) return;
    kind_ = kClutch;
    fault_left_ = 60;
    calm_left_ = 300;
  }

  void inject() {
    DeviceSample& sample = device_.sample;
    const DeviceSample last = sample;
    sample = {};
    sample.present = sample.fresh = true;
    sample.device_from_handle = hand_;
    sample.velocity = velocity_;
    Pose& pose = sample.device_from_handle;
    const double nan = std::nan("");
    switch (kind_) {
      case kAbsent:
        sample.present = false;
        break;
      case kUncalibrated:
        sample.calibrated = false;
        break;
      case kNotANumber:
        (once_in(2) ? pose.position_m.x : pose.orientation.y) = nan;
        break;
      case kInfinite:
        pose.position_m.z = once_in(2) ? INFINITY : -INFINITY;
        break;
      case kNoRotation:
        pose.orientation = once_in(2) ? glm::dquat(0, 0, 0, 0) : glm::dquat(3, 1, 0, 0);
        break;
      case kFar:
        pose.position_m *= once_in(2) ? 1000.0 : 1e300;
        break;
      // Farther than any hand gets while all faults before it last.
      case kJump:
        pose.position_m.y += once_in(2) ? 100 : -100;
        break;
      case kOld:
        sample.fresh = false;
        pose = last.device_from_handle;
        sample.velocity = last.velocity;
        break;
      case kFrozen:
        pose = last.device_from_handle;
        break;
      case kTurn:
        pose.orientation = glm::dquat(0, 1, 0, 0) * pose.orientation;
        break;
      case kClaim:
        sample.velocity.angular_radps.z += once_in(2) ? 1000 : 1e300;
        break;
      case kLate:
        servo_.note_late();
        break;
      case kHeld:
        sample.output_held = true;
        break;
      case kClutch:
        sample.buttons = 1;
        break;
      case kKinds:
        break;
      default:
        break;
    }
    old_ticks_ = sample.fresh ? 0 : old_ticks_ + 1;
    counts_.faulty += kind_ != kKinds;
  }

  // From what was injected, and what the motors got, alone.
  void judge(const Frame& frame) {
    const Wrench& w = device_.felt;
    const double force_n = glm::length(w.force_n), torque_nm = glm::length(w.torque_nm);
    const bool zero = force_n == 0 && torque_nm == 0;
    if (!(force_n <= kPuppetForceN * (1 + 1e-9) && torque_nm <= kPuppetTorqueNm * (1 + 1e-9))) {
      breaks("a wrench beyond its limits");
    }
    const double fraction = kDt / limits_.slew_s * (1 + 1e-9);
    const bool force_slew =
        force_n > 0 && glm::length(w.force_n - last_.force_n) > kPuppetForceN * fraction;
    const bool torque_slew =
        torque_nm > 0 && glm::length(w.torque_nm - last_.torque_nm) > kPuppetTorqueNm * fraction;
    if (force_slew || torque_slew) breaks("a wrench beyond its slew");
    const bool bad = kind_ < kZeroAtOnce || old_ticks_ > kStaleTicks + 1 || kind_ == kLate;
    if (bad && !zero) breaks("force in the frame of a fault");
    since_bad_ = bad ? 0 : since_bad_ + 1;
    // The fraction of the wrench that may be back by now: nothing for zero_s, then a ramp.
    const double gain =
        (static_cast<double>(since_bad_) * kDt - limits_.zero_s) / limits_.ramp_s + 0.006;
    if (since_bad_ < 300 && (force_n > kPuppetForceN * std::max(gain, 0.0) ||
                             torque_nm > kPuppetTorqueNm * std::max(gain, 0.0))) {
      breaks("force after a fault, but not by a ramp");
    }
    last_ = w;
    counts_.touching += frame.result.report.surface > 0;
    counts_.with_force += !zero;
    counts_.penetrations += frame.result.report.interior > 0;
    // A frame without motion queries nothing: the part is where the frame before reported it.
    if (frame_ % 61 == 0 && frame.input.valid == kInputValid && frame.result.report.interior == 0 &&
        has_interior_point(simulation_->voxmap(), simulation_->shell().view(),
                           frame.result.report.world_from_center)) {
      breaks("a penetration without a report");
    }
  }

  void breaks(const char* what) {
    if (counts_.broken++ > 0) return;
    std::fprintf(stderr, "frame %llu, fault %d, %d ticks after the last: %s\n", ull(frame_),
                 static_cast<int>(kind_), static_cast<int>(since_bad_), what);
  }

  std::mt19937_64 random_;
  std::unique_ptr<model::Simulation> simulation_;
  PuppetDevice device_;
  loop::DeviceInput input_{device_, {}};
  Pose hand_{{0.1, 0.1, 0.05}, {1, 0, 0, 0}}, goal_;
  Twist velocity_;
  loop::OutputLimits limits_ = puppet_limits();
  loop::Servo servo_;
  Wrench last_;
  Kind kind_ = kKinds;
  int fault_left_ = 0, calm_left_ = 500, old_ticks_ = 0;
  std::uint64_t frame_ = 0, since_bad_ = 1000;
  Counts counts_;
};

std::uint64_t number(const char* text) {
  std::uint64_t value = 0;
  std::from_chars(text, text + std::strlen(text), value);
  return value;
}

int run(int argc, char** argv) {
  std::uint64_t frames = 200'000, seed = 1;
  const char* model = "default";
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--frames") == 0) frames = number(argv[i + 1]);
    if (std::strcmp(argv[i], "--seed") == 0) seed = number(argv[i + 1]);
    if (std::strcmp(argv[i], "--model") == 0) model = argv[i + 1];
  }
  constexpr std::uint64_t kEpisode = 20'000;
  const bool paper = std::strcmp(model, "paper") == 0;
  Counts all;
  for (std::uint64_t n = 0; all.frames < frames && all.broken == 0; ++n) {
    Episode episode(paper ? Model::kPaper : Model::kDefault, seed * 1'000'003 + n);
    episode.run(std::min(kEpisode, frames - all.frames));
    all.add(episode.counts());
  }
  const auto ull = [](std::uint64_t count) { return static_cast<unsigned long long>(count); };
  std::printf(
      "{\"model\": \"%s\", \"seed\": %llu, \"frames\": %llu, \"faulty\": %llu, \"touching\": %llu, "
      "\"with_force\": %llu, \"trips\": %llu, \"penetrations\": %llu, \"broken\": %d, "
      "\"cpu_seconds\": %.0f}\n",
      model, ull(seed), ull(all.frames), ull(all.faulty), ull(all.touching), ull(all.with_force),
      ull(all.trips), ull(all.penetrations), all.broken,
      static_cast<double>(std::clock()) / CLOCKS_PER_SEC);
  return all.broken > 0 ? 1 : 0;
}

}  // namespace
}  // namespace forcelayer::test

int main(int argc, char** argv) { return forcelayer::test::run(argc, argv); }
