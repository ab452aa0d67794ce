#include "formats/mesh/scene.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "formats/mesh/confined_path.h"
#include "formats/mesh/node_names.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/scene_manifest.h"
#include "formats/mesh/units.h"

namespace forcelayer::mesh {
namespace {

// A file, and the place and name of its content in the scene.
struct Placing {
  std::string file;
  std::string name;  // of the object; empty: the file's own names
  std::optional<double> meters_per_unit;
  Affine world_from_object;  // meters
  std::vector<Vec3d> free_seeds_m;
  double deviation_m = 0;
};

Affine scaling(double factor) { return {{factor, 0, 0, 0, factor, 0, 0, 0, factor}, {0, 0, 0}}; }

Status check_inside(const std::string& path, const Manifest& manifest) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (std::size_t i = 0; i < manifest.objects.size(); ++i) {
    if (lies_under(named_file(manifest.objects[i].mesh).path, folder)) continue;
    return Error{ErrorCode::kSceneInvalid, path, "parts[" + std::to_string(i) + "].mesh",
                 kOutsideWhat, kOutsideMend};
  }
  return {};
}

class SceneReader {
 public:
  explicit SceneReader(const SceneReading& reading) : reading_(reading) {}

  Status add(const Placing& placing);
  Status add_manifest(const std::string& path);
  Status add_folder(const std::string& path, std::optional<double> meters_per_unit);
  Status check_left_out() const;
  Scene finish();

 private:
  Result<std::uint32_t> assembly_of(const std::string& file);
  bool is_in_shard(std::size_t number) const {
    return number % reading_.shard.count == reading_.shard.index;
  }

  void show_progress(std::size_t done, std::size_t all) const {
    if (reading_.progress) {
      reading_.progress(static_cast<double>(done) / static_cast<double>(all));
    }
  }

  const SceneReading& reading_;
  Scene scene_;
  std::size_t inputs_ = 0;                     // placings so far
  std::map<std::string, std::uint32_t> read_;  // files read so far
};

// Reads a file on its first use; a manifest may name it several times.
Result<std::uint32_t> SceneReader::assembly_of(const std::string& file) {
  if (const auto found = read_.find(file); found != read_.end()) return found->second;
  ReadOptions options;
  const auto voxel_size_m = reading_.voxel_size_m ? reading_.voxel_size_m : scene_.voxel_size_m;
  if (voxel_size_m) options.deflection_m = baked_deflection_m(*voxel_size_m);
  options.missing_faces = reading_.missing_faces;
  options.without = reading_.without;
  auto assembly = reading_.read(file, options);
  if (!assembly) return assembly.error();
  for (const std::string& warning : assembly->warnings) {
    scene_.warnings.push_back(file + ": " + warning);
  }
  scene_.assemblies.push_back(std::move(*assembly));
  return read_[file] = static_cast<std::uint32_t>(scene_.assemblies.size() - 1);
}

Status SceneReader::add(const Placing& placing) {
  std::size_t number = inputs_++;
  if (!is_in_shard(number) && !may_have_nodes(placing.file)) return {};
  const auto index = assembly_of(placing.file);
  if (!index) return index.error();
  const Assembly& assembly = scene_.assemblies[*index];
  const auto unit =
      meters_per_unit(assembly, placing.file, placing.meters_per_unit, scene_.warnings);
  if (!unit) return unit.error();
  const Affine world_from_assembly = compose(placing.world_from_object, scaling(*unit));
  for (MissingFace face : assembly.missing_faces) {
    if (!placing.name.empty()) face.node = placing.name + "/" + face.node;
    face.center = mesh::apply(world_from_assembly, face.center);
    face.size *= largest_stretch(world_from_assembly);
    scene_.missing_faces.push_back(std::move(face));
  }
  for (const MeshInstance& instance : assembly.instances) {
    if (!is_in_shard(number++)) continue;
    MeshObject& object = scene_.objects.emplace_back();
    object.name = placing.name;
    if (object.name.empty() || assembly.instances.size() > 1) {
      object.name += (object.name.empty() ? "" : "/") + instance.name;
    }
    object.file = placing.file;
    object.assembly = *index;
    object.mesh = instance.mesh;
    object.world_from_mesh = compose(world_from_assembly, instance.assembly_from_mesh);
    object.free_seeds_m = placing.free_seeds_m;
    object.deviation_m =
        placing.deviation_m + assembly.deviation_units * largest_stretch(world_from_assembly);
  }
  return {};
}

Status SceneReader::add_manifest(const std::string& path) {
  auto manifest = read_manifest(path);
  if (!manifest) return manifest.error();
  if (!reading_.allow_outside) {
    if (Status inside = check_inside(path, *manifest); !inside) return inside;
  }
  scene_.voxel_size_m = manifest->voxel_size_m;
  scene_.layers = manifest->layers;
  scene_.roi_m = manifest->roi_m;
  scene_.free_seeds_m.insert(scene_.free_seeds_m.end(), manifest->free_seeds_m.begin(),
                             manifest->free_seeds_m.end());
  for (std::size_t i = 0; i < manifest->objects.size(); ++i) {
    show_progress(i, manifest->objects.size());
    const ManifestObject& object = manifest->objects[i];
    const Status added = add({object.mesh, object.name, object.meters_per_unit,
                              object.world_from_object, object.free_seeds_m, object.deviation_m});
    if (added) continue;
    Error error = added.error();
    if (error.code == ErrorCode::kUsage) error.code = ErrorCode::kSceneInvalid;
    error.where = "parts[" + std::to_string(i) + "] of " + path +
                  (error.where.empty() ? "" : ", " + error.where);
    return error;
  }
  return {};
}

Status SceneReader::add_folder(const std::string& path, std::optional<double> meters_per_unit) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.is_regular_file() && has_mesh_extension(entry.path().string())) {
      files.push_back(entry.path().string());
    }
  }
  if (files.empty()) {
    return Error{ErrorCode::kSceneInvalid, path, "", "the folder holds no mesh files",
                 "name a folder with mesh files"};
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    show_progress(static_cast<std::size_t>(&file - files.data()), files.size());
    if (Status added = add({file, "", meters_per_unit, {}, {}, 0}); !added) return added;
  }
  return {};
}

// Every name of --without must be that of a node.
Status SceneReader::check_left_out() const {
  std::vector<std::string> known;
  for (const Assembly& assembly : scene_.assemblies) {
    for (const MeshInstance& instance : assembly.instances) known.push_back(instance.name);
  }
  for (const std::string& name : reading_.without) {
    const auto has = [&](const Assembly& assembly) {
      return std::find(assembly.left_out.begin(), assembly.left_out.end(), name) !=
             assembly.left_out.end();
    };
    if (std::any_of(scene_.assemblies.begin(), scene_.assemblies.end(), has)) continue;
    return Error{ErrorCode::kSceneInvalid, "", "--without",
                 "no file has a node called " + in_quotes(name), nearest_names_text(name, known)};
  }
  return {};
}

// A name that occurs again gets a number: "bolt", "bolt#2", ...
Scene SceneReader::finish() {
  std::map<std::string, int> seen;
  for (MeshObject& object : scene_.objects) {
    const int number = ++seen[object.name];
    if (number > 1) object.name += "#" + std::to_string(number);
  }
  return std::move(scene_);
}

bool is_manifest(const std::string& input) {
  return std::filesystem::path(input).extension() == ".json";
}

}  // namespace

Result<Scene> read_scene(std::span<const std::string> inputs, std::optional<double> meters_per_unit,
                         const SceneReading& reading) {
  SceneReader reader(reading);
  for (const std::string& input : inputs) {
    std::error_code ignored;
    Status added;
    if (is_manifest(input)) {
      added = reader.add_manifest(input);
    } else if (std::filesystem::is_directory(input, ignored)) {
      added = reader.add_folder(input, meters_per_unit);
    } else {
      added = reader.add({input, "", meters_per_unit, {}, {}, 0});
    }
    if (!added) return added.error();
  }
  if (Status named = reader.check_left_out(); !named) return named.error();
  return reader.finish();
}

}  // namespace forcelayer::mesh
