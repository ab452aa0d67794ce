#include "runtime/voxrun/settings.h"

#include "forcelayer/parameters.h"
#include "forcelayer/stale_limit.h"
#include "formats/command/arguments.h"
#include "formats/command/help.h"
#include "formats/command/values.h"

namespace forcelayer::voxrun {
namespace {

// Settings beside the parameters of the step, by the name of its member of RunRequest.
struct LoopSetting {
  std::string_view name;
  const char* what;
  Range range;
};

enum LoopNumber {
  kRate,
  kMotionScale,
  kBraking,
  kMaxSpeed,
  kMaxTurn,
  kStale,
  kGuideForce,
  kLoopNumbers
};
constexpr LoopSetting kLoopSettings[kLoopNumbers] = {
    {"rate_hz", "frames a second, default 1000", kRatesHz},
    {"motion_scale",
     "meters in the scene for one meter at the device, default 1; the hand feels the scene's force "
     "times this number",
     kMotionScales},
    {"braking", "pre-contact braking of the paper (5.3): 1 is on, 0 is off, default 1", {0, 1}},
    {"max_speed_mps", "handle's speed (m/s) above which the output trips, default 5",
     kMaxSpeedsMps},
    {"max_turn_radps",
     "handle's angular speed (rad/s) above which the output trips, default 10 rad/m times "
     "max_speed_mps",
     kMaxTurnsRadps},
    {"stale_s",
     "the output trips if no device reading or no frame comes for this time (s), default 0.005",
     {1e-6, kStaleCeilingS}},
    {"guide_force_n",
     "largest force of --guide, N, default 0.3; the largest torque is 0.02 m times this force",
     {0.01, loop::kHighestGuideForceN}}};

constexpr double kNotSet = -1;  // below every range

command::Bounds bounds_of(const Range& range) { return {range.smallest, range.largest}; }

}  // namespace

void add_settings(CLI::App& app, std::string& texts) {
  command::name_value(
      command::add_texts(app, "--set", texts, ',',
                         "set a physical parameter or a limit from the table below; repeatable"),
      "NAME=VALUE");
  std::string rows;
  const auto add = [&rows](std::string_view name, const char* what, const Range& range) {
    rows += name;
    rows += '\t';
    rows += what;
    rows += " (" + command::to_text(bounds_of(range)) + ")\n";
  };
  for (const ParameterInfo& info : parameter_table()) add(info.name, info.what, info.range);
  for (const LoopSetting& setting : kLoopSettings) add(setting.name, setting.what, setting.range);
  command::add_help_table(app,
                          "Names of --set (defaults that are not stated follow from voxel size, "
                          "rate and device; --json reports them)",
                          rows);
}

Status read_settings(const std::string& texts, Options& options) {
  const auto table = parameter_table();
  std::vector<double> numbers(table.size(), kNotSet);
  double loop[kLoopNumbers] = {kNotSet,
                               kNotSet,
                               options.run.braking ? 1.0 : 0.0,
                               options.run.max_speed_mps,
                               kNotSet,
                               options.run.stale_s,
                               kNotSet};
  std::vector<command::ValueName> names(table.size() + kLoopNumbers);
  for (std::size_t n = 0; n < names.size(); ++n) {
    const bool of_loop = n >= table.size();
    const std::size_t at = of_loop ? n - table.size() : n;
    names[n].name = of_loop ? kLoopSettings[at].name : table[at].name;
    names[n].number = of_loop ? &loop[at] : &numbers[at];
    names[n].bounds = bounds_of(of_loop ? kLoopSettings[at].range : table[at].range);
  }
  if (Status read = command::read_values("--set", texts, names); !read) return read;
  for (std::size_t n = 0; n < table.size(); ++n) {
    if (numbers[n] != kNotSet) options.run.settings[std::string(table[n].name)] = numbers[n];
  }
  const bool is_recorded = loop[kRate] != kNotSet || loop[kMotionScale] != kNotSet;
  if (is_recorded && !options.replay.empty()) {
    return Error{ErrorCode::kUsage, "", "--set", "sets a parameter that the recording already sets",
                 "leave this option out with --replay"};
  }
  if (loop[kRate] != kNotSet) options.run.rate_hz = loop[kRate];
  if (loop[kMotionScale] != kNotSet) options.run.placement.motion_scale = loop[kMotionScale];
  if (loop[kBraking] != 0 && loop[kBraking] != 1) {
    return Error{ErrorCode::kUsage, "", "--set braking", "must be 0 or 1", ""};
  }
  options.run.braking = loop[kBraking] != 0;
  options.run.max_speed_mps = loop[kMaxSpeed];
  if (loop[kMaxTurn] != kNotSet) options.run.max_turn_radps = loop[kMaxTurn];
  options.run.stale_s = loop[kStale];
  if (loop[kGuideForce] != kNotSet) options.guide_force_n = loop[kGuideForce];
  return {};
}

}  // namespace forcelayer::voxrun
