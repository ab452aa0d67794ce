#include "workbench/exact/surface/surfaces.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "formats/command/provenance.h"
#include "formats/command/text.h"
#include "formats/mesh/content_hash.h"
#include "formats/mesh/sandbox/trust_options.h"
#include "formats/mesh/scene.h"
#include "formats/mesh/up_axis.h"
#include "pointshell/part/part_files.h"
#include "pointshell/report.h"
#include "workbench/pairs/rules/rules.h"

namespace forcelayer::exact {
namespace {

// Read as for the bake: exact surfaces (STEP, IGES) get the triangles that it had.
Result<mesh::SceneReading> reading_of(const voxcheck::ExactRequest& request, double voxel_size_m,
                                      std::string_view provenance) {
  mesh::TrustOptions trust;
  trust.sandbox = request.sandbox;
  trust.allow_outside = request.allow_outside;
  auto read = trust.reader();
  if (!read) return read.error();
  mesh::SceneReading reading;
  reading.voxel_size_m = voxel_size_m;
  reading.allow_outside = request.allow_outside;
  reading.up = mesh::up_named(command::up_in(provenance));
  reading.missing_faces = command::missing_faces_in(provenance);
  reading.read = std::move(*read);
  return reading;
}

Error other_meshes(const std::string& file, std::string why) {
  return {ErrorCode::kFilesDoNotMatch, file, "--exact",
          "was not baked from these meshes: " + std::move(why),
          "give the same inputs, --without and units as for the bake, or bake again"};
}

Surface surface_of(const mesh::Scene& scene) {
  Surface surface;
  for (std::size_t n = 0; n < scene.objects.size(); ++n) {
    const mesh::MeshObject& object = scene.objects[n];
    const mesh::Mesh& mesh = scene.mesh_of(object);
    surface.deviations_m.push_back(object.deviation_m);
    const auto first = static_cast<std::uint32_t>(surface.vertices_m.size());
    for (const mesh::Vec3d& vertex : mesh.vertices) {
      const mesh::Vec3d p = apply(object.world_from_mesh, vertex);
      surface.vertices_m.push_back(glm::dvec3(p[0], p[1], p[2]));
      for (const double coordinate : p) {
        surface.largest_m = std::max(surface.largest_m, std::abs(coordinate));
      }
    }
    for (const mesh::Triangle& t : mesh.triangles) {
      surface.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    surface.object.resize(surface.triangles.size(), static_cast<std::uint32_t>(n + 1));
  }
  return surface;
}

Result<mesh::Scene> read_scene(const voxcheck::ExactRequest& request, const Voxmap& voxmap) {
  auto reading = reading_of(request, voxmap.voxel_size_m(), voxmap.provenance());
  if (!reading) return reading.error();
  reading->without = request.without;
  return mesh::read_scene(request.meshes, request.unit_m, *reading);
}

// About an origin; each body is an object of its own.
Surface surface_of(const part::Part& part, const glm::dvec3& origin_m) {
  Surface surface;
  for (const part::Vec3& v : part.vertices) {
    surface.vertices_m.push_back(glm::dvec3(v.x, v.y, v.z) - origin_m);
  }
  surface.triangles = part.triangles;
  for (const std::uint32_t body : part.body) surface.object.push_back(body + 1);
  surface.largest_m = part.largest_coordinate;
  return surface;
}

Status check_triangles(const std::string& file, std::size_t read, std::uint64_t baked) {
  if (read == baked) return {};
  return other_meshes(
      file, command::text("the meshes have %zu triangles, but the file was made from %llu", read,
                          static_cast<unsigned long long>(baked)));
}

Status check_names(const std::string& file, const mesh::Scene& scene, const Voxmap& voxmap) {
  const std::uint32_t count = voxmap.header().object_count;
  if (count != scene.objects.size()) {
    return other_meshes(file, command::text("the meshes have %zu objects, but the file has %u",
                                            scene.objects.size(), count));
  }
  for (std::uint32_t n = 1; n <= count; ++n) {
    const std::string& name = scene.objects[n - 1].name;
    if (voxmap.object_name(n) != name) {
      return other_meshes(file, "object " + std::to_string(n) + " of the file is '" +
                                    std::string(voxmap.object_name(n)) + "', not '" + name + "'");
    }
  }
  return {};
}

// Whether the meshes are, triangle by triangle and where they stand, those of the bake.
Status check_content(const std::string& file, const mesh::Scene& scene, const Voxmap& voxmap) {
  const std::vector<std::string> baked = command::object_hashes_in(voxmap.provenance());
  for (std::size_t n = 0; n < std::min(baked.size(), scene.objects.size()); ++n) {
    const mesh::MeshObject& object = scene.objects[n];
    if (mesh::content_hash(scene.mesh_of(object), object.world_from_mesh) == baked[n]) continue;
    return other_meshes(file, "'" + object.name + "' has another shape, size or position");
  }
  return {};
}

// The triangles of some objects.
template <typename IsChosen>
Surface those_of(const Surface& surface, const IsChosen& is_chosen) {
  Surface chosen{surface.vertices_m,  {}, {}, surface.largest_m, surface.deviation_m,
                 surface.deviations_m};
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (!is_chosen(surface.object[t])) continue;
    chosen.triangles.push_back(surface.triangles[t]);
    chosen.object.push_back(surface.object[t]);
  }
  return chosen;
}

}  // namespace

Result<Surface> read_scene_surface(const voxcheck::ExactRequest& request, const Voxmap& voxmap,
                                   std::vector<std::string>& warnings) {
  const auto scene = read_scene(request, voxmap);
  if (!scene) return scene.error();
  warnings.insert(warnings.end(), scene->warnings.begin(), scene->warnings.end());
  Surface surface = surface_of(*scene);
  // The file's deviation has that of corners on the voxel lattice in it, which no mesh has.
  const auto declared = command::mesh_deviation_in(voxmap.provenance());
  const double baked_m = voxmap.header().static_deviation_m;
  for (double& deviation_m : surface.deviations_m) {
    deviation_m = declared ? std::min(deviation_m + *declared, baked_m) : baked_m;
    surface.deviation_m = std::max(surface.deviation_m, deviation_m);
  }
  if (Status same =
          check_triangles(request.scene, surface.triangles.size(), voxmap.header().triangles);
      !same) {
    return same.error();
  }
  if (voxmap.objects() == nullptr) {
    std::fill(surface.object.begin(), surface.object.end(), 0);
    surface.deviations_m.clear();
  } else if (Status same = check_names(request.scene, *scene, voxmap); !same) {
    return same.error();
  }
  if (Status same = check_content(request.scene, *scene, voxmap); !same) return same.error();
  return surface;
}

Result<Surface> read_part_surface(const voxcheck::ExactRequest& request, const Pshell& shell,
                                  std::vector<std::string>& warnings) {
  const PshellHeader& header = shell.header();
  const auto reading = reading_of(request, header.voxel_size_m, shell.provenance());
  if (!reading) return reading.error();
  mesh::ReadOptions options;
  options.deflection_m = mesh::baked_deflection_m(header.voxel_size_m);
  options.missing_faces = reading->missing_faces;
  options.allow_outside = request.allow_outside;
  options.up = reading->up;
  auto files = part::read_part(request.part_meshes, request.part_unit_m, options, reading->read);
  if (!files) return files.error();
  warnings.insert(warnings.end(), files->warnings.begin(), files->warnings.end());
  const part::Part& part = files->part;
  if (Status same = check_triangles(request.part, part.input_triangles, header.triangles); !same) {
    return same.error();
  }
  const std::string baked = command::part_hash_in(shell.provenance());
  if (!baked.empty() && pointshell::part_hash(part) != baked) {
    return other_meshes(request.part, "the part has another shape, size or position");
  }
  const auto& c = header.center_m;
  Surface surface = surface_of(part, {c[0], c[1], c[2]});
  surface.deviation_m = header.part_deviation_m;
  return surface;
}

Result<voxcheck::ExactAnswer> read_rules(const voxcheck::ExactRequest& request,
                                         const Voxmap& voxmap, const Pshell& shell) {
  if (voxmap.objects() == nullptr) {
    return Error{ErrorCode::kUsage, request.scene, "--rules",
                 "the scene stores no objects, so rules cannot tell them apart",
                 "bake the scene without --kind lean or paper"};
  }
  const auto scene = read_scene(request, voxmap);
  if (!scene) return scene.error();
  if (Status same = check_names(request.scene, *scene, voxmap); !same) return same.error();
  const auto reading = reading_of(request, shell.header().voxel_size_m, shell.provenance());
  if (!reading) return reading.error();
  const auto part = mesh::read_scene(request.part_meshes, request.part_unit_m, *reading);
  if (!part) return part.error();
  using pairs::Requirement;
  const Requirement otherwise = request.required_m > 0
                                    ? Requirement{Requirement::Kind::kClearance, request.required_m}
                                    : Requirement{};
  auto rules = pairs::read_part_rules(request.rules, pairs::part_names(*part),
                                      pairs::part_names(*scene), otherwise);
  if (!rules) return rules.error();
  voxcheck::ExactAnswer answer;
  for (const Requirement& requirement : rules->of_object) {
    answer.rules.push_back(
        {requirement.clearance_m, requirement.kind == Requirement::Kind::kIgnore});
  }
  answer.warnings = std::move(rules->warnings);
  return answer;
}

double radius_m(const Surface& part) {
  double radius_m = 0;
  for (const glm::dvec3& vertex : part.vertices_m) {
    radius_m = std::max(radius_m, glm::length(vertex));
  }
  return radius_m;
}

double largest_m(const Surface& scene, const Surface& part, std::span<const PathRow> rows) {
  double largest_m = std::max(scene.largest_m, part.largest_m);
  for (const PathRow& row : rows) {
    for (const double x : row.position_m) {
      largest_m = std::max(largest_m, std::abs(x) + part.largest_m);
    }
  }
  return largest_m;
}

Surface without(const Surface& surface, std::span<const std::uint32_t> left_out) {
  return those_of(surface, [&](std::uint32_t object) {
    return std::ranges::find(left_out, object) == left_out.end();
  });
}

Surface only(const Surface& surface, std::span<const std::uint32_t> objects) {
  Surface chosen = those_of(surface, [&](std::uint32_t object) {
    return std::ranges::find(objects, object) != objects.end();
  });
  if (surface.deviations_m.empty()) return chosen;
  chosen.deviation_m = 0;
  for (const std::uint32_t object : objects) {
    // 0 is no object: voxels name none, deep in a solid.
    chosen.deviation_m = std::max(
        chosen.deviation_m, object == 0 ? surface.deviation_m : surface.deviations_m[object - 1]);
  }
  return chosen;
}

}  // namespace forcelayer::exact
