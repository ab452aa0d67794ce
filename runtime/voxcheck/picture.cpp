#include "runtime/voxcheck/picture.h"

#include "formats/command/program.h"
#include "formats/command/text.h"
#include "runtime/voxcheck/object_names.h"

namespace forcelayer::voxcheck {
namespace {

using clearance::CheckedMoment;
using command::text;

std::string point_text(const glm::dvec3& p) { return text("%.17gm,%.17gm,%.17gm", p.x, p.y, p.z); }

std::string pose_text(const Pose& pose) {
  const glm::dquat& q = pose.orientation;
  return point_text(pose.position_m) + text(",%.17g,%.17g,%.17g,%.17g", q.w, q.x, q.y, q.z);
}

// The moment that is drawn, and what the meshes say of it.
struct Shown {
  CheckedMoment moment;
  const ExactMoment* exact = nullptr;
  const clearance::Violation* deep = nullptr;  // how deep it goes into something is known
  bool object_inside = false;                  // the object lies inside the part
};

Shown shown_of(const Report& report) {
  // A seat that is not settled has no worst moment.
  const clearance::CheckResult& result = report.checked.result;
  if (!result.clear() && !worst_of(report.checked).unsettled_seat) {
    const auto& worst = worst_of(report.checked);
    const ExactViolation* exact = exact_of(report.checked, worst);
    return {worst.worst, exact != nullptr ? &exact->worst : nullptr,
            worst.depth_m > 0 ? &worst : nullptr, worst.object_inside};
  }
  const ToldMoment told = told_moment(report.checked);
  return {told.moment, told.exact};
}

// The line between the two nearest points; without the meshes a dot at the part's.
std::vector<std::string> measure(const Report& report, const Shown& shown) {
  const CheckedMoment& moment = shown.moment;
  if (moment.object == 0 && shown.exact == nullptr) return {};
  const glm::dvec3 part = moment.point_m;
  glm::dvec3 object = part;
  std::string words = command::length_text(moment.clearance_m) + " proven";
  if (shown.exact != nullptr) {
    const auto& p = shown.exact->scene_m;
    object = {p[0], p[1], p[2]};
    words = command::length_text(shown.exact->exact_m);
  }
  if (shown.object_inside) words = "inside the part";
  if (shown.deep != nullptr) words = command::length_text(shown.deep->depth_m) + " deep";
  std::vector<std::string> options{"--measure", point_text(part) + "," + point_text(object),
                                   "--measure-words", words};
  if (moment.object != 0) {
    options.insert(options.end(),
                   {"--measure-object", object_name(report.checked.scene, moment.object)});
  }
  return options;
}

// The arguments of voxview that name the meshes and files to draw.
std::vector<std::string> inputs_of(const Options& options) {
  std::vector<std::string> arguments{"draw"};
  arguments.insert(arguments.end(), options.meshes.begin(), options.meshes.end());
  arguments.insert(arguments.end(), {options.scene, options.part});
  for (const std::string& node : options.without) {
    arguments.insert(arguments.end(), {"--hide", node});
  }
  if (options.meshes.empty()) {
    arguments.insert(arguments.end(), {"--show", "interior,shell"});
    return arguments;
  }
  const auto add_unit = [&](const char* option, const std::string& unit) {
    if (!unit.empty()) arguments.insert(arguments.end(), {option, unit});
  };
  add_unit("--units", options.units);
  add_unit("--part-units", options.part_units);
  const bool one = options.part_meshes.size() == 1;  // voxview takes no more
  if (one) arguments.insert(arguments.end(), {"--part", options.part_meshes[0]});
  arguments.insert(arguments.end(), {"--show", one ? "meshes,part" : "meshes,shell"});
  return arguments;
}

}  // namespace

Status draw_picture(const Report& report, const command::Verdict& verdict) {
  const clearance::CenterPath& path = report.checked.path;
  const Options& options = report.options;
  const Shown shown = shown_of(report);
  const auto& c = report.checked.part.header().center_m;
  const Pose world_from_part = path.world_from_center(path.at(shown.moment.time_s)) *
                               inverse(Pose{glm::dvec3(c[0], c[1], c[2]), {1, 0, 0, 0}});
  std::vector<std::string> arguments = inputs_of(options);
  const auto add = [&](const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
  };
  add({"--part-pose", pose_text(world_from_part)});
  add(measure(report, shown));
  for (const std::string& line : picture_title(verdict)) add({"--title", line});
  add({"--screenshot", options.picture, "--size", "1200x800", "--quiet"});
  const auto end = command::run_program("voxview", arguments, "", command::ProgramOutput::kTaken,
                                        "forcelayer-viewer");
  if (!end) return end.error();
  if (end->status == 0) return {};
  return Error{ErrorCode::kInternal, options.picture, "--report picture",
               "voxview ended with status " + std::to_string(end->status), "see the error above"};
}

}  // namespace forcelayer::voxcheck
