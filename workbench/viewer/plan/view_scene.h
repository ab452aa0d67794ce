// The scene of the viewer: the given meshes, voxmap and shell, read and placed in one frame.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer::viewer {

// An axis-aligned box in the world. Empty until something was added.
struct WorldBox {
  glm::dvec3 low_m{0, 0, 0};
  glm::dvec3 high_m{0, 0, 0};
  bool empty = true;

  void add(const glm::dvec3& point_m);
  glm::dvec3 middle_m() const { return 0.5 * (low_m + high_m); }
};

// A mesh as a graphics card takes it. Points are relative to ViewScene::origin_m (scene meshes) or
// to the part's frame (the part).
struct ViewMesh {
  std::string name;
  std::vector<std::array<float, 3>> points;  // m
  std::vector<mesh::Triangle> triangles;
};

struct ViewScene {
  // World point that single-precision coordinates are given from, so that a scene far from the
  // world's origin is drawn as sharply as one at it.
  glm::dvec3 origin_m{0, 0, 0};
  WorldBox bounds;  // of meshes and voxmap
  std::vector<ViewMesh> meshes;
  std::vector<ViewMesh> missing_faces;  // a cube around each face of STEP or IGES without triangles
  std::vector<ViewMesh> part_missing_faces;  // the same of the part, in its frame
  std::optional<ViewMesh> part;
  std::optional<Voxmap> voxmap;
  std::optional<Voxmap> before;  // an earlier bake, to compare with `voxmap`
  std::optional<Pshell> shell;
  std::string voxmap_path, shell_path;               // as given
  std::string voxmap_name, before_name, shell_name;  // without folder
  std::vector<std::string> warnings;                 // a line each
};

// The files to read. `inputs` are inputs of voxelize (meshes, folders, manifests), at most one .vox
// and at most one .pshell, in any order.
struct ViewInputs {
  std::vector<std::string> inputs;
  std::string before;                 // the .vox to compare with; empty: none
  std::string part;                   // mesh of the moving part; empty: none
  std::optional<double> unit_m;       // meters per file unit of the meshes; empty: not given
  std::optional<double> part_unit_m;  // the same for `part`; empty: as `unit_m`
};

// Reads everything. Errors are those of the readers; kUsage for two files of one kind, or a mesh
// whose format does not say its unit when none was given.
Result<ViewScene> load_view_scene(const ViewInputs& inputs);

// The scene's objects: its meshes, and those of the voxmap that no mesh is called like.
std::vector<std::string> object_names(const ViewScene& scene);

// World box of the non-free voxels; empty where all is free.
WorldBox voxmap_box(const Voxmap& voxmap);

}  // namespace forcelayer::viewer
