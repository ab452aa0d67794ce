// voxview: shows scenes, baked files and runs, on a screen or as a picture.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"
#include "formats/command/quantity.h"
#include "runtime/viewer/trace.h"
#include "runtime/viewer/virtual_screen.h"
#include "runtime/viewer/vtk_picture.h"

namespace forcelayer {
namespace {

struct Options {
  ViewInputs inputs;
  std::string units, part_units;
  std::string screenshot, size = "1600x1000";
  std::string trace, at, part_pose;
  std::string view_from, focus = "auto";
  bool plain = false;
};

// "1600x1000".
Status parse_size(const std::string& text, PictureOptions& picture) {
  char end = 0;
  const int read = std::sscanf(text.c_str(), "%dx%d%c", &picture.width, &picture.height, &end);
  constexpr int kLargest = 8192;
  if (read != 2 || picture.width < 64 || picture.height < 64 || picture.width > kLargest ||
      picture.height > kLargest) {
    return Error{ErrorCode::kUsage, "", "--size", "'" + text + "' is no picture size",
                 "give pixels as 1600x1000, each 64 to 8192"};
  }
  return {};
}

Pose pose_of(const PoseText& text) {
  const auto& p = text.position_m;
  const auto& q = text.orientation_wxyz;
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
}

Result<std::optional<double>> unit_of(const std::string& text) {
  if (text.empty()) return std::optional<double>();
  const auto unit_m = parse_unit(text);
  if (!unit_m) return unit_m.error();
  return std::optional<double>(*unit_m);
}

std::string text_of(const char* form, auto... values) {
  char text[256];
  std::snprintf(text, sizeof text, form, values...);
  return text;
}

// The moment that --part-pose or --trace and --at ask for, and its words.
Result<std::optional<Moment>> moment_of(const Options& options, const ViewScene& scene,
                                        std::vector<std::string>& title) {
  std::optional<Moment> moment;
  if (!options.part_pose.empty()) {
    const auto pose = parse_pose(options.part_pose);
    if (!pose) return pose.error();
    moment = Moment{pose_of(*pose), {}, {}, {}};
  } else if (!options.trace.empty()) {
    const auto rows = read_trace(options.trace);
    if (!rows) return rows.error();
    std::size_t at = strongest_row(*rows);
    if (!options.at.empty()) {
      const auto time_s = parse_duration(options.at);
      if (!time_s) return time_s.error();
      at = row_at(*rows, *time_s);
    }
    const TraceRow& row = (*rows)[at];
    // The trace does not hold the grip; the part starts without stretch, which gives it.
    const Pose grip = inverse(rows->front().world_from_handle) * rows->front().world_from_part;
    moment = Moment{row.world_from_part, row.world_from_handle * grip, row.on_hand, {}};
    title.push_back(text_of("t = %.3f s    force on the hand %.2f N    torque %.4f N m", row.time_s,
                            glm::length(row.on_hand.force_n), glm::length(row.on_hand.torque_nm)));
  }
  if (moment && scene.voxmap && scene.shell) {
    auto field = make_force_field(Model::kPaper, ForceKind::kTangentPlane, *scene.voxmap);
    if (!field) return field.error();
    ContactProbe probe(*scene.voxmap, *scene.shell, std::move(*field));
    moment->contacts = probe.at(moment->world_from_part);
    const ContactView& view = moment->contacts;
    title.push_back(
        text_of("%s    %u contacts, deepest %.2f mm    points: %u force layer, %u "
                "proximity, %u interior",
                frame_kind_name(view.kind()), view.contacts, 1e3 * view.deepest_m, view.surface,
                view.proximity, view.interior));
  }
  return moment;
}

// Points that a picture of the part should not lose behind the scene: contacts, or else the shell.
std::vector<glm::dvec3> points_to_see(const ViewScene& scene, const Moment& moment) {
  std::vector<glm::dvec3> points;
  for (const ViewPoint& point : moment.contacts.points) points.push_back(point.position_m);
  const PshellView& shell = scene.shell->view();
  const Pose center = world_from_center(moment.world_from_part, *scene.shell);
  const std::uint64_t stride = 1 + shell.point_count / 400;
  for (std::uint64_t n = 0; n < shell.point_count; n += stride) {
    points.push_back(center.position_m +
                     center.orientation * glm::dvec3(shell.x[n], shell.y[n], shell.z[n]));
  }
  return points;
}

glm::dvec3 sum_of_forces(const ContactView& contacts) {
  glm::dvec3 sum(0);
  for (const ViewPoint& point : contacts.points) sum += point.depth_m * point.direction;
  return sum;
}

Result<CameraView> camera_of(const Options& options, const ViewScene& scene,
                             const std::optional<Moment>& moment, double aspect) {
  std::optional<glm::dvec3> direction;
  if (!options.view_from.empty()) {
    const auto given = parse_point(options.view_from);
    if (!given) return given.error();
    direction = glm::dvec3((*given)[0], (*given)[1], (*given)[2]);
    if (!(glm::length(*direction) > 0)) {
      return Error{ErrorCode::kUsage, "", "--view-from", "the direction has no length", ""};
    }
  }
  const bool on_part = options.focus != "scene" && moment && scene.shell;
  if (!on_part) return frame_box(scene.bounds, direction.value_or(default_direction()), aspect);
  const double radius_m = scene.shell->header().bounding_radius_m;
  if (!direction) {
    direction = scene.voxmap
                    ? clearest_direction(*scene.voxmap, points_to_see(scene, *moment),
                                         sum_of_forces(moment->contacts),
                                         glm::length(scene.bounds.high_m - scene.bounds.low_m))
                    : default_direction();
  }
  CameraView view = camera_along(*direction);
  view.target_m = world_from_center(moment->world_from_part, *scene.shell).position_m;
  view.half_height_m = 2.2 * radius_m;
  return view;
}

std::string scene_line(const ViewScene& scene) {
  std::string line = scene.voxmap_name;
  if (scene.voxmap) {
    const VoxmapHeader& header = scene.voxmap->header();
    line += text_of(": %g mm voxels, %u offset layers, %llu force-layer voxels",
                    1e3 * header.voxel_size_m, header.offset_layers,
                    static_cast<unsigned long long>(header.surface_voxels));
  }
  if (scene.shell) {
    if (!line.empty()) line += "    ";
    line += scene.shell_name + text_of(": %llu points", static_cast<unsigned long long>(
                                                            scene.shell->header().point_count));
  }
  return line.empty() ? "scene" : line;
}

Status take_picture(const Options& options, const ViewScene& scene) {
  PictureOptions picture;
  if (Status size = parse_size(options.size, picture); !size) return size;
  picture.title = {scene_line(scene)};
  const auto moment = moment_of(options, scene, picture.title);
  if (!moment) return moment.error();
  const double aspect = static_cast<double>(picture.width) / picture.height;
  const auto camera = camera_of(options, scene, *moment, aspect);
  if (!camera) return camera.error();
  picture.camera = *camera;
  picture.shown = default_shown(scene);
  picture.plain = options.plain;
  return write_picture(options.screenshot, scene, *moment, picture);
}

Status run(Options options, char** argv) {
  const auto unit = unit_of(options.units);
  if (!unit) return unit.error();
  const auto part_unit = unit_of(options.part_units);
  if (!part_unit) return part_unit.error();
  options.inputs.unit_m = *unit;
  options.inputs.part_unit_m = *part_unit;
  const auto scene = load_view_scene(options.inputs);
  if (!scene) return scene.error();
  for (const std::string& warning : scene->warnings) {
    std::fprintf(stderr, "voxview: warning: %s\n", warning.c_str());
  }
  if (Status screen = ensure_screen(argv); !screen) return screen;
  return take_picture(options, *scene);
}

}  // namespace
}  // namespace forcelayer

int main(int argc, char** argv) {
  forcelayer::Options options;
  CLI::App app{"Show scenes, baked files and runs", "voxview"};
  app.add_option("INPUT", options.inputs.inputs, "meshes, one .vox, one .pshell")->required();
  app.add_option("--part", options.inputs.part, "mesh of the moving part");
  app.add_option("--units", options.units, "unit of the meshes' coordinates (mm, cm, m, in ...)");
  app.add_option("--part-units", options.part_units, "unit of --part where it is another");
  app.add_option("--screenshot", options.screenshot, "write a picture (PNG) and end")->required();
  app.add_option("--size", options.size, "of the picture in pixels")->capture_default_str();
  auto* trace =
      app.add_option("--trace", options.trace, "the run to show, as voxrun --trace wrote");
  app.add_option("--at", options.at, "time in the run (2.5s); default: the strongest force")
      ->needs(trace);
  app.add_option("--part-pose", options.part_pose, "world_from_part: x,y,z or x,y,z,qw,qx,qy,qz")
      ->excludes(trace);
  app.add_option("--view-from", options.view_from, "direction towards the eye, as 1,-1,0.5");
  app.add_option("--focus", options.focus, "part or scene; auto: the part where there is one")
      ->check(CLI::IsMember({"auto", "part", "scene"}))
      ->capture_default_str();
  app.add_flag("--plain", options.plain, "flat opaque colours, no words: for measuring");
  int exit_code = 0;
  if (!forcelayer::parse_arguments(app, argc, argv, exit_code)) return exit_code;
  return forcelayer::run_command("voxview", [&] { return forcelayer::run(options, argv); });
}
