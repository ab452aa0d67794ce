#include "formats/mesh/scene.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "formats/mesh/confined_path.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/scene_manifest.h"
#include "formats/mesh/units.h"

namespace forcelayer {
namespace {

// Where a file's content goes.
struct Placing {
  std::string file;
  std::string name;  // of the part; empty: the file's own names
  std::optional<double> meters_per_unit;
  Affine world_from_part;  // meters
  std::vector<Vec3d> free_seeds_m;
  double deviation_m = 0;
};

Affine scaling(double factor) { return {{factor, 0, 0, 0, factor, 0, 0, 0, factor}, {0, 0, 0}}; }

// The instances of these stand in one file. Other formats hold one mesh, which stands once.
bool is_assembly_format(const std::string& file) {
  const std::string path = file.substr(0, file.rfind('#'));
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const char* single : {".stl", ".obj", ".ply", ".off", ".om", ".drc"}) {
    if (extension == single) return false;
  }
  return true;
}

Status check_inside(const std::string& path, const Manifest& manifest) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (std::size_t i = 0; i < manifest.parts.size(); ++i) {
    if (lies_under(named_file(manifest.parts[i].mesh).path, folder)) continue;
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
  Scene finish();

 private:
  Result<std::uint32_t> assembly_of(const std::string& file);
  bool is_ours(std::size_t number) const {
    return number % reading_.share.count == reading_.share.index;
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

// A file that stands in a manifest several times is read once.
Result<std::uint32_t> SceneReader::assembly_of(const std::string& file) {
  if (const auto found = read_.find(file); found != read_.end()) return found->second;
  ReadOptions options;
  const auto voxel_size_m = reading_.voxel_size_m ? reading_.voxel_size_m : scene_.voxel_size_m;
  if (voxel_size_m) options.deflection_m = kDeflectionVoxels * *voxel_size_m;
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
  if (!is_ours(number) && !is_assembly_format(placing.file)) return {};
  const auto index = assembly_of(placing.file);
  if (!index) return index.error();
  const Assembly& assembly = scene_.assemblies[*index];
  const auto unit =
      meters_per_unit(assembly, placing.file, placing.meters_per_unit, scene_.warnings);
  if (!unit) return unit.error();
  const Affine world_from_assembly = compose(placing.world_from_part, scaling(*unit));
  for (const MeshInstance& instance : assembly.instances) {
    if (!is_ours(number++)) continue;
    ScenePart& part = scene_.parts.emplace_back();
    part.name = placing.name;
    if (part.name.empty() || assembly.instances.size() > 1) {
      part.name += (part.name.empty() ? "" : "/") + instance.name;
    }
    part.file = placing.file;
    part.assembly = *index;
    part.mesh = instance.mesh;
    part.world_from_mesh = compose(world_from_assembly, instance.assembly_from_mesh);
    part.free_seeds_m = placing.free_seeds_m;
    part.deviation_m =
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
  for (std::size_t i = 0; i < manifest->parts.size(); ++i) {
    show_progress(i, manifest->parts.size());
    const ManifestPart& part = manifest->parts[i];
    const Status added = add({part.mesh, part.name, part.meters_per_unit, part.world_from_part,
                              part.free_seeds_m, part.deviation_m});
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
  const std::vector<std::string> extensions = {".stl", ".obj",  ".ply",  ".off", ".om",   ".drc",
                                               ".glb", ".gltf", ".step", ".stp", ".iges", ".igs"};
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    std::string extension = entry.path().extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (entry.is_regular_file() &&
        std::find(extensions.begin(), extensions.end(), extension) != extensions.end()) {
      files.push_back(entry.path().string());
    }
  }
  if (files.empty()) {
    return Error{ErrorCode::kSceneInvalid, path, "", "the folder holds no mesh files", ""};
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    show_progress(static_cast<std::size_t>(&file - files.data()), files.size());
    if (Status added = add({file, "", meters_per_unit, {}, {}, 0}); !added) return added;
  }
  return {};
}

// Names that occur again get a number: "bolt", "bolt#2", ...
Scene SceneReader::finish() {
  std::map<std::string, int> seen;
  for (ScenePart& part : scene_.parts) {
    const int number = ++seen[part.name];
    if (number > 1) part.name += "#" + std::to_string(number);
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
  return reader.finish();
}

}  // namespace forcelayer
