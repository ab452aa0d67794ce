// The closed loop with grips of every arm: the handles that swing, and the energy that a hand gets.
#include <cmath>
#include <cstdio>

#include "tests/bench/stability_bench.h"
#include "tests/support/grip_map.h"

namespace forcelayer::stress {
namespace {

constexpr double kStillSteps = 8;  // of the encoder: below that the handle rests
constexpr double kArmsM[] = {0, 0.1, 0.2, 0.3, 0.5};
constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr const char* kTempers[] = {"none", "loose", "firm"};

struct Grip {
  Model model;
  double scale, delay_s;
  int temper;
  bool clutch;
  int axis;
  double arm_m;
};

Json row_of(const Grip& grip) {
  static const test::VoxelScene scene = test::plane();
  static const test::PointPart part = test::block();
  Json row{{"model", name_of(grip.model)},
           {"scale", grip.scale},
           {"delay_s", grip.delay_s},
           {"hand", kTempers[grip.temper]},
           {"clutch", grip.clutch ? 1 : 0},
           {"axis", kAxes[grip.axis]},
           {"arm_m", grip.arm_m},
           {"swing_steps", nullptr},  // where the part was torn off before it touched
           {"quiet", 0},
           {"given_j", nullptr},
           {"over_j", nullptr}};
  test::HeldPartOptions options = test::above_the_plane(grip.arm_m, grip.axis, grip.scale);
  options.model = grip.model;
  options.hand = grip.temper == 2 ? devices::SimHandParameters{} : devices::loose_grip();
  options.hand->delay_s = grip.delay_s;
  try {
    test::HeldPart held(scene, part, options);
    const double steps = test::swing_steps(held, *options.hand, grip.temper == 0, grip.clutch);
    if (std::isfinite(steps)) row["swing_steps"] = steps;
    row["quiet"] = steps < kStillSteps ? 1 : 0;
    row["given_j"] = held.work().given_j;
    row["over_j"] = held.work().given_j - test::sampled_j(held);
  } catch (const std::runtime_error&) {
  }
  return row;
}

}  // namespace

Json grip_table() {
  Json rows = Json::array();
  std::printf("grips: . quiet, X swings; arms of 0 m, then 0.1 0.2 0.3 0.5 m along x, y and z\n");
  for (const Model model : kBothModels) {
    for (const double scale : {0.1, 1.0, 5.0, 10.0}) {
      for (const double delay_s : {0.0, 0.001, 0.003}) {
        for (int temper = 0; temper < 3; ++temper) {
          for (const bool clutch : {false, true}) {
            std::string cells;
            for (int axis = 0; axis < 3; ++axis) {
              for (const double arm_m : kArmsM) {
                if (arm_m == 0 && axis > 0) continue;
                rows.push_back(row_of({model, scale, delay_s, temper, clutch, axis, arm_m}));
                cells += rows.back()["quiet"] == 1 ? '.' : 'X';
              }
            }
            std::printf("  %-8s scale %-4g delay %g ms  %-5s %s  %s\n", name_of(model), scale,
                        delay_s * 1e3, kTempers[temper], clutch ? "clutched" : "        ",
                        cells.c_str());
            std::fflush(stdout);
          }
        }
      }
    }
  }
  return rows;
}

}  // namespace forcelayer::stress
