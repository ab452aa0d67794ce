#include "tests/bench/wrench_bench_hand.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <stdexcept>

#include "forcelayer/run.h"
#include "runtime/coupling/coupling.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/model/simulation.h"
#include "tests/bench/spread.h"
#include "tests/bench/wrench_bench_frame.h"
#include "tests/stress/trial.h"
#include "tests/support/mesh_gaps.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rigid_contact.h"

namespace forcelayer::bench {
namespace {

constexpr double kDtS = 1e-3, kSpeedMps = 0.05, kFarM = 0.02, kMaxTurnRad = 0.02;
constexpr double kMinPress = 0.2, kMaxPress = 0.8;  // of the force limit
constexpr int kHeldFrames = 3000, kSlideFrames = 200, kSampleFrames = 40;
constexpr double kSlideMps[] = {0.005, 0.05};
constexpr double kReachM =
    0.0003;  // of the gaps that a truth looks at: more than a step of it goes
// A truth is taken whose own conditions hold as well as this, far below what is measured.
constexpr double kNearM = 1e-7, kBalancedN = 5e-3;

bool is_solved(const test::RigidContact& truth) {
  return truth.too_near_m <= kNearM && truth.unbalanced_n <= kBalancedN;
}

std::vector<glm::dvec3> points_of(const Pshell& shell) {
  const PshellView view = shell.view();
  std::vector<glm::dvec3> points_m;
  for (std::uint64_t i = 0; i < view.point_count; ++i) {
    points_m.emplace_back(view.x[i], view.y[i], view.z[i]);
  }
  return points_m;
}

// The gaps of the shell's points by the stored distances.
std::vector<test::Gap> stored_gaps(ModelFrame& frame, const Pose& world_from_center) {
  const field::ContactSet& set = frame.contacts_at(world_from_center);
  std::vector<test::Gap> gaps;
  for (std::uint32_t i = 0; i < set.count; ++i) {
    const field::Contact c = set[i];
    if (-c.depth_m > kReachM) continue;
    gaps.push_back({-double{c.depth_m}, glm::dvec3(c.direction),
                    world_from_center.position_m + glm::dvec3(c.arm_m)});
  }
  return gaps;
}

// A simulation in a hand, frame by frame.
class Session {
 public:
  explicit Session(const HandCase& contact)
      : simulation_(open(contact)), gaps_(contact.scene, contact.part, standoff_m(), kReachM) {
    Pose far = contact.above;
    far.position_m -= kFarM * contact.in;
    handle = simulation_->world_from_part(far);
    state_ = simulation_->registered(handle, handle);
  }

  double standoff_m() const { return simulation_->voxmap().header().zero_force_m; }
  const Parameters& parameters() const { return simulation_->parameters(); }
  model::Simulation& simulation() { return *simulation_; }

  void step() {
    input_.valid = 1;
    input_.world_from_handle = handle;
    input_.handle_velocity = velocity_.update(handle, kDtS);
    result = simulation_->step(state_, input_, kDtS);
  }
  bool rests() const { return state_.settled != 0 && result.report.contacts > 0; }

  // The truth beside the part's present pose.
  test::RigidContact truth() const { return rigid_contact(std::ref(gaps_)); }
  // Rigid contact beside that pose, by other gaps.
  test::RigidContact rigid_contact(const test::GapsAt& gaps_at) const {
    const Parameters& p = parameters();
    const coupling::GripTarget target = coupling::grip_target(state_, input_);
    const test::HeldPart held{{p.coupling_n_per_m, p.coupling_force_limit_n},
                              {p.coupling_nm_per_rad, p.coupling_torque_limit_nm},
                              target.point_m,
                              target.orientation,
                              target.lever_m,
                              p.part_radius_m};
    return test::rigid_contact(held, gaps_at, result.report.world_from_center);
  }

  Pose handle;
  StepResult result;

 private:
  static std::unique_ptr<model::Simulation> open(const HandCase& contact) {
    RunRequest request;
    request.device = stress::trial_device();
    request.without_guarantee = true;  // formulas have no covering radius
    auto map = Voxmap::from_bytes(contact.voxmap.bytes(), "scene");
    auto part = Pshell::from_bytes(contact.shell.bytes(), "part");
    if (!map || !part) throw std::runtime_error(to_line(map ? part.error() : map.error()));
    auto run = open_run(std::move(*map), std::move(*part), request);
    if (!run) throw std::runtime_error(to_line(run.error()));
    return run->release_simulation();
  }

  std::unique_ptr<model::Simulation> simulation_;
  mutable test::MeshGaps gaps_;  // keeps which features are near
  State state_;
  StepInput input_;
  loop::HandleVelocity velocity_;
};

}  // namespace

double Hand::step_us() const { return step_us_.empty() ? NAN : spread(step_us_).p50; }

void Hand::see(const HandCase& contact, std::uint64_t seed) {
  std::array<std::size_t, kMotions> before;
  for (std::size_t motion = 0; motion < kMotions; ++motion) before[motion] = errors_[motion].size();
  Each& each = each_.emplace_back(Each{contact.name, {}});
  press(contact, seed, each);
  for (std::size_t motion = 0; motion < kMotions; ++motion) {
    const auto first = errors_[motion].begin() + static_cast<std::ptrdiff_t>(before[motion]);
    std::vector<double> errors(first, errors_[motion].end());
    each.median[motion] = errors.empty() ? NAN : spread(std::move(errors)).p50;
  }
}

void Hand::press(const HandCase& contact, std::uint64_t seed, Each& each) {
  ++seen_;
  Session session(contact);
  const Parameters& p = session.parameters();
  const auto field =
      field::make_force_field(Model::kDefault, p.force, session.simulation().voxmap());
  if (!field) throw std::runtime_error(to_line(field.error()));
  ModelFrame frame(session.simulation().voxmap(), session.simulation().shell(), **field,
                   Averaging::kStep);
  const auto error = [&](const Wrench& felt, const Wrench& truth) {
    return std::hypot(glm::length(felt.force_n - truth.force_n),
                      glm::length(felt.torque_nm - truth.torque_nm) / p.part_radius_m) /
           p.coupling_force_limit_n;
  };
  const auto compare = [&](std::size_t motion) {
    if (session.result.report.outside_map != 0) {
      ++outside_;
      return;
    }
    const test::RigidContact truth = session.truth();
    if (!is_solved(truth)) {
      ++unsolved_;
      return;
    }
    errors_[motion].push_back(error(session.result.at_handle, truth.on_hand));
  };
  const auto find_causes = [&] {
    if (session.result.report.outside_map != 0) return;
    test::MeshGaps points(contact.scene, points_of(contact.shell), session.standoff_m(), kReachM);
    const test::RigidContact steps[] = {
        session.truth(), session.rigid_contact(std::ref(points)),
        session.rigid_contact([&](const Pose& pose) { return stored_gaps(frame, pose); })};
    if (!std::ranges::all_of(steps, is_solved)) return;
    const Wrench wrenches[] = {steps[0].on_hand, steps[1].on_hand, steps[2].on_hand,
                               session.result.at_handle};
    for (std::size_t i = 0; i < kCauses; ++i) {
      each.causes[i] = error(wrenches[i + 1], wrenches[i]);
      causes_[i].push_back(each.causes[i]);
    }
  };

  test::Random random(seed);
  const double press_n = test::uniform(random, kMinPress, kMaxPress) * p.coupling_force_limit_n;
  const double turn_rad = test::uniform(random, 0, kMaxTurnRad);
  const glm::dvec3 turn = turn_rad * test::random_direction(random);
  const Pose start = session.handle;
  double way_m = 0, max_m = 1e300;
  for (int held = 0; held < kHeldFrames && way_m < 4 * kFarM && !(held > 0 && session.rests());) {
    if (way_m < max_m) way_m += kSpeedMps * kDtS;
    const double turned = std::min(1.0, way_m / kFarM);
    session.handle = {start.position_m + way_m * contact.in,
                      coupling::rotation_by(turned * turn) * start.orientation};
    session.step();
    if (max_m == 1e300 && session.result.report.contacts > 0) {
      max_m = way_m + press_n / p.coupling_n_per_m;
    }
    if (way_m >= max_m) ++held;
  }
  const double force_n = glm::length(session.result.wrench.force_n);
  if (!session.rests() || force_n == 0) {
    ++(session.result.report.contacts == 0 ? passed_ : restless_);
    return;
  }
  const Wrench there = frame.at(session.result.report.world_from_center);
  const double k = p.field_n_per_m;
  const double off = glm::length(k * there.force_n - session.result.wrench.force_n) / force_n;
  const double torque_off = glm::length(k * there.torque_nm - session.result.wrench.torque_nm) /
                            (force_n * p.part_radius_m);
  off_.push_back(std::max(off, torque_off));
  flush_ += session.result.report.contacts >= 3;

  compare(0);
  find_causes();
  for (std::size_t slide = 0; slide < std::size(kSlideMps); ++slide) {
    for (int i = 1; i <= kSlideFrames; ++i) {
      session.handle.position_m += kSlideMps[slide] * kDtS * contact.along;
      const auto start_time = std::chrono::steady_clock::now();
      session.step();
      const std::chrono::duration<double, std::micro> took =
          std::chrono::steady_clock::now() - start_time;
      step_us_.push_back(took.count());
      if (i % kSampleFrames == 0) compare(1 + slide);
    }
  }
}

}  // namespace forcelayer::bench
