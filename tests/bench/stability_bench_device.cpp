// The loop closed by a simulated hand and device: how stiff the coupling may be before the handle
// trembles, beside the bounds that the defaults obey (stability.h).
#include <cmath>
#include <cstdio>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/loop/output_stage.h"
#include "runtime/run/stability.h"
#include "tests/bench/stability_bench.h"
#include "tests/stress/cases.h"
#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

constexpr double kS = 0.005, kDtS = 0.001;

// Eight of the encoder's steps: below that the handle rests but for quantization.
constexpr double kStillSteps = 8;

// A hand that goes on along a screw until something is in the way, and then wants so much more.
struct Push {
  Trial trial;
  bool turning = false;  // about `along`, else straight
  glm::dvec3 along{1, 0, 0};
  double speed = 0;   // m/s or rad/s
  double beyond = 0;  // m or rad
  const char* setting = nullptr;

  Pose wanted(double way) const {
    const Pose& start = trial.start;
    if (!turning) return {start.position_m + along * way, start.orientation};
    return {start.position_m, coupling::rotation_by(along * way) * start.orientation};
  }
};

// A part pressed onto an oblique plane.
Push press() {
  Push push;
  push.trial = press_trial(3, kS);
  const Pose from = push.trial.target(0), to = push.trial.target(1);
  push.along = glm::normalize(to.position_m - from.position_m);
  push.speed = 0.1;
  push.beyond = 0.01;
  push.setting = "coupling_n_per_m";
  return push;
}

// A bar turned against the walls of a slot, oblique to the grid.
Push twist() {
  mesh::Mesh walls;
  append(walls, box(glm::dvec3(30, 3, 10) * kS), {{0, 8 * kS, 0}, {1, 0, 0, 0}});
  append(walls, box(glm::dvec3(30, 3, 10) * kS), {{0, -8 * kS, 0}, {1, 0, 0, 0}});
  const Pose frame{{0.1, 0.2, 0.3}, coupling::rotation_by({0.3, -0.5, 0.7})};
  mesh::Mesh placed;
  append(placed, walls, frame);
  Push push;
  push.trial.scene = std::make_shared<BakedScene>(placed, kS);
  push.trial.part = std::make_shared<BakedPart>(box(glm::dvec3(10, 1.2, 1.2) * kS), kS);
  push.trial.start = frame;
  push.turning = true;
  push.along = frame.orientation * glm::dvec3(0, 0, 1);
  push.speed = 0.5;
  push.beyond = 0.05;
  push.setting = "coupling_nm_per_rad";
  return push;
}

// Peak to peak of the handle in the last of five seconds, m or rad.
double ripple(const Push& push, Model model, double stiffness,
              const devices::SimHandParameters& hand) {
  Trial trial = push.trial;
  trial.settings[push.setting] = stiffness;
  trial.device = devices::hand_capabilities(hand);
  const auto simulation = make_simulation(trial, model);
  const Parameters& p = simulation->parameters();
  loop::OutputLimits limits;
  limits.max_force_n = p.max_force_n;
  limits.max_torque_nm = p.max_torque_nm;
  loop::OutputStage output(limits);
  State state = simulation->registered(trial.start, trial.start);
  devices::SimHand device(hand, trial.start);
  loop::HandleVelocity velocity;
  StepInput input;
  input.valid = 1;
  Wrench felt;
  double way = 0;
  bool touched = false;
  glm::dvec3 low(1e300), high(-1e300);
  for (int frame = 0; frame < 5000; ++frame) {
    if (!touched) way += push.speed * kDtS;
    input.world_from_handle =
        device.step(push.wanted(way + (touched ? push.beyond : 0)), felt, kDtS);
    input.handle_velocity = velocity.update(input.world_from_handle, kDtS);
    const StepResult result = simulation->step(state, input, kDtS);
    loop::OutputFrame out;
    out.wanted = result.at_handle;
    out.unstretched = true;
    felt = output.pass(out, kDtS);
    touched |= result.report.contacts > 0;
    if (frame < 4000) continue;
    const glm::dvec3 at = push.turning
                              ? coupling::rotation_vector(device.pose().orientation *
                                                          glm::conjugate(trial.start.orientation))
                              : device.pose().position_m;
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  if (!touched) return INFINITY;  // unstable before it got there
  return glm::length(high - low);
}

double default_of(const Push& push, Model model, const devices::SimHandParameters& hand) {
  Trial trial = push.trial;
  trial.device = devices::hand_capabilities(hand);
  const Parameters p = make_simulation(trial, model)->parameters();
  return push.turning ? p.coupling_nm_per_rad : p.coupling_n_per_m;
}

double bound_of(const Push& push, const devices::SimHandParameters& hand) {
  return push.turning
             ? std::min(renderable_stiffness(hand.device_damping_nms_per_rad, hand.delay_s, kDtS),
                        dissipated_stiffness(hand.device_friction_nm, hand.encoder_step_rad))
             : std::min(renderable_stiffness(hand.device_damping_ns_per_m, hand.delay_s, kDtS),
                        dissipated_stiffness(hand.device_friction_n, hand.encoder_step_m));
}

Json measured(const Push& push, const char* what, double low, double high) {
  Json rows = Json::array();
  std::printf("%s: stiffest quiet coupling, beside the default and the bound of it\n", what);
  for (const Model model : kBothModels) {
    for (const bool loose : {true, false}) {
      for (const double delay_s : {0.0, 0.001, 0.002, 0.003}) {
        devices::SimHandParameters hand =
            loose ? devices::loose_grip() : devices::SimHandParameters();
        hand.delay_s = delay_s;
        const double still =
            kStillSteps * (push.turning ? hand.encoder_step_rad : hand.encoder_step_m);
        // Up by octaves to where it trembles, then by quarters of the last one.
        double quiet = 0, trembles = 0;
        for (const double factor : {2.0, std::pow(2, 0.25)}) {
          const double end = trembles > 0 ? trembles : high;
          for (double k = quiet > 0 ? quiet * factor : low; k < end; k *= factor) {
            if (ripple(push, model, k, hand) > still) {
              trembles = k;
              break;
            }
            quiet = k;
          }
        }
        const double usual = default_of(push, model, hand), bound = bound_of(push, hand);
        const bool inside = usual < bound && ripple(push, model, usual, hand) <= still &&
                            (trembles == 0 || usual < trembles);
        std::printf("  %-8s %-5s delay %g ms  quiet to %8.4g  default %8.4g %s  bound %8.4g\n",
                    name_of(model), loose ? "loose" : "firm", delay_s * 1e3, quiet, usual,
                    inside ? "inside " : "OUTSIDE", bound);
        std::fflush(stdout);
        rows.push_back({{"model", name_of(model)},
                        {"grip", loose ? "loose" : "firm"},
                        {"delay_s", delay_s},
                        {"quiet_to", quiet},
                        {"trembles_at", trembles > 0 ? Json(trembles) : Json(nullptr)},
                        {"default", usual},
                        {"default_inside_both", inside},
                        {"bound", bound}});
      }
    }
  }
  return rows;
}

}  // namespace

Json device_table() {
  return {{"press_n_per_m", measured(press(), "press (N/m)", 100, 40000)},
          {"twist_nm_per_rad", measured(twist(), "twist (N m/rad)", 0.01, 40)}};
}

}  // namespace forcelayer::stress
