// The JSON scene manifest.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::mesh {

// One entry of `parts`.
struct ManifestObject {
  std::string name;
  std::string mesh;  // path, made relative to the working folder; may end in #NODE
  std::optional<double> meters_per_unit;
  std::optional<Up> up;
  Affine world_from_object;  // meters
  std::vector<Vec3d> free_seeds_m;
  double deviation_m = 0;
};

struct Manifest {
  std::optional<double> voxel_size_m;
  std::optional<std::uint32_t> layers;
  std::optional<std::array<double, 6>> roi_m;
  std::vector<Vec3d> free_seeds_m;
  std::vector<std::string> without;  // nodes and parts
  std::vector<ManifestObject> objects;
};

// Reads and checks a manifest; an error names file and key, as in `parts[2].units`.
Result<Manifest> read_manifest(const std::string& path);

}  // namespace forcelayer::mesh
