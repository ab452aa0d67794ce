// The meshes of a scene, read only when needed: a cache knows a file's outlines and facts by its
// bytes.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/mesh_facts.h"
#include "formats/mesh/scene.h"
#include "formats/mesh/trust_options.h"
#include "formats/result.h"
#include "voxelize/cache/cache_folder.h"
#include "voxelize/cache/digest.h"

namespace forcelayer {

// A mesh that need not be in memory.
struct MeshOutline {
  Digest vertices, triangles;  // of the two arrays
  std::uint64_t triangle_count = 0;
  double float_coordinate = 0;  // largest coordinate if vertices are 32-bit floats, else 0

  Digest digest() const;  // of the whole mesh
};
MeshOutline outline_of(const Mesh& mesh);

class MeshSource {
 public:
  // `cache` may be null. `read` reads the files that it does not hold.
  explicit MeshSource(const CacheFolder* cache, AssemblyReader read = read_assembly)
      : cache_(cache), read_(std::move(read)) {}

  // For SceneReading::read. The assembly's meshes come empty; mesh() gives them.
  Result<Assembly> read(const std::string& path, const ReadOptions& options);

  const MeshOutline& outline(const MeshObject& part) const {
    return files_[part.assembly].outlines[part.mesh];
  }
  std::vector<MeshOutline> outlines(const Scene& scene) const;  // [objects]
  // One caller at a time. An error where the file has changed meanwhile.
  Result<const Mesh*> mesh(const MeshObject& part);
  Result<MeshFacts> facts(const MeshObject& part);

 private:
  struct File {
    std::string path;
    ReadOptions options;
    std::vector<MeshOutline> outlines;
    std::vector<Mesh> meshes;  // empty until they are needed
    std::vector<std::optional<MeshFacts>> facts;
  };

  const CacheFolder* cache_;
  AssemblyReader read_;
  std::vector<File> files_;  // [assemblies of the scene]
};

}  // namespace forcelayer
