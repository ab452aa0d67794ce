#include "workbench/viewer/plan/options.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <glm/geometric.hpp>

#include "formats/command/arguments.h"
#include "formats/command/quantity.h"
#include "formats/command/version.h"
#include "formats/mesh/step_support.h"

namespace forcelayer::viewer {
namespace {

using command::about;

constexpr int kSmallestPicture = 64, kLargestPicture = 8192;  // pixels a side
constexpr double kSmallestScale = 0.5, kLargestScale = 8;     // of words and marks

Error usage(const std::string& option, const std::string& what, const std::string& mend) {
  return {ErrorCode::kUsage, "", option, what, mend};
}

Result<std::optional<Pose>> pose_of(const char* option, const std::string& text) {
  if (text.empty()) return std::optional<Pose>();
  const auto pose = command::parse_pose(text);
  if (!pose) return about(option, pose.error());
  const auto& p = pose->position_m;
  const auto& q = pose->orientation_wxyz;
  return std::optional<Pose>(Pose{{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}});
}

Result<std::optional<double>> unit_of(const std::string& text) {
  if (text.empty()) return std::optional<double>();
  const auto unit_m = command::parse_unit(text);
  if (!unit_m) return unit_m.error();
  return std::optional<double>(*unit_m);
}

Status read_size(const std::string& text, ViewOptions& options) {
  char at = 0, end = 0;
  double scale = 0;
  const int read =
      std::sscanf(text.c_str(), "%dx%d%c%lf%c", &options.width, &options.height, &at, &scale, &end);
  const bool is_scaled =
      read == 4 && at == '@' && scale >= kSmallestScale && scale <= kLargestScale;
  for (const int side : {options.width, options.height}) {
    if ((read != 2 && !is_scaled) || side < kSmallestPicture || side > kLargestPicture) {
      return usage("--size", "'" + text + "' is not a picture size",
                   "write it like 1600x1000 or 1600x1000@2: both sides from 64 to 8192 pixels, the "
                   "scale from 0.5 to 8");
    }
  }
  if (is_scaled) options.scale = scale;
  return {};
}

}  // namespace

ViewOptionParser::ViewOptionParser(CLI::App& app, Program program) {
  command::set_version(app, mesh::kStepSupport);
  app.add_option("INPUT", options_.inputs.inputs,
                 "meshes, scene manifests, one .vox, one .pshell, in any order");
  app.add_option("--compare", options_.inputs.before,
                 "an earlier .vox: show where the force layer has grown or shrunk since then");
  app.add_option("--part", options_.inputs.part, "mesh of the moving part");
  app.add_option("--units", texts_.units, command::kUnitsHelp);
  app.add_option(
      "--screenshot", options_.screenshot,
      "write a picture (PNG) and end. With turntable:FILE, an animated PNG is written, in which "
      "the camera goes once around z");
  app.add_option("--json", options_.json, "write the facts of the picture as numbers to this file");
  app.add_option(
         "--size", texts_.size,
         "size of the picture in pixels. WIDTHxHEIGHT@SCALE also scales text and marks (@2 suits "
         "192 pixels an inch). Default SCALE: the screen's Xft.dpi / 96 for a window, 1 for a "
         "file")
      ->capture_default_str();
  auto* run =
      app.add_option("--trace,--replay", options_.run,
                     "the run to show: a trace or a recording of voxrun, or a path of the part");
  app.add_option("--at", texts_.at,
                 "time in the run, such as 2.5s; default: the moment of the smallest proven "
                 "clearance, or else of the strongest force")
      ->needs(run);
  app.add_option("--listen", options_.listen,
                 "follow a run: [ADDRESS:]PORT that voxrun --udp sends to. --screenshot takes its "
                 "picture after 3s")
      ->excludes(run);
  app.add_option("--path", options_.path,
                 "a path of the part to draw as a line, such as one of voxplan");
  app.add_option("--part-pose", texts_.part_pose,
                 "pose world_from_part: x,y,z or x,y,z,qw,qx,qy,qz")
      ->excludes(run);
  app.add_option("--view-from", texts_.view_from,
                 "direction from the scene to the camera, such as 1,-1,0.5; default: the direction "
                 "that shows most");
  app.add_option("--cut", texts_.cut, "show only one side of a plane, such as z<300mm or x>0m");
  app.add_option("--show", texts_.shown,
                 "list of meshes, interior, force-layer, proximity, part, shell, contacts, handle; "
                 "the default depends on the files");
  app.add_option("--hide", options_.hide,
                 "hide an object of the scene, by its name in voxelize --list; repeatable")
      ->allow_extra_args(false);
  app.add_option("--only", options_.only, "show only this object; repeatable")
      ->allow_extra_args(false);
  app.add_flag("--quiet", options_.quiet, "print nothing but errors");
  if (program == Program::kDraw) add_draw_options(app);
}

void ViewOptionParser::add_draw_options(CLI::App& app) {
  app.add_option("--part-units", texts_.part_units,
                 "unit of the mesh of --part, if it differs from --units");
  app.add_option("--focus", texts_.focus,
                 "center of the picture: part or scene; auto is the part if there is one")
      ->check(CLI::IsMember({"auto", "part", "scene"}))
      ->capture_default_str();
  app.add_option("--color", texts_.color,
                 "colors of the scene's meshes: one (the same for all) or object (one for each)")
      ->check(CLI::IsMember({"one", "object"}))
      ->capture_default_str();
  app.add_option("--duration", texts_.duration,
                 "close the window, or take the picture, after this time. By default a window "
                 "stays open, and a picture of a stream is taken after 3s");
  app.add_option(
      "--frame-times", options_.frame_times,
      "turn the scene once in the window, write the frame times to this file (JSON), and end");
  app.add_option("--pixels-per-voxel", texts_.pixels_per_voxel,
                 "scale of the picture. By default, the part or scene of --focus fills the picture")
      ->check(CLI::Range(1, 1000));
  app.add_option("--measure", texts_.measure,
                 "x0,y0,z0 (part), x1,y1,z1 (scene): draw the distance between these points");
  app.add_option("--measure-object", texts_.measure_object,
                 "name of the object at the second point; this object gets its own color");
  app.add_option("--measure-words", texts_.measure_words,
                 "text beside the distance; default: its value");
  app.add_option("--title", options_.title, "a line of text above the picture; repeatable")
      ->allow_extra_args(false);
  app.add_flag("--plain", options_.plain,
               "flat opaque colors and no text, so that pixels can be counted");
}

Status ViewOptionParser::read_units(ViewOptions& options) const {
  const auto unit_m = unit_of(texts_.units);
  if (!unit_m) return unit_m.error();
  const auto part_unit_m = unit_of(texts_.part_units);
  if (!part_unit_m) return part_unit_m.error();
  options.inputs.unit_m = *unit_m;
  options.inputs.part_unit_m = *part_unit_m;
  return {};
}

Status ViewOptionParser::read_moment(ViewOptions& options) const {
  const auto pose = pose_of("--part-pose", texts_.part_pose);
  if (!pose) return pose.error();
  options.world_from_part = *pose;
  if (!texts_.at.empty()) {
    const auto at_s = command::parse_duration(texts_.at);
    if (!at_s) return about("--at", at_s.error());
    options.at_s = *at_s;
  }
  if (!texts_.duration.empty()) {
    const auto duration_s = command::parse_duration(texts_.duration);
    if (!duration_s) return about("--duration", duration_s.error());
    options.duration_s = *duration_s;
  }
  return {};
}

Status ViewOptionParser::read_camera(ViewOptions& options) const {
  if (Status size = read_size(texts_.size, options); !size) return size;
  if (texts_.focus == "part") options.focus = Focus::kPart;
  if (texts_.focus == "scene") options.focus = Focus::kScene;
  if (!texts_.view_from.empty()) {
    const auto given = command::parse_direction(texts_.view_from);
    if (!given) return about("--view-from", given.error());
    const glm::dvec3 direction((*given)[0], (*given)[1], (*given)[2]);
    if (!(glm::length(direction) > 0)) {
      return usage("--view-from", "the direction has no length", "write it like 1,-1,0.5");
    }
    options.to_eye = direction;
  }
  if (texts_.pixels_per_voxel > 0) options.pixels_per_voxel = texts_.pixels_per_voxel;
  if (!texts_.cut.empty()) {
    const auto cut = parse_cut(texts_.cut);
    if (!cut) return cut.error();
    options.cut = *cut;
  }
  if (!texts_.shown.empty()) {
    const auto shown = parse_items(texts_.shown);
    if (!shown) return shown.error();
    options.shown = *shown;
  }
  return {};
}

Status ViewOptionParser::read_measure(ViewOptions& options) const {
  if (texts_.measure.empty()) {
    if (texts_.measure_object.empty() && texts_.measure_words.empty()) return {};
    return usage("--measure", "is missing", "give the two points");
  }
  const std::string_view text = texts_.measure;
  std::size_t half = 0;  // behind the third comma
  for (int commas = 0; half < text.size() && commas < 3; ++half) commas += text[half] == ',';
  const auto part = command::parse_point(text.substr(0, half == 0 ? 0 : half - 1));
  const auto object = command::parse_point(text.substr(half));
  if (!part || !object) {
    return usage("--measure", "'" + texts_.measure + "' is not two points",
                 "write x0,y0,z0,x1,y1,z1 with units, like 0,0,1mm,0,0,5mm");
  }
  const auto point = [](const auto& p) { return glm::dvec3(p[0], p[1], p[2]); };
  options.measure = {point(*part), point(*object), texts_.measure_object, texts_.measure_words};
  if (options.measure->words.empty()) {
    char words[40];
    std::snprintf(words, sizeof words, "%.3f mm",
                  1e3 * glm::length(options.measure->part_m - options.measure->object_m));
    options.measure->words = words;
  }
  return options.screenshot.empty()
             ? usage("--measure", "has no effect without --screenshot", "give both")
             : Status();
}

Result<ViewOptions> ViewOptionParser::finish() const {
  ViewOptions options = options_;
  if (Status units = read_units(options); !units) return units.error();
  if (Status moment = read_moment(options); !moment) return moment.error();
  if (Status camera = read_camera(options); !camera) return camera.error();
  if (Status measure = read_measure(options); !measure) return measure.error();
  options.color_objects = texts_.color == "object";
  constexpr std::string_view kTurntable = "turntable:";
  if (options.screenshot.starts_with(kTurntable)) {
    options.turntable = options.screenshot.substr(kTurntable.size());
    options.screenshot.clear();
  }
  if (options.inputs.inputs.empty()) {
    return usage("", "no file to show is given", "give meshes, a manifest, a .vox or a .pshell");
  }
  if (!options.json.empty() && options.screenshot.empty()) {
    return usage("--json", "has no effect without --screenshot", "give both");
  }
  return options;
}

}  // namespace forcelayer::viewer
