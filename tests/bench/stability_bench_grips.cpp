// The whole closed loop with grips of every arm: which handles swing, and what closed loops give
// the hand.
#include <cstdio>

#include "tests/bench/stability_bench.h"
#include "tests/support/grip_map.h"

namespace forcelayer::stress {
namespace {

constexpr double kStillSteps = 8;  // of the encoder: below that the handle rests
constexpr double kFreeJ = 2e-5;    // beyond what a sampled spring must give
constexpr double kWorkedJ = 1e-3;  // either way: a loop that says something
constexpr double kArmsM[] = {0, 0.1, 0.2, 0.3, 0.5};
constexpr const char* kAxes[] = {"x", "y", "z"};
constexpr const char* kTempers[] = {"none", "loose", "firm"};

// Swing of the handle in encoder steps; infinite where the part was torn off before it touched.
// `then` sees what the twenty seconds gave the hand, and a handle that swings and that nobody
// holds, from there on.
double swing(Model model, double scale, double delay_s, int temper, double arm_m, int axis,
             bool clutch, Json& then) {
  static const test::VoxelScene scene = test::plane();
  static const test::PointPart part = test::block();
  test::HeldPartOptions options = test::above_the_plane(arm_m, axis, scale);
  options.model = model;
  options.hand = temper == 2 ? devices::SimHandParameters{} : devices::loose_grip();
  options.hand->delay_s = delay_s;
  try {
    test::HeldPart held(scene, part, options);
    const double steps = test::swing_steps(held, *options.hand, temper == 0, clutch);
    then["given_j"] = held.work().given_j;
    then["over_j"] = held.work().given_j - test::sampled_j(held);
    if (model == Model::kDefault && temper == 0 && steps >= kStillSteps) {
      const test::Creep creep = test::creep(held);
      std::printf(
          "    goes on for %.1f s: %.4f rad of way, %.4f rad from where it was; the motors "
          "have %.3g to %.3g N m while it moves\n",
          creep.rest_s, creep.way_rad, creep.net_rad, creep.least_nm, creep.most_nm);
      then["rest_s"] = std::isfinite(creep.rest_s) ? Json(creep.rest_s) : Json(nullptr);
      then["way_steps"] = creep.way_rad / options.hand->encoder_step_rad;
      then["net_steps"] = creep.net_rad / options.hand->encoder_step_rad;
      then["least_nm"] = creep.least_nm;
      then["most_nm"] = creep.most_nm;
    }
    return steps;
  } catch (const std::runtime_error&) {
    return INFINITY;
  }
}

}  // namespace

Json grip_map(const std::string& only_model, double only_scale) {
  Json rows = Json::array();
  std::printf("grips: . quiet, X swings; arms of 0 m, then 0.1 0.2 0.3 0.5 m along x, y and z\n");
  for (const Model model : kBothModels) {
    if (!only_model.empty() && only_model != name_of(model)) continue;
    for (const double scale : {0.1, 1.0, 5.0, 10.0}) {
      if (only_scale > 0 && only_scale != scale) continue;
      for (const double delay_s : {0.0, 0.001, 0.003}) {
        for (int temper = 0; temper < 3; ++temper) {
          for (const bool clutch : {false, true}) {
            std::string cells;
            for (int axis = 0; axis < 3; ++axis) {
              for (const double arm_m : kArmsM) {
                if (arm_m == 0 && axis > 0) continue;
                Json then;
                const double steps =
                    swing(model, scale, delay_s, temper, arm_m, axis, clutch, then);
                cells += steps < kStillSteps ? '.' : 'X';
                rows.push_back({{"model", name_of(model)},
                                {"scale", scale},
                                {"delay_s", delay_s},
                                {"hand", kTempers[temper]},
                                {"clutch", clutch},
                                {"axis", kAxes[axis]},
                                {"arm_m", arm_m},
                                {"swing_steps", std::isfinite(steps) ? Json(steps) : Json(nullptr)},
                                {"quiet", steps < kStillSteps}});
                for (const char* key : {"given_j", "over_j", "rest_s", "way_steps", "net_steps",
                                        "least_nm", "most_nm"}) {
                  rows.back()[key] = then.contains(key) ? then[key] : Json(nullptr);
                }
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

namespace {

// How a loop's part begins: above the plane, or installed on it with its seat open.
struct LoopStart {
  Model model;
  bool seated;
};
constexpr LoopStart kLoopStarts[] = {
    {Model::kPaper, false}, {Model::kDefault, false}, {Model::kDefault, true}};

}  // namespace

Json loop_table(const std::string& only_start, double only_scale) {
  Json rows = Json::array();
  std::printf("loops: the second of two closed loops in contact, uJ; over: beyond kT/2 int v^2\n");
  const test::VoxelScene scene = test::plane();
  const test::PointPart part = test::block();
  for (const auto& [model, seated] : kLoopStarts) {
    if (!only_start.empty() && (only_start == "seated") != seated) continue;
    for (const double scale : {0.1, 0.3, 1.0, 3.0, 10.0}) {
      if (only_scale > 0 && only_scale != scale) continue;
      for (const test::HandleLoop& loop : test::kHandleLoops) {
        double most_over_j = -INFINITY, most_given_j = -INFINITY, moved_j = 0;
        int over = 0, loops = 0, worked = 0;
        for (const double arm_m : {0.0, 0.03, 0.1}) {
          for (const double speed_mps : {0.001, 0.005, 0.02}) {
            for (const bool back : {false, true}) {
              const int axis = arm_m == 0.03 ? 0 : 2;
              test::HeldPartOptions options = seated
                                                  ? test::seated_on_the_plane(arm_m, axis, scale)
                                                  : test::flat_above_the_plane(arm_m, axis, scale);
              options.model = model;
              test::HeldPart held(scene, part, options);
              const test::LoopWork work = test::loop_work(held, loop, speed_mps, back);
              most_over_j = std::max(most_over_j, work.given_j - work.sampled_j);
              most_given_j = std::max(most_given_j, work.given_j);
              moved_j = std::max(moved_j, work.moved_j);
              over += work.given_j > work.sampled_j + kFreeJ;
              worked += work.moved_j > kWorkedJ;
              ++loops;
            }
          }
        }
        std::printf(
            "  %-8s %-6s scale %-4g %-16s given at most %9.2f, over %9.2f; %d of %d over 20; %d "
            "with 1 mJ\n",
            name_of(model), seated ? "seated" : "", scale, loop.name, most_given_j * 1e6,
            most_over_j * 1e6, over, loops, worked);
        std::fflush(stdout);
        rows.push_back({{"model", name_of(model)},
                        {"start", seated ? "seated" : "above"},
                        {"scale", scale},
                        {"loop", loop.name},
                        {"loops", loops},
                        {"worked", worked},
                        {"given_j", most_given_j},
                        {"over_j", most_over_j},
                        {"moved_j", moved_j},
                        {"over_bound", over}});
      }
    }
  }
  return rows;
}

}  // namespace forcelayer::stress
