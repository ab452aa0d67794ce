#include "workbench/pairs/assembly_parts.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "formats/command/verdict/verdict.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "workbench/exact/mesh_distance.h"

namespace forcelayer::pairs {
namespace {

// baked_deflection_m() of voxels of this size is the deflection.
constexpr double kVoxelSizeM = 1e-3;
static_assert(mesh::baked_deflection_m(kVoxelSizeM) == kDeflectionM);

// The rounding of a file's numbers: of vertices, and of the factors by which they are placed.
double rounding_of(const mesh::Mesh& mesh, const mesh::Affine& world_from_mesh) {
  mesh::Vec3d largest{0, 0, 0};
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      largest[axis] = std::max(largest[axis], std::abs(vertex[axis]));
    }
  }
  return exact::kRounding * mesh::largest_sum(world_from_mesh, largest);
}

}  // namespace

Result<AssemblyParts> read_parts(const std::string& assembly, std::optional<double> unit_m) {
  mesh::SceneReading reading;
  reading.voxel_size_m = kVoxelSizeM;
  reading.read = mesh::read_guarded;
  auto scene = mesh::read_scene(std::span(&assembly, 1), unit_m, reading);
  if (!scene) {
    Error error = scene.error();
    if (error.mend.find("--missing-faces") != std::string::npos) {  // no distance is known there
      error.mend = "repair these faces in the CAD system, or list the other parts in a manifest";
    }
    return error;
  }
  AssemblyParts read{std::move(*scene), {}};
  const std::vector<PartName> names = part_names(read.scene);
  for (std::size_t n = 0; n < read.scene.objects.size(); ++n) {
    const mesh::MeshObject& object = read.scene.objects[n];
    const mesh::Mesh& mesh = read.scene.mesh_of(object);
    if (mesh.triangles.empty()) continue;
    AssemblyPart& part = read.parts.emplace_back();
    part.name = names[n];
    part.object = n;
    part.box_m = mesh::box_of(mesh, object.world_from_mesh);
    part.deviation_m = object.deviation_m;
    part.rounding_m = rounding_of(mesh, object.world_from_mesh);
  }
  read.add_paths();
  return read;
}

std::string AssemblyParts::shown_name(std::size_t part) const {
  return escaped(command::short_name(paths[part], paths));
}

std::vector<PartName> AssemblyParts::names() const {
  std::vector<PartName> names;
  for (const AssemblyPart& part : parts) names.push_back(part.name);
  return names;
}

void AssemblyParts::add_paths() {
  paths.clear();
  for (const AssemblyPart& part : parts) paths.push_back(part.name.path);
}

exact::Surface surface_of(const mesh::Scene& scene, const AssemblyPart& part) {
  const mesh::MeshObject& object = scene.objects[part.object];
  const mesh::Mesh& mesh = scene.mesh_of(object);
  exact::Surface surface;
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    const mesh::Vec3d p = mesh::apply(object.world_from_mesh, vertex);
    surface.vertices_m.push_back({p[0], p[1], p[2]});
  }
  surface.triangles = mesh.triangles;
  surface.object.assign(surface.triangles.size(), 1);
  return surface;
}

}  // namespace forcelayer::pairs
