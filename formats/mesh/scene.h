// A static scene as the user names it: mesh files, assemblies, folders, or a JSON manifest.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "formats/file/named_file.h"
#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::mesh {

// An object of a scene: a mesh in its final pose.
struct MeshObject {
  std::string name;            // unique in the scene
  std::string file;            // as the user gave it
  std::uint32_t assembly = 0;  // index into Scene::assemblies
  std::uint32_t mesh = 0;      // index into Assembly::meshes
  Affine world_from_mesh;      // to meters: the unit is part of it
  Box box_m{};                 // world; larger than need be where the manifest turns the object
  std::vector<Vec3d> free_seeds_m;  // world
  double deviation_m = 0;           // that the manifest declares for it
};

struct Scene {
  std::vector<Assembly> assemblies;
  std::vector<MeshObject> objects;         // one per instance
  std::vector<std::string> warnings;       // a line each, with file
  std::vector<MissingFace> missing_faces;  // node: the object's name; world, meters
  Up up = Up::kZ;                          // SceneReading::up
  // Set by a manifest; the command line overrides it.
  std::optional<double> voxel_size_m;
  std::optional<std::uint32_t> layers;
  std::optional<std::array<double, 6>> roi_m;
  std::vector<Vec3d> free_seeds_m;
  std::vector<std::string> without;      // beside that of the command line
  std::set<std::string> parts_left_out;  // of all `without`, those that name a manifest's part

  const Mesh& mesh_of(const MeshObject& object) const {
    return assemblies[object.assembly].meshes[object.mesh];
  }
};

// The objects of a scene that one of several machines bakes: object i of an input belongs to shard
// (number of the input + i) % count.
struct SceneShard {
  std::uint32_t index = 0;
  std::uint32_t count = 1;
};

// A file that a scene needs, with what is wanted of it.
struct FileToRead {
  std::string path;
  ReadOptions options;
};

struct SceneReading {
  std::optional<double> voxel_size_m;  // over a manifest's; exact surfaces are tessellated to it
  Up up = Up::kZ;                      // ReadOptions::up, unless a manifest states a file's own
  bool allow_outside = false;          // whether a manifest may name files outside its own folder
  std::uint64_t missing_faces = 0;     // ReadOptions::missing_faces of each file
  // ReadOptions::without; each names a node of some file, or a part of a manifest
  std::vector<std::string> without;
  SceneShard shard;  // objects of other shards are left out, and not read where that is known
  // Reads each file once, in the order of Scene::assemblies.
  AssemblyReader read = read_assembly;
  // Called once, before the first read(), with all files that will be read: it may begin with them
  // side by side. May be empty.
  std::function<void(std::span<const FileToRead>)> read_ahead;
  std::function<void(double fraction_done)> progress;  // may be empty; one call at a time
};

// Whether an input of read_scene() is a manifest, or names parts of one, by its ending.
bool is_manifest(const std::string& input);

// Reads every input: a mesh or assembly file (`FILE#NODE` for nodes of it), a folder (the mesh
// files in it, sorted by name), or a manifest (`.json`; described in docs/voxelize.md; with `#NAME`
// those of its parts that SceneReading::without would leave out by that name).
// `meters_per_unit` is the user's unit: required where a format defines none (else kUsage), and a
// warning where it overrides one. It does not apply to a manifest's objects, which name theirs.
// Errors of a manifest (kSceneInvalid) name the key. A name of `SceneReading::without` that no file
// has is kSceneInvalid, with the nearest names.
Result<Scene> read_scene(std::span<const std::string> inputs, std::optional<double> meters_per_unit,
                         const SceneReading& reading = {});

// The parts of one manifest that `named` names, or all of them. Its files are read with `options`.
Result<Scene> read_manifest(const NamedFile& named, const ReadOptions& options,
                            const AssemblyReader& read);

}  // namespace forcelayer::mesh
