// --list: the nodes of assembly files, by the names that a user can type.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/sandbox/trust_options.h"
#include "formats/result.h"

namespace forcelayer::voxelize {

// A node with all below it.
struct ListedNode {
  std::string path;  // empty for the whole file
  std::string name;  // what can follow FILE#
  std::uint64_t instances = 0;
  std::uint64_t triangles = 0;
  mesh::Box box{};                  // file units, the file's frame
  bool closed = false;              // whether every mesh is
  std::uint64_t missing_faces = 0;  // faces of exact surfaces that got no triangles
};

struct ListedFile {
  std::string path;
  std::optional<double> meters_per_unit;  // of the user, else of the file
  std::optional<mesh::Up> up;             // Assembly::up
  ListedNode whole;
  std::vector<ListedNode> nodes;  // those that hold triangles or lack faces
};

struct Listing {
  std::vector<ListedFile> files;
  std::vector<std::string> warnings;  // a line each, with file
};

// Reads each file of `inputs` ("FILE#NODE" for nodes of one) once. Faces that cannot be tessellated
// are counted, not refused. `options`: its deflection and `without`.
Result<Listing> list_files(std::span<const std::string> inputs,
                           std::optional<double> meters_per_unit, mesh::ReadOptions options,
                           const mesh::AssemblyReader& read);

std::string table_of(const Listing& listing);
nlohmann::ordered_json report_of(const Listing& listing);

}  // namespace forcelayer::voxelize
