#include "workbench/viewer/plan/picture_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "formats/command/spelling/spelling.h"
#include "formats/mesh/node_names.h"
#include "formats/path/path_file.h"
#include "runtime/stream/recording.h"
#include "runtime/stream/replay.h"
#include "workbench/viewer/plan/legend.h"

namespace forcelayer::viewer {
namespace {

constexpr double kMeasureMargin = 1.3;  // half of a picture's height, over the end of a measure

// Where the part's middle goes: the centroid of its shell, else of its mesh's corners, else its
// origin.
Result<std::vector<glm::dvec3>> plan_path(const std::string& path, const ViewScene& scene) {
  std::vector<glm::dvec3> places_m;
  if (path.empty()) return places_m;
  const auto rows = read_path(path, PathOf::kPart);
  if (!rows) return rows.error();
  glm::dvec3 middle_m(0);
  if (scene.shell) {
    const auto& center = scene.shell->header().center_m;
    middle_m = {center[0], center[1], center[2]};
  } else if (scene.part && !scene.part->points.empty()) {
    for (const auto& point : scene.part->points)
      middle_m += glm::dvec3(point[0], point[1], point[2]);
    middle_m /= static_cast<double>(scene.part->points.size());
  }
  for (const PathRow& row : *rows) {
    const auto& p = row.position_m;
    const auto& q = row.orientation_wxyz;
    places_m.push_back(glm::dvec3(p[0], p[1], p[2]) +
                       glm::dquat(q[0], q[1], q[2], q[3]) * middle_m);
  }
  return places_m;
}

// Errors: kUsage for a time that the run does not have.
Result<std::optional<Moment>> plan_moment(const ViewOptions& options,
                                          const std::vector<TraceRow>& rows) {
  std::optional<Moment> moment;
  if (options.world_from_part) {
    moment.emplace();
    moment->world_from_part = *options.world_from_part;
  } else if (!rows.empty()) {
    const double first_s = rows.front().time_s, last_s = rows.back().time_s;
    // As far beyond the last row as this is from the one before: it was then not over yet.
    const double frame_s = rows.size() > 1 ? last_s - rows[rows.size() - 2].time_s : 0;
    if (options.at_s && !(*options.at_s >= first_s && *options.at_s <= last_s + frame_s)) {
      return Error{ErrorCode::kUsage, options.run, "--at",
                   text_of("the run does not contain the time %g s", *options.at_s),
                   text_of("give a time from %g s to %g s", first_s, last_s)};
    }
    const NotableRows notable = notable_rows(rows);
    const std::size_t at = options.at_s ? row_at(rows, *options.at_s) : notable.usual();
    moment = moment_of(rows[at], grip_of(rows.front()));
    moment->name = notable.name_of(at);
  }
  return moment;
}

// Points that a picture of the part should not lose behind the scene: contacts and the shell.
std::vector<glm::dvec3> points_to_see(const ViewScene& scene, const Moment& moment) {
  constexpr std::uint64_t kEnough = 400;
  std::vector<glm::dvec3> points;
  for (const ViewPoint& point : moment.contacts.points) points.push_back(point.position_m);
  const PshellView& shell = scene.shell->view();
  const Pose center = world_from_center(moment.world_from_part, *scene.shell);
  const std::uint64_t stride = 1 + shell.point_count / kEnough;
  for (std::uint64_t n = 0; n < shell.point_count; n += stride) {
    points.push_back(center.position_m +
                     center.orientation * glm::dvec3(shell.x[n], shell.y[n], shell.z[n]));
  }
  return points;
}

// Best seen from the side: what is measured, else the contacts' force, else the clearance.
glm::dvec3 seen_across(const ViewOptions& options, const ContactView& contacts) {
  if (options.measure) return options.measure->object_m - options.measure->part_m;
  if (contacts.contacts == 0) return contacts.nearest_scene_m - contacts.nearest_m;
  glm::dvec3 sum(0);
  for (const ViewPoint& point : contacts.points) sum += point.depth_m * point.direction;
  return sum;
}

// Where the eye is by default: with a cut, on the side that it takes away.
glm::dvec3 usual_direction(const ViewOptions& options) {
  glm::dvec3 direction = default_direction();
  if (options.cut) {
    double& across = direction[options.cut->axis];
    across = options.cut->keep_low ? std::abs(across) : -std::abs(across);
  }
  return direction;
}

CameraView part_camera(const ViewOptions& options, const ViewScene& scene, const Moment& moment) {
  glm::dvec3 direction = options.to_eye.value_or(usual_direction(options));
  if (!options.to_eye && !options.cut && scene.voxmap) {
    direction = clearest_direction(*scene.voxmap, points_to_see(scene, moment),
                                   seen_across(options, moment.contacts),
                                   glm::length(scene.bounds.high_m - scene.bounds.low_m));
  }
  CameraView view = camera_along(direction);
  view.target_m = world_from_center(moment.world_from_part, *scene.shell).position_m;
  view.half_height_m = kPartFocus * scene.shell->header().bounding_radius_m;
  if (options.measure) {
    const double away_m = glm::length(options.measure->object_m - view.target_m);
    view.half_height_m = std::max(view.half_height_m, kMeasureMargin * away_m);
  }
  return view;
}

CameraView plan_camera(const ViewOptions& options, const ViewScene& scene,
                       const std::optional<Moment>& moment) {
  const bool on_part = options.focus != Focus::kScene && moment && scene.shell;
  CameraView view =
      on_part ? part_camera(options, scene, *moment)
              : frame_box(box_of(scene), options.to_eye.value_or(usual_direction(options)),
                          static_cast<double>(options.width) / options.height);
  if (options.pixels_per_voxel && scene.voxmap) {
    // Pixels line up with voxels seen along an axis.
    const double s = scene.voxmap->voxel_size_m();
    view.half_height_m = 0.5 * options.height * s / *options.pixels_per_voxel;
    for (int axis = 0; axis < 3; ++axis) {
      view.target_m[axis] = std::round(view.target_m[axis] / s) * s;
    }
  }
  return view;
}

Status plan_change(const ViewScene& scene, PicturePlan& plan) {
  auto change = layer_change(*scene.before, *scene.voxmap, VoxelValue::kSurface, scene.origin_m);
  if (!change) return change.error();
  plan.title = {scene.before_name + " -> " + scene.voxmap_name,
                text_of("force layer: %llu voxels added, %llu removed, %llu kept",
                        static_cast<unsigned long long>(change->added),
                        static_cast<unsigned long long>(change->removed),
                        static_cast<unsigned long long>(change->kept))};
  plan.change = std::move(*change);
  return {};
}

nlohmann::ordered_json numbers(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

// Whether an object, or a group that it is in, is called or meant by a name
// (formats/mesh/node_names.h).
bool is_named(const std::string& object, const std::string& name,
              bool (*fits)(const std::string& path, const std::string& name)) {
  for (std::size_t end = object.size();; end = object.rfind('/', end - 1)) {
    if (end == std::string::npos) return false;
    if (fits(object.substr(0, end), name)) return true;
    if (end == 0) return false;
  }
}

// The objects that --hide names, and all that --only does not.
Result<std::vector<std::string>> hidden_objects(const std::vector<std::string>& objects,
                                                const std::vector<std::string>& hide,
                                                const std::vector<std::string>& only) {
  std::vector<char> is_hidden(objects.size(), only.empty() ? 0 : 1);
  const auto set = [&](const char* option, const std::vector<std::string>& lists,
                       char hidden) -> Status {
    for (const std::string& list : lists) {
      const bool is_borne = std::any_of(
          objects.begin(), objects.end(),
          [&](const std::string& object) { return is_named(object, list, mesh::bears_name); });
      for (const std::string& name : mesh::names_in(list, is_borne)) {
        const auto choose = [&](const std::string& called) {
          bool any = false;
          for (std::size_t n = 0; n < objects.size(); ++n) {
            if (!is_named(objects[n], called, mesh::fits_name)) continue;
            is_hidden[n] = hidden;
            any = true;
          }
          return any;
        };
        const auto meanings = command::meanings_of(name);
        if (std::none_of(meanings.begin(), meanings.end(), choose)) {
          command::NearestNames nearest(name);
          for (const std::string& object : objects) nearest.add(object);
          return Error{ErrorCode::kUsage, "", option, "no object has the name '" + name + "'",
                       nearest.text("see voxinfo FILE.vox --objects or voxelize --list FILE")};
        }
      }
    }
    return {};
  };
  if (Status shown = set("--only", only, 0); !shown) return shown.error();
  if (Status hidden = set("--hide", hide, 1); !hidden) return hidden.error();
  std::vector<std::string> names;
  for (std::size_t n = 0; n < objects.size(); ++n) {
    if (is_hidden[n] != 0) names.push_back(objects[n]);
  }
  return names;
}

}  // namespace

WorldBox box_of(const ViewScene& scene) {
  if (!scene.bounds.empty) return scene.bounds;
  WorldBox box;
  const double radius_m = scene.shell ? scene.shell->header().bounding_radius_m : 1;
  box.add(glm::dvec3(-radius_m));
  box.add(glm::dvec3(radius_m));
  return box;
}

Result<std::unique_ptr<ContactViewSource>> make_contact_source(const ViewOptions& options,
                                                               const ViewScene& scene,
                                                               const std::vector<TraceRow>& rows) {
  Model model = kDefaultModel;
  ForceKind force = field::usual_force(model, *scene.voxmap);
  if (!options.run.empty() && stream::is_recording(options.run)) {
    const auto recording = stream::Recording::open(options.run);
    if (!recording) return recording.error();
    model = recording->run().parameters.model;
    force = recording->run().parameters.force;
  }
  auto field = field::make_force_field(model, force, *scene.voxmap);
  if (!field) return field.error();
  auto source =
      std::make_unique<ContactViewSource>(*scene.voxmap, *scene.shell, model, std::move(*field));
  if (!rows.empty()) {
    source->find_seat(rows.front().world_from_part);
  } else if (options.world_from_part) {
    source->find_seat(*options.world_from_part);
  }
  return source;
}

std::string describe(const ViewScene& scene) {
  std::string line;
  if (scene.voxmap) {
    const VoxmapHeader& header = scene.voxmap->header();
    const std::string begin = has_standoff(header)
                                  ? text_of("standoff %g mm", 1e3 * header.zero_force_m)
                                  : text_of("%u offset layers", header.offset_layers);
    line = text_of("%s: %g mm voxels, %s, %llu force-layer voxels", scene.voxmap_name.c_str(),
                   1e3 * header.voxel_size_m, begin.c_str(),
                   static_cast<unsigned long long>(header.surface_voxels));
  }
  if (scene.shell) {
    line += line.empty() ? "" : "    ";
    line += text_of("%s: %llu points", scene.shell_name.c_str(),
                    static_cast<unsigned long long>(scene.shell->header().point_count));
  }
  if (line.empty()) line = text_of("%zu meshes", scene.meshes.size());
  return line;
}

Status add_moment(const ViewOptions& options, const ViewScene& scene,
                  const std::vector<TraceRow>& rows, Moment moment, PicturePlan& plan) {
  if (scene.voxmap && scene.shell) {
    auto source = make_contact_source(options, scene, rows);
    if (!source) return source.error();
    find_contacts(**source, moment);
  }
  if (!plan.own_title) {
    for (const std::string& line : describe(moment)) plan.title.push_back(line);
  }
  plan.moment = std::move(moment);
  plan.camera = plan_camera(options, scene, plan.moment);
  return {};
}

Result<PicturePlan> plan_picture(const ViewOptions& options, const ViewScene& scene,
                                 const std::vector<TraceRow>& rows) {
  PicturePlan plan;
  plan.width = options.width;
  plan.scale = options.scale.value_or(1);
  plan.height = options.height;
  plan.shown = options.shown.value_or(default_items(scene));
  plan.cut = options.cut;
  plan.plain = options.plain;
  plan.color_objects = options.color_objects;
  auto hidden = hidden_objects(object_names(scene), options.hide, options.only);
  if (!hidden) return hidden.error();
  plan.hidden = std::move(*hidden);
  plan.measure = options.measure;
  auto path_m = plan_path(options.path, scene);
  if (!path_m) return path_m.error();
  plan.path_m = std::move(*path_m);
  plan.title = options.title;
  plan.own_title = !options.title.empty();
  if (!plan.own_title) plan.title = {describe(scene)};
  auto planned = plan_moment(options, rows);
  if (!planned) return planned.error();
  std::optional<Moment>& moment = *planned;
  if (scene.before) {
    if (Status change = plan_change(scene, plan); !change) return change.error();
  }
  plan.camera = plan_camera(options, scene, plan.moment);
  if (moment) {
    if (Status added = add_moment(options, scene, rows, std::move(*moment), plan); !added) {
      return added.error();
    }
  }
  return plan;
}

std::vector<CameraView> turntable_of(const PicturePlan& plan, const ViewScene& scene, int cameras) {
  const WorldBox box = box_of(scene);
  const bool whole = plan.camera.target_m == box.middle_m();
  const double aspect = static_cast<double>(plan.width) / plan.height;
  double half_height_m = plan.camera.half_height_m;
  std::vector<CameraView> views(static_cast<std::size_t>(cameras), plan.camera);
  for (std::size_t n = 0; n < views.size(); ++n) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(n) / cameras;
    const Orbit orbit = turned({plan.camera.to_eye, plan.camera.up}, angle, 0);
    views[n].to_eye = orbit.to_eye;
    views[n].up = orbit.up;
    if (!whole) continue;
    half_height_m = std::max(half_height_m, frame_box(box, orbit.to_eye, aspect).half_height_m);
  }
  for (CameraView& view : views) view.half_height_m = half_height_m;
  return views;
}

nlohmann::ordered_json report_of(const PicturePlan& plan, const ViewScene& scene) {
  nlohmann::ordered_json report;
  report["width"] = plan.width;
  report["height"] = plan.height;
  report["metres_per_pixel"] = plan.meters_per_pixel();
  report["target_m"] = numbers(plan.camera.target_m);
  report["to_eye"] = numbers(plan.camera.to_eye);
  report["up"] = numbers(plan.camera.up);
  report["meshes"] = scene.meshes.size();
  report["missing_faces"] = scene.missing_faces.size();
  report["part_missing_faces"] = scene.part_missing_faces.size();
  if (plan.color_objects) {
    auto& objects = report["objects"] = nlohmann::ordered_json::array();
    for (std::size_t n = 0; n < scene.meshes.size(); ++n) {
      objects.push_back({{"name", scene.meshes[n].name}, {"color", color_of_mesh(n)}});
    }
  }
  if (!plan.hidden.empty()) report["hidden"] = plan.hidden;
  if (!plan.path_m.empty()) {
    auto& path = report["path_m"] = nlohmann::ordered_json::array();
    for (const glm::dvec3& place_m : plan.path_m) path.push_back(numbers(place_m));
  }
  if (plan.moment) {
    const Moment& moment = *plan.moment;
    auto& json = report["moment"];
    if (moment.time_s) json["t_s"] = *moment.time_s;
    if (!moment.name.empty()) json["name"] = moment.name;
    json["kind"] = frame_kind_name(moment.kind());
    json["points_proximity"] = moment.contacts.proximity;
    json["points_surface"] = moment.contacts.surface;
    json["points_interior"] = moment.contacts.interior;
    json["contacts"] = moment.contacts.contacts;
    json["deepest_m"] = moment.contacts.deepest_m;
    if (moment.clearance) {
      json["clearance"] = {{"clearance_m", moment.clearance->clearance_m},
                           {"at_least", moment.clearance->at_least},
                           {"object", moment.clearance->object}};
    }
    if (!moment.contacts.seated_on.empty()) json["seated_on"] = moment.contacts.seated_on;
    if (moment.on_hand) json["force_n"] = numbers(moment.on_hand->force_n);
    if (const auto& clearance_m = moment.contacts.clearance_m) {
      json["clearance_m"] = *clearance_m;
      json["at_least"] = moment.contacts.at_least;
      if (!moment.contacts.at_least) {
        json["nearest_object"] = moment.contacts.nearest_object;
        json["nearest_m"] = numbers(moment.contacts.nearest_m);
        json["nearest_scene_m"] = numbers(moment.contacts.nearest_scene_m);
      }
    }
  }
  if (plan.change) {
    report["change"] = {{"added", plan.change->added},
                        {"removed", plan.change->removed},
                        {"kept", plan.change->kept}};
  }
  return report;
}

}  // namespace forcelayer::viewer
