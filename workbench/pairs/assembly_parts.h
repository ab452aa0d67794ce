// The parts of an assembly: each instance of a mesh, in the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/scene.h"
#include "formats/result.h"
#include "workbench/exact/surface/surfaces.h"
#include "workbench/pairs/rules/rules.h"

namespace forcelayer::pairs {

struct AssemblyPart {
  PartName name;
  std::size_t object = 0;  // index into Scene::objects
  mesh::Box box_m{};       // around its vertices, world
  double deviation_m = 0;  // of its triangles from the true surface, as declared
  double rounding_m = 0;   // of its vertices: most files store them as 32-bit floats
};

struct AssemblyParts {
  mesh::Scene scene;
  std::vector<AssemblyPart> parts;

  // The shortest end of a part's name that no other part has, escaped, as sentences show it.
  std::string shown_name(std::size_t part) const;
  std::vector<PartName> names() const;  // [parts] as rules know them
  std::vector<std::string> paths = {};  // [parts] their names, set by add_paths()
  void add_paths();
};

// Reads an assembly: a mesh file with nodes, a folder or a scene manifest. Exact surfaces (STEP,
// IGES) get triangles that are within kDeflectionM. Errors: those of mesh::read_scene().
inline constexpr double kDeflectionM = 1e-5;
Result<AssemblyParts> read_parts(const std::string& assembly, std::optional<double> unit_m);

// The triangles of a part in the world, all of one object.
exact::Surface surface_of(const mesh::Scene& scene, const AssemblyPart& part);

}  // namespace forcelayer::pairs
