// The meshes of a scene, read only when needed: a cache knows a file's outlines and facts by its
// bytes.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/mesh_facts.h"
#include "formats/mesh/sandbox/trust_options.h"
#include "formats/mesh/scene.h"
#include "formats/result.h"
#include "voxelize/cache/cache_folder.h"
#include "voxelize/cache/digest.h"
#include "voxelize/scan/spill_file.h"

namespace forcelayer::cache {

// A mesh that need not be in memory.
struct MeshOutline {
  Digest vertices, triangles;  // of the two arrays
  std::uint64_t triangle_count = 0;
  double float_coordinate = 0;  // largest coordinate if vertices are 32-bit floats, else 0
  double area = 0;              // of the triangles, file units^2

  Digest digest() const;  // of the whole mesh
};
MeshOutline outline_of(const mesh::Mesh& mesh);

class MeshSource {
 public:
  // `cache` may be null. `read` reads the files that it does not hold. Meshes that take more than
  // `max_bytes` together wait on disk.
  explicit MeshSource(const CacheFolder* cache, mesh::AssemblyReader read = mesh::read_assembly,
                      std::size_t max_bytes = std::size_t{512} << 20)
      : cache_(cache), read_(std::move(read)), max_bytes_(max_bytes) {}

  // For SceneReading::read_ahead: reads these files in parallel, as many at once as take no more
  // than `max_bytes`. After the first that fails, no other is begun.
  void read_ahead(std::span<const mesh::FileToRead> files, double max_bytes);
  // For SceneReading::read. The assembly's meshes come empty; mesh() gives them.
  Result<mesh::Assembly> read(const std::string& path, const mesh::ReadOptions& options);

  // Takes a mesh of no file. Returns the number of its assembly, in which it is mesh 0.
  std::uint32_t add(mesh::Mesh mesh);

  const MeshOutline& outline(const mesh::MeshObject& part) const {
    return files_[part.assembly].outlines[part.mesh];
  }
  std::vector<MeshOutline> outlines(const mesh::Scene& scene) const;  // [objects]
  // One caller at a time. An error where the file has changed meanwhile.
  Result<std::shared_ptr<const mesh::Mesh>> mesh(const mesh::MeshObject& part);
  Result<std::vector<mesh::MeshFacts>> facts(const mesh::Scene& scene);  // [objects], in parallel

 private:
  struct MeshOnDisk {
    std::span<const mesh::Vec3d> vertices;
    std::span<const mesh::Triangle> triangles;
    bool single_precision;
  };
  struct File {
    std::string path;
    mesh::ReadOptions options;
    std::vector<MeshOutline> outlines;
    std::vector<mesh::Mesh> meshes;   // empty until they are needed, and ...
    std::vector<MeshOnDisk> on_disk;  // ... where they wait here
  };
  struct ReadFile {
    mesh::Assembly assembly;
    File file;
  };

  Result<ReadFile> read_file(const std::string& path, const mesh::ReadOptions& options);
  void keep(std::vector<mesh::Mesh> meshes, File& file);
  Result<mesh::MeshFacts> facts(const mesh::MeshObject& part, std::mutex& one_caller);

  const CacheFolder* cache_;
  mesh::AssemblyReader read_;
  const std::size_t max_bytes_;
  std::mutex keeping_;  // guards the next two
  std::size_t bytes_ = 0;
  std::unique_ptr<scan::SpillFile> spill_;               // once the meshes take more
  std::map<std::string, Result<ReadFile>> files_ahead_;  // by path
  std::vector<File> files_;                              // [assemblies of the scene]
};

}  // namespace forcelayer::cache
