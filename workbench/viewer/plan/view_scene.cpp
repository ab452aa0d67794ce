#include "workbench/viewer/plan/view_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <glm/common.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "formats/command/provenance.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "formats/mesh/scene.h"
#include "formats/mesh/up_axis.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::viewer {
namespace {

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

glm::dvec3 place(const mesh::MeshObject& part, const mesh::Vec3d& vertex) {
  const mesh::Vec3d p = mesh::apply(part.world_from_mesh, vertex);
  return {p[0], p[1], p[2]};
}

void add_bounds(const mesh::Scene& scene, WorldBox& box) {
  for (const mesh::MeshObject& part : scene.objects) {
    for (const mesh::Vec3d& vertex : scene.mesh_of(part).vertices) box.add(place(part, vertex));
  }
}

ViewMesh view_mesh_of(const mesh::Scene& scene, const mesh::MeshObject& part,
                      const glm::dvec3& origin_m) {
  const mesh::Mesh& mesh = scene.mesh_of(part);
  ViewMesh view{part.name, {}, mesh.triangles};
  view.points.reserve(mesh.vertices.size());
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    const glm::dvec3 p = place(part, vertex) - origin_m;
    view.points.push_back(
        {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
  }
  return view;
}

Error twice(const std::string& path, const char* kind) {
  return {ErrorCode::kUsage, path, "", std::string("is a second ") + kind,
          "give only one, or use --compare to compare two .vox files"};
}

// A scene whose layers can be drawn in some minutes: surfaces visit every node of its tree.
Result<Voxmap> open_scene(const std::string& path) {
  auto map = Voxmap::open(path);
  if (!map) return map;
  const double steps = walk_steps(
      map->view(), {map->upper_node_count(), map->lower_node_count(), 0, 0},
      [](std::uint32_t, std::uint32_t) { return true; },
      [](std::uint32_t value, std::uint32_t edge) {
        return value == static_cast<std::uint32_t>(VoxelValue::kFree) ? 0 : 6.0 * edge * edge;
      });
  if (Status s = check_walk(steps, path); !s) return s.error();
  return map;
}

Status load_baked(const std::string& path, ViewScene& scene) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (extension_of(path) == ".vox") {
    if (scene.voxmap) return twice(path, "voxmap");
    auto voxmap = open_scene(path);
    if (!voxmap) return voxmap.error();
    scene.voxmap = std::move(*voxmap);
    scene.voxmap_name = name;
    scene.voxmap_path = path;
  } else {
    if (scene.shell) return twice(path, "shell");
    auto shell = Pshell::open(path);
    if (!shell) return shell.error();
    scene.shell = std::move(*shell);
    scene.shell_name = name;
    scene.shell_path = path;
  }
  return {};
}

Status load_before(const std::string& path, ViewScene& scene) {
  if (path.empty()) return {};
  if (!scene.voxmap) {
    return Error{ErrorCode::kUsage, path, "", "there is no second .vox file to compare with",
                 "give the later .vox too, as in --compare before.vox after.vox"};
  }
  auto before = open_scene(path);
  if (!before) return before.error();
  scene.before = std::move(*before);
  scene.before_name = std::filesystem::path(path).filename().string();
  return {};
}

void add_box(const std::optional<Voxmap>& voxmap, WorldBox& bounds) {
  if (!voxmap) return;
  const WorldBox box = voxmap_box(*voxmap);
  if (box.empty) return;
  bounds.add(box.low_m);
  bounds.add(box.high_m);
}

bool has_no_place(const mesh::MissingFace& face) { return face.size == 0; }

// The cube about the middle of the face whose diagonal is the face's.
ViewMesh cube_around(const mesh::MissingFace& face, const glm::dvec3& origin_m) {
  const double half_edge_m = face.size / (2 * std::sqrt(3.0));
  ViewMesh cube{face.node, {}, {}};
  for (int corner = 0; corner < 8; ++corner) {
    auto& point = cube.points.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      const auto n = static_cast<std::size_t>(axis);
      const double middle_m = face.center[n] - origin_m[axis];
      point[n] = static_cast<float>(middle_m + (corner >> axis & 1 ? half_edge_m : -half_edge_m));
    }
  }
  cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return cube;
}

// A picture shows a file as far as it can be read: a face without triangles is a warning here.
// glTF files have the axes that they had when the files beside them were baked.
mesh::SceneReading reading_for_pictures(const ViewScene& scene) {
  mesh::SceneReading reading;
  std::string up = scene.voxmap ? command::up_in(scene.voxmap->provenance()) : "";
  if (up.empty() && scene.shell) up = command::up_in(scene.shell->provenance());
  if (!up.empty()) reading.up = mesh::up_named(up);
  reading.read = mesh::read_guarded;
  reading.missing_faces = std::numeric_limits<std::uint64_t>::max();
  return reading;
}

// The meshes of the part as one, in its frame.
Status load_part(const ViewInputs& inputs, ViewScene& scene) {
  const auto unit_m = inputs.part_unit_m ? inputs.part_unit_m : inputs.unit_m;
  const auto part = mesh::read_scene(std::array{inputs.part}, unit_m, reading_for_pictures(scene));
  if (!part) return part.error();
  scene.warnings.insert(scene.warnings.end(), part->warnings.begin(), part->warnings.end());
  ViewMesh whole{inputs.part, {}, {}};
  for (const mesh::MeshObject& piece : part->objects) {
    const ViewMesh mesh = view_mesh_of(*part, piece, glm::dvec3(0));
    const auto base = static_cast<std::uint32_t>(whole.points.size());
    whole.points.insert(whole.points.end(), mesh.points.begin(), mesh.points.end());
    for (const mesh::Triangle& t : mesh.triangles) {
      whole.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
  }
  for (const mesh::MissingFace& face : part->missing_faces) {
    if (has_no_place(face)) continue;
    scene.part_missing_faces.push_back(cube_around(face, glm::dvec3(0)));
  }
  scene.part = std::move(whole);
  return {};
}

// Faces that a baked file says it lacks.
std::vector<mesh::MissingFace> missing_faces_in(std::string_view provenance) {
  std::vector<mesh::MissingFace> faces;
  const auto origin = nlohmann::json::parse(provenance, nullptr, false);
  if (!origin.is_object() || !origin.contains("missing_faces")) return faces;
  for (const nlohmann::json& row : origin["missing_faces"]) {
    const auto field = [&](const char* name) {
      return row.is_object() ? row.value(name, nlohmann::json()) : nlohmann::json();
    };
    const nlohmann::json center = field("center_m"), size = field("size_m");
    if (!size.is_number() || !center.is_array() || center.size() != 3) continue;
    mesh::MissingFace& face = faces.emplace_back();
    face.size = size.get<double>();
    for (std::size_t n = 0; n < 3 && center[n].is_number(); ++n) {
      face.center[n] = center[n].get<double>();
    }
  }
  return faces;
}

}  // namespace

void WorldBox::add(const glm::dvec3& point_m) {
  low_m = empty ? point_m : glm::min(low_m, point_m);
  high_m = empty ? point_m : glm::max(high_m, point_m);
  empty = false;
}

WorldBox voxmap_box(const Voxmap& voxmap) {
  const VoxmapHeader& header = voxmap.header();
  WorldBox box;
  if (header.dims_voxels[0] == 0) return box;
  glm::dvec3 low(0), high(0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto first = static_cast<double>(header.origin_voxel[axis]);
    low[axis] = first * header.voxel_size_m;
    high[axis] = (first + static_cast<double>(header.dims_voxels[axis])) * header.voxel_size_m;
  }
  box.add(low);
  box.add(high);
  return box;
}

std::vector<std::string> object_names(const ViewScene& scene) {
  std::vector<std::string> names;
  for (const ViewMesh& mesh : scene.meshes) names.push_back(mesh.name);
  if (!scene.voxmap) return names;
  std::set<std::string> known(names.begin(), names.end());
  for (std::uint32_t n = 1; n <= scene.voxmap->header().object_count; ++n) {
    const std::string name(scene.voxmap->object_name(n));
    if (!name.empty() && known.insert(name).second) names.push_back(name);
  }
  return names;
}

Result<ViewScene> load_view_scene(const ViewInputs& inputs) {
  ViewScene view;
  std::vector<std::string> mesh_inputs;
  for (const std::string& path : inputs.inputs) {
    const std::string extension = extension_of(path);
    if (extension != ".vox" && extension != ".pshell") {
      mesh_inputs.push_back(path);
    } else if (Status loaded = load_baked(path, view); !loaded) {
      return loaded.error();
    }
  }
  if (Status loaded = load_before(inputs.before, view); !loaded) return loaded.error();
  const auto scene = mesh::read_scene(mesh_inputs, inputs.unit_m, reading_for_pictures(view));
  if (!scene) return scene.error();
  view.warnings = scene->warnings;
  add_bounds(*scene, view.bounds);
  std::vector<mesh::MissingFace> missing = scene->missing_faces;
  if (mesh_inputs.empty() && view.voxmap) missing = missing_faces_in(view.voxmap->provenance());
  std::erase_if(missing, has_no_place);
  for (const mesh::MissingFace& face : missing) {
    const glm::dvec3 center_m(face.center[0], face.center[1], face.center[2]);
    view.bounds.add(center_m - 0.5 * face.size);
    view.bounds.add(center_m + 0.5 * face.size);
  }
  add_box(view.voxmap, view.bounds);
  add_box(view.before, view.bounds);
  view.origin_m = view.bounds.middle_m();
  for (const mesh::MeshObject& part : scene->objects) {
    view.meshes.push_back(view_mesh_of(*scene, part, view.origin_m));
  }
  for (const mesh::MissingFace& face : missing) {
    view.missing_faces.push_back(cube_around(face, view.origin_m));
  }
  if (!inputs.part.empty()) {
    if (Status loaded = load_part(inputs, view); !loaded) return loaded.error();
  } else if (view.shell) {
    for (const mesh::MissingFace& face : missing_faces_in(view.shell->provenance())) {
      view.part_missing_faces.push_back(cube_around(face, glm::dvec3(0)));
    }
  }
  return view;
}

}  // namespace forcelayer::viewer
