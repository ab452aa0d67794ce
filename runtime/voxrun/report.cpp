#include "runtime/voxrun/report.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"
#include "formats/command/provenance.h"
#include "formats/command/text.h"
#include "runtime/model/simulation.h"
#include "runtime/query/query_kernel.h"
#include "runtime/run/limits.h"
#include "runtime/voxrun/verdict.h"

namespace forcelayer::voxrun {
namespace {

using command::text;

using Json = nlohmann::ordered_json;

std::optional<double> penetration_ratio(const loop::LoopStatistics& s) {
  if (s.force_layer_frames == 0) return std::nullopt;
  return static_cast<double>(s.penetration_frames) / static_cast<double>(s.force_layer_frames);
}

// Adds a member.
void put(Json& json, const char* key, Json value) { json[key] = std::move(value); }
void put(Json& json, const char* key, double value) { put(json, key, Json(value)); }
void put(Json& json, const char* key, std::uint64_t value) { put(json, key, Json(value)); }
void put(Json& json, const char* key, std::int64_t value) { put(json, key, Json(value)); }
void put(Json& json, const char* key, std::uint32_t value) { put(json, key, std::uint64_t{value}); }
void put(Json& json, const char* key, bool value) { put(json, key, Json(value)); }
void put(Json& json, const char* key, const std::string& value) { put(json, key, Json(value)); }
void put(Json& json, const char* key, const char* value) { put(json, key, Json(value)); }

Json list(std::initializer_list<double> values) { return std::vector<double>(values); }

// Numbers that JSON cannot hold become null.
Json number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json percentiles(const loop::DurationHistogram& h) {
  Json json;
  put(json, "p50", h.quantile_ns(0.5));
  put(json, "p99", h.quantile_ns(0.99));
  put(json, "p999", h.quantile_ns(0.999));
  put(json, "max", h.max_ns());
  return json;
}

Json parameters_json(const Parameters& p) {
  Json json;
  for (const ParameterInfo& info : parameter_table()) {
    put(json, info.name.data(), number(p.*(info.member)));
  }
  put(json, "rate_hz", p.rate_hz);
  put(json, "voxel_size_m", p.voxel_size_m);
  put(json, "part_radius_m", p.part_radius_m);
  put(json, "inertia_kgm2",
      list({p.inertia_kgm2[0][0], p.inertia_kgm2[1][1], p.inertia_kgm2[2][2], p.inertia_kgm2[0][1],
            p.inertia_kgm2[0][2], p.inertia_kgm2[1][2]}));
  put(json, "braking", p.braking);
  return json;
}

bool drives_force(const DeviceCapabilities& c) {
  return (c.actuated_axes & (kAxisX | kAxisY | kAxisZ)) != 0;
}
bool drives_torque(const DeviceCapabilities& c) {
  return (c.actuated_axes & (kAxisRotX | kAxisRotY | kAxisRotZ)) != 0;
}

// A device's declaration; null: not declared, or none.
Json capabilities_json(const DeviceCapabilities& c) {
  const auto axes = [](std::uint32_t bits) {
    const char* const names[] = {"x", "y", "z", "rot_x", "rot_y", "rot_z"};
    Json json = Json::array();
    for (int i = 0; i < 6; ++i) {
      if ((bits >> i & 1) != 0) json.push_back(names[i]);
    }
    return json;
  };
  const auto declared = [](double value) { return value > 0 ? Json(value) : Json(nullptr); };
  Json json;  // assignments: lists in braces compile to several times as much
  put(json, "name", c.name);
  put(json, "sensed_axes", axes(c.sensed_axes));
  put(json, "actuated_axes", axes(c.actuated_axes));
  put(json, "max_force_n", drives_force(c) ? c.max_force_n : 0.0);
  put(json, "max_torque_nm", drives_torque(c) ? c.max_torque_nm : 0.0);
  const struct {
    const char* name;
    double value;
    bool told;  // null where it is 0
  } figures[] = {{"max_stiffness_n_per_m", c.max_stiffness_n_per_m, true},
                 {"max_stiffness_nm_per_rad", c.max_stiffness_nm_per_rad, true},
                 {"damping_ns_per_m", c.damping_ns_per_m, false},
                 {"damping_nms_per_rad", c.damping_nms_per_rad, false},
                 {"friction_n", c.friction_n, true},
                 {"friction_nm", c.friction_nm, true},
                 {"encoder_step_m", c.encoder_step_m, true},
                 {"encoder_step_rad", c.encoder_step_rad, true},
                 {"apparent_mass_kg", c.apparent_mass_kg, true},
                 {"apparent_inertia_kgm2", c.apparent_inertia_kgm2, true},
                 {"delay_s", c.delay_s, false},
                 {"workspace_radius_m", c.workspace_radius_m, true},
                 {"rate_hz", c.rate_hz, true}};
  for (const auto& figure : figures) {
    put(json, figure.name, figure.told ? declared(figure.value) : Json(figure.value));
  }
  put(json, "senses_velocity", c.senses_velocity);
  put(json, "watchdog_s", declared(c.watchdog_s));
  put(json, "hardware", c.hardware);
  return json;
}

std::string capabilities_text(const DeviceCapabilities& c) {
  std::string line =
      text("device %s: senses %d axes, drives %d axes with at most %.4g N and %.4g N m",
           escaped(c.name).c_str(), std::popcount(c.sensed_axes), std::popcount(c.actuated_axes),
           drives_force(c) ? c.max_force_n : 0, drives_torque(c) ? c.max_torque_nm : 0);
  if (c.workspace_radius_m > 0) line += text(", workspace radius %.3g m", c.workspace_radius_m);
  if (c.rate_hz > 0) line += text(", %.6g Hz", c.rate_hz);
  if (c.hardware && c.watchdog_s > 0) line += text(", watchdog %.3g ms", c.watchdog_s * 1000);
  return line + "\n";
}

// Causes of the deadline misses, most frequent last, and the worst one.
std::string misses_text(const loop::LoopStatistics& s) {
  std::string causes;
  for (std::size_t i = 0; i < loop::kMissCauses; ++i) {
    if (s.misses_by_cause[i] == 0) continue;
    causes +=
        text("%s%s %llu", causes.empty() ? "" : ", ", to_text(static_cast<loop::MissCause>(i)),
             static_cast<unsigned long long>(s.misses_by_cause[i]));
  }
  const loop::MissedFrame* worst = &s.worst[0];
  for (std::size_t i = 1; i < s.worst.size(); ++i) {
    if (s.worst[i].late_ns > worst->late_ns) worst = &s.worst[i];
  }
  return "  " + causes +
         text("; worst: frame %llu, %.3f ms late\n", static_cast<unsigned long long>(worst->frame),
              static_cast<double>(worst->late_ns) / 1e6);
}

Json misses_json(const loop::LoopStatistics& s) {
  Json json;
  for (std::size_t i = 0; i < loop::kMissCauses; ++i) {
    json[to_text(static_cast<loop::MissCause>(i))] = s.misses_by_cause[i];
  }
  return json;
}

Json worst_json(const loop::LoopStatistics& s) {
  std::vector<loop::MissedFrame> frames;
  for (std::size_t i = 0; i < s.worst.size(); ++i) frames.push_back(s.worst[i]);
  std::sort(frames.begin(), frames.end(),
            [](const auto& a, const auto& b) { return a.late_ns > b.late_ns; });
  Json json = Json::array();
  for (const loop::MissedFrame& f : frames) {
    Json& one = json.emplace_back();
    put(one, "frame", f.frame);
    put(one, "cause", to_text(f.cause));
    put(one, "late_ns", f.late_ns);
    put(one, "woke_late_ns", f.cost.woke_late_ns);
    put(one, "tick_ns", f.cost.tick_ns);
    put(one, "step_ns", f.step_ns);
    put(one, "cpu_ns", f.cost.cpu_ns);
    put(one, "minor_faults", f.cost.minor_faults);
    put(one, "major_faults", f.cost.major_faults);
    put(one, "voluntary_switches", f.cost.voluntary_switches);
    put(one, "involuntary_switches", f.cost.involuntary_switches);
  }
  return json;
}

// Figures of a loop with a clock.
void add_clock(const RunFacts& facts, const loop::LoopStatistics& s, Json& json) {
  put(json, "tick_ns", percentiles(s.tick));
  put(json, "wakeup_ns", percentiles(s.wakeup));
  put(json, "deadline_misses", s.deadline_misses);
  put(json, "miss_causes", misses_json(s));
  put(json, "worst_frames", worst_json(s));
  put(json, "skipped_ticks", s.skipped_ticks);
  put(json, "dropped_frames", s.dropped_frames);
  put(json, "minor_faults", s.minor_faults);
  put(json, "major_faults", s.major_faults);
  put(json, "voluntary_switches", s.voluntary_switches);
  put(json, "involuntary_switches", s.involuntary_switches);
  put(json, "steal_s", facts.steal_s);
}

void add_output(const RunFacts& facts, const loop::LoopStatistics& s, Json& json) {
  put(json, "max_device_force_n", s.max_device_force_n);
  put(json, "max_device_torque_nm", s.max_device_torque_nm);
  put(json, "held_readings", s.held_readings);
  put(json, "clutched_frames", s.clutched_frames);
  const RunRequest& request = facts.options.run;
  Json& limits = json["output_limits"];
  put(limits, "max_speed_mps", request.max_speed_mps);
  put(limits, "max_turn_radps", max_turn_radps(request));
  put(limits, "stale_s", request.stale_s);
  put(json, "output_trips", facts.output_trips);
  if (!facts.device_counters.empty()) {
    Json& counters = json["device_counters"];
    for (const auto& [name, value] : facts.device_counters) put(counters, name, value);
  }
  put(json, "last_trip", facts.output_trips > 0 ? Json(to_text(facts.last_trip)) : Json(nullptr));
  put(json, "ended_tripped", facts.ended_tripped);
  Json& events = json["events"] = Json::array();
  for (const OutputEvent& event : facts.events) {
    Json& one = events.emplace_back();
    put(one, "t_s", event.time_s);
    put(one, "event", event.what);
  }
}

// Null where nothing is known by a name.
Json object_json(const Scenes& scenes, std::uint32_t object) {
  return object == 0 ? Json(nullptr) : Json(scenes.object_text(object));
}

Json clearance_json(const Scenes& scenes, const loop::LoopStatistics& s) {
  const auto& smallest = s.min_clearance;
  if (smallest.kind == ClearanceKind::kNone) return nullptr;
  Json json;
  put(json, "clearance_m", smallest.clearance_m);
  put(json, "t_s", smallest.time_s);
  put(json, "at_least", smallest.kind == ClearanceKind::kAtLeast);
  put(json, "object", object_json(scenes, smallest.object));
  if (smallest.kind == ClearanceKind::kProven) {
    put(json, "point_m", list({smallest.point_m.x, smallest.point_m.y, smallest.point_m.z}));
  }
  return json;
}

// The objects that were touched, the one with the largest force first. One that has a name in
// several scenes is one object.
std::vector<loop::TouchedTotal> by_force(const Scenes& scenes, const loop::LoopStatistics& s) {
  std::vector<loop::TouchedTotal> totals;
  for (const loop::TouchedTotal& seen : s.touched.totals()) {
    const std::string name = scenes.object_name(seen.object);
    const auto same = std::find_if(totals.begin(), totals.end(), [&](const auto& total) {
      return !name.empty() && scenes.object_name(total.object) == name;
    });
    if (same == totals.end()) {
      totals.push_back(seen);
      continue;
    }
    same->frames += seen.frames;
    same->max_force_n = std::max(same->max_force_n, seen.max_force_n);
  }
  std::sort(totals.begin(), totals.end(),
            [](const auto& a, const auto& b) { return a.max_force_n > b.max_force_n; });
  return totals;
}

// The scenes in their order; null: no separation is guaranteed.
Json scenes_json(const Scenes& scenes) {
  Json json = Json::array();
  for (std::size_t n = 0; n < scenes.count(); ++n) {
    const UsedScene& scene = scenes[n];
    Json& one = json.emplace_back();
    put(one, "scene", scene.path);
    put(one, "from_s", scene.from_s);
    put(one, "guaranteed_separation_m", number(scene.guarantee.tested_m));
    put(one, "guaranteed_swept_separation_m", number(scene.guarantee.swept_m));
  }
  return json;
}

// Narrower features of the scene may lie between the points of the shell.
double narrowest_felt_m(const Scenes& scenes) {
  return 2 * scenes.first().simulation().shell().header().covering_radius_m;
}

double seconds_of(const Scenes& scenes, const loop::TouchedTotal& total) {
  return static_cast<double>(total.frames) / scenes.parameters().rate_hz;
}

Json names_json(const Scenes& scenes, const loop::TouchedInFrame& in_frame) {
  Json names = Json::array();
  for (const TouchedObject& touched : in_frame) {
    if (touched.object != 0) names.push_back(object_json(scenes, touched.object));
  }
  return names;
}

Json pull_json(const Scenes& scenes, const RunFacts& facts, const loop::LoopStatistics& s) {
  const std::optional<Pull>& pull = facts.outcome.pull;
  if (!pull) return nullptr;
  Json json;
  put(json, "led_m", pull->led_m);
  put(json, "went_m", pull->went_m);
  put(json, "held", pull->short_of_end());
  put(json, "against", names_json(scenes, s.touched_last));
  return json;
}

Json motion_json(const Scenes& scenes, const RunFacts& facts) {
  if (!facts.outcome.motion) return nullptr;
  const Followed& motion = *facts.outcome.motion;
  Json json;
  put(json, "followed", motion.is_followed());
  put(json, "held_off_m", motion.off_m);
  put(json, "held_off_rad", motion.off_rad);
  put(json, "t_s", motion.is_followed() ? Json(nullptr) : Json(motion.time_s));
  put(json, "against", names_json(scenes, motion.touched));
  return json;
}

void add_objects(const Scenes& scenes, const loop::LoopStatistics& s, Json& json) {
  put(json, "seated_frames", s.seated_frames);
  put(json, "guarantee_from_s", number(s.guarantee_from_s));
  Json& seat = json["seat"] = Json::array();
  for (const auto& of_seat : scenes.seat()) {
    Json& entry = seat.emplace_back();
    put(entry, "object", object_json(scenes, of_seat.object));
    put(entry, "overlap_m", of_seat.overlap_m + 0.0);  // no "-0.0"
    put(entry, "points", of_seat.points);
  }
  put(json, "narrowest_felt_m", narrowest_felt_m(scenes));
  Json& touched = json["touched_objects"] = Json::array();
  for (const loop::TouchedTotal& total : by_force(scenes, s)) {
    Json& entry = touched.emplace_back();
    put(entry, "name", scenes.object_text(total.object));
    put(entry, "seconds", seconds_of(scenes, total));
    put(entry, "max_force_n", total.max_force_n);
  }
}

// "touched A (0.3 s, up to 2 N), B (...)", the strongest first; nothing where none was named.
std::string touched_text(const Scenes& scenes, const loop::LoopStatistics& s) {
  constexpr std::size_t kNamed = 8;
  const auto totals = by_force(scenes, s);
  if (totals.empty()) return s.contact_frames == 0 ? "touched nothing\n" : "";
  std::string line;
  for (std::size_t i = 0; i < totals.size() && i < kNamed; ++i) {
    line += text("%s%s (%.3f s, up to %.3g N)", i == 0 ? "touched " : ", ",
                 scenes.shown_name(totals[i].object).c_str(), seconds_of(scenes, totals[i]),
                 totals[i].max_force_n);
  }
  if (totals.size() > kNamed) line += text(" and %zu more", totals.size() - kNamed);
  return line + "\n";
}

// Names the objects that the part is seated on, and the depth where it is more than rounding. Empty
// without a seat.
std::string seated_text(const Scenes& scenes, const RunFacts& facts) {
  if (scenes.seat().empty()) return "";
  const char* const of_seat = scenes.seat().size() == 1 ? "this object" : "these objects";
  return text(
      "%s%s\nin the seat, rods and ribs of %s narrower than %.3g mm may pass between the part's "
      "points, and objects behind %s are not felt\n",
      facts.options.start.world_from_seat ? "the part's seat is on " : "the part is seated on ",
      seat_text(scenes, 0.1 * scenes.parameters().voxel_size_m).c_str(), of_seat,
      1000 * narrowest_felt_m(scenes), of_seat);
}

// When the guarantee holds; where nothing is guarded, it is no fact about every frame.
const char* guarantee_title(const Scenes& scenes) {
  if (scenes.parameters().model == Model::kPaper) {
    return "guaranteed separation while no point penetrates (this model has no guard): ";
  }
  return scenes.seat().empty() ? "guaranteed separation: "
                               : "guaranteed separation, once the part has left its seat: ";
}

}  // namespace

std::string start_text(const Scenes& scenes, const RunFacts& facts) {
  const VoxmapHeader& map = scenes.first().simulation().voxmap().header();
  const PshellHeader& shell = scenes.first().simulation().shell().header();
  const Parameters& p = scenes.parameters();
  const std::string begin = has_standoff(map) ? text("standoff %.4g mm", map.zero_force_m * 1000)
                                              : text("%u offset layers", map.offset_layers);
  return text("scene: voxels of %.4g mm, %s, %llu force-layer voxels\n", map.voxel_size_m * 1000,
              begin.c_str(), static_cast<unsigned long long>(map.surface_voxels)) +
         text("part: %llu points, covering radius %.4g mm, %.4g mm across\n",
              static_cast<unsigned long long>(shell.point_count), shell.covering_radius_m * 1000,
              2000 * shell.bounding_radius_m) +
         text(
             "model %s, force %s, %.6g Hz, device %s: coupling %.4g N/m, field %.4g N/m, mass %.3g "
             "g\n",
             std::string(to_text(p.model)).c_str(), std::string(to_text(p.force)).c_str(),
             p.rate_hz, facts.device.c_str(), p.coupling_n_per_m, p.field_n_per_m,
             p.mass_kg * 1000) +
         (facts.capabilities ? capabilities_text(*facts.capabilities) : std::string()) +
         seated_text(scenes, facts) + guarantee_title(scenes) + guarantee_text(scenes.guarantee()) +
         "\n";
}

std::string end_text(const Scenes& scenes, const RunFacts& facts, const loop::LoopStatistics& s) {
  const auto ratio = penetration_ratio(s);
  const auto us = [](std::uint64_t ns) { return static_cast<double>(ns) / 1000; };
  std::string lines =
      text(
          "frames %llu, in the force layer %llu, penetrating %llu (%s of the force-layer "
          "frames)\n",
          static_cast<unsigned long long>(s.frames),
          static_cast<unsigned long long>(s.force_layer_frames),
          static_cast<unsigned long long>(s.penetration_frames),
          ratio ? text("%.3g", *ratio).c_str() : "none") +
      text("step p50 %.1f us, p99 %.1f us, p99.9 %.1f us, max %.1f us\n",
           us(s.step.quantile_ns(0.5)), us(s.step.quantile_ns(0.99)), us(s.step.quantile_ns(0.999)),
           us(s.step.max_ns())) +
      text("largest force %.3g N, torque %.3g N m\n", s.max_force_n, s.max_torque_nm) +
      text("energy generated %.3g J in %llu contact episodes, at most %.3g J in one\n",
           s.generated_j, static_cast<unsigned long long>(s.contact_episodes),
           s.worst_episode_generated_j);
  if (!facts.options.guide.empty()) {
    lines += text(
        "guided in %llu frames by up to %.3g N; the guide gave the hand %.3g J of the allowed %.3g "
        "J\n",
        static_cast<unsigned long long>(s.guided_frames), s.max_guide_force_n, s.guide_given_j,
        s.guide_allowed_j);
  }
  const auto mib = [](std::uint64_t bytes) { return static_cast<double>(bytes) / (1 << 20); };
  lines += text("scene in memory %.3g MiB\n", mib(facts.scene_file_bytes));
  if (!facts.options.as_fast_as_possible) {
    lines += text("deadline misses %llu, wake-up delay p99 %.1f us, max %.1f us\n",
                  static_cast<unsigned long long>(s.deadline_misses),
                  us(s.wakeup.quantile_ns(0.99)), us(s.wakeup.max_ns()));
    if (s.deadline_misses > 0) lines += misses_text(s);
  }
  lines += touched_text(scenes, s);
  if (facts.output_trips > 0) {
    lines += text("the output tripped %llu times; last cause: %s\n",
                  static_cast<unsigned long long>(facts.output_trips), to_text(facts.last_trip));
  }
  return lines;
}

Json report_json(const Scenes& scenes, const RunFacts& facts, const loop::LoopStatistics& s) {
  Json json;
  put(json, "version", command::kVersion);
  put(json, "scene", facts.options.run.scene.string());
  put(json, "scenes", scenes_json(scenes));
  put(json, "part", facts.options.run.part.string());
  put(json, "device", facts.device);
  put(json, "device_capabilities",
      facts.capabilities ? capabilities_json(*facts.capabilities) : Json(nullptr));
  put(json, "model", to_text(scenes.parameters().model));
  put(json, "force", to_text(scenes.parameters().force));
  put(json, "frames", s.frames);
  put(json, "force_layer_frames", s.force_layer_frames);
  put(json, "penetration_frames", s.penetration_frames);
  const command::Verdict verdict = verdict_of(scenes, facts.outcome, s);
  put(json, "verdict", run_word(verdict));
  put(json, "kind", command::to_text(verdict.kind));
  put(json, "sentence", command::sentence(verdict));
  put(json, "blocked_by", verdict.blocked_by);
  put(json, "pull", pull_json(scenes, facts, s));
  put(json, "motion", motion_json(scenes, facts));
  put(json, "penetration_ratio", number(penetration_ratio(s)));
  put(json, "contact_frames", s.contact_frames);
  put(json, "guard_cuts", s.guard_cuts);
  put(json, "barred_frames", s.barred_frames);
  put(json, "min_clearance", clearance_json(scenes, s));
  put(json, "unproven_frames", s.unproven_frames);
  put(json, "outside_map_frames", s.outside_map_frames);
  add_objects(scenes, s, json);
  put(json, "saturated_frames", s.saturated_frames);
  put(json, "faulty_frames", s.faulty_frames);
  put(json, "guaranteed_separation_m", number(scenes.guarantee().tested_m));
  put(json, "guaranteed_swept_separation_m", number(scenes.guarantee().swept_m));
  put(json, "missing_faces",
      command::missing_faces_in(scenes.first().simulation().voxmap().provenance()) +
          command::missing_faces_in(scenes.first().simulation().shell().provenance()));
  put(json, "pose_error_m", scenes.first().simulation().query().rounding_bound_m());
  put(json, "step_ns", percentiles(s.step));
  put(json, "threads", facts.options.run.threads);
  put(json, "instruction_set", query::kernel_target());
  put(json, "as_fast_as_possible", facts.options.as_fast_as_possible);
  add_clock(facts, s, json);
  put(json, "max_force_n", s.max_force_n);
  put(json, "max_torque_nm", s.max_torque_nm);
  add_output(facts, s, json);
  put(json, "guided_frames", s.guided_frames);
  put(json, "max_guide_force_n", s.max_guide_force_n);
  put(json, "max_guide_torque_nm", s.max_guide_torque_nm);
  put(json, "guide_given_j", s.guide_given_j);
  put(json, "guide_allowed_j", s.guide_allowed_j);
  put(json, "energy_generated_j", s.generated_j);
  put(json, "contact_episodes", s.contact_episodes);
  put(json, "energy_generated_worst_episode_j", s.worst_episode_generated_j);
  put(json, "outcome_hash", text("%016llx", static_cast<unsigned long long>(s.outcome_hash)));
  put(json, "wall_s", facts.wall_s);
  put(json, "peak_rss_bytes", command::peak_rss_bytes());
  put(json, "scene_file_bytes", facts.scene_file_bytes);
  put(json, "parameters", parameters_json(scenes.parameters()));
  put(json, "parameter_reasons", scenes.first().reasons());
  put(json, "warnings", facts.warnings);
  return json;
}

}  // namespace forcelayer::voxrun
