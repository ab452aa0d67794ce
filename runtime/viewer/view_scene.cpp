#include "runtime/viewer/view_scene.h"

#include <algorithm>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "formats/mesh/units.h"

namespace forcelayer {
namespace {

// A mesh file, its instances still apart.
struct PlacedAssembly {
  Assembly assembly;
  double unit_m = 1;
};

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Result<PlacedAssembly> read_placed(const std::string& path, std::optional<double> unit_m,
                                   std::vector<std::string>& warnings) {
  auto assembly = read_assembly(path);
  if (!assembly) return assembly.error();
  const auto scale = metres_per_unit(*assembly, path, unit_m, warnings);
  if (!scale) return scale.error();
  for (const std::string& warning : assembly->warnings) warnings.push_back(path + ": " + warning);
  return PlacedAssembly{std::move(*assembly), *scale};
}

glm::dvec3 place(const PlacedAssembly& placed, const MeshInstance& instance, const Vec3d& vertex) {
  const Vec3d p = apply(instance.assembly_from_mesh, vertex);
  return placed.unit_m * glm::dvec3(p[0], p[1], p[2]);
}

void add_bounds(const PlacedAssembly& placed, WorldBox& box) {
  for (const MeshInstance& instance : placed.assembly.instances) {
    for (const Vec3d& vertex : placed.assembly.meshes[instance.mesh].vertices) {
      box.add(place(placed, instance, vertex));
    }
  }
}

void add_meshes(const PlacedAssembly& placed, const glm::dvec3& origin_m,
                std::vector<ViewMesh>& meshes) {
  for (const MeshInstance& instance : placed.assembly.instances) {
    const Mesh& mesh = placed.assembly.meshes[instance.mesh];
    ViewMesh view{instance.name, {}, mesh.triangles};
    view.points.reserve(mesh.vertices.size());
    for (const Vec3d& vertex : mesh.vertices) {
      const glm::dvec3 p = place(placed, instance, vertex) - origin_m;
      view.points.push_back(
          {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
    }
    meshes.push_back(std::move(view));
  }
}

Error twice(const std::string& path, const char* kind) {
  return {ErrorCode::kUsage, path, "", std::string("a second ") + kind,
          "give one, or --compare to set two beside each other"};
}

Status load_baked(const std::string& path, ViewScene& scene) {
  const std::string name = std::filesystem::path(path).filename().string();
  if (extension_of(path) == ".vox") {
    if (scene.voxmap) return twice(path, "voxmap");
    auto voxmap = Voxmap::open(path);
    if (!voxmap) return voxmap.error();
    scene.voxmap = std::move(*voxmap);
    scene.voxmap_name = name;
  } else {
    if (scene.shell) return twice(path, "shell");
    auto shell = Pshell::open(path);
    if (!shell) return shell.error();
    scene.shell = std::move(*shell);
    scene.shell_name = name;
  }
  return {};
}

Status load_part(const ViewInputs& inputs, ViewScene& scene) {
  const auto unit_m = inputs.part_unit_m ? inputs.part_unit_m : inputs.unit_m;
  auto placed = read_placed(inputs.part, unit_m, scene.warnings);
  if (!placed) return placed.error();
  std::vector<ViewMesh> pieces;
  add_meshes(*placed, glm::dvec3(0), pieces);
  ViewMesh whole{inputs.part, {}, {}};
  for (const ViewMesh& piece : pieces) {
    const auto base = static_cast<std::uint32_t>(whole.points.size());
    whole.points.insert(whole.points.end(), piece.points.begin(), piece.points.end());
    for (const Triangle& t : piece.triangles) {
      whole.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
  }
  scene.part = std::move(whole);
  return {};
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

Result<ViewScene> load_view_scene(const ViewInputs& inputs) {
  ViewScene scene;
  std::vector<PlacedAssembly> assemblies;
  for (const std::string& path : inputs.inputs) {
    const std::string extension = extension_of(path);
    if (extension == ".vox" || extension == ".pshell") {
      if (Status loaded = load_baked(path, scene); !loaded) return loaded.error();
      continue;
    }
    auto placed = read_placed(path, inputs.unit_m, scene.warnings);
    if (!placed) return placed.error();
    add_bounds(*placed, scene.bounds);
    assemblies.push_back(std::move(*placed));
  }
  if (scene.voxmap) {
    if (const WorldBox box = voxmap_box(*scene.voxmap); !box.empty) {
      scene.bounds.add(box.low_m);
      scene.bounds.add(box.high_m);
    }
  }
  scene.origin_m = scene.bounds.middle_m();
  for (const PlacedAssembly& placed : assemblies) {
    add_meshes(placed, scene.origin_m, scene.meshes);
  }
  if (!inputs.part.empty()) {
    if (Status loaded = load_part(inputs, scene); !loaded) return loaded.error();
  }
  return scene;
}

}  // namespace forcelayer
