#include "formats/mesh/scene.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "formats/command/spelling/spelling.h"
#include "formats/mesh/checks/confined_path.h"
#include "formats/mesh/checks/grouped_warnings.h"
#include "formats/mesh/node_names.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/scene_manifest.h"
#include "formats/mesh/units.h"

namespace forcelayer::mesh {
namespace {

// A file, and the place and name of its content in the scene.
struct Placing {
  std::string file;  // as the user gave it, "#NODE" included
  std::string name;  // of the object; empty: the file's own names
  std::optional<double> meters_per_unit;
  Affine world_from_object;  // meters
  std::vector<Vec3d> free_seeds_m;
  double deviation_m = 0;
  std::string stated_in = {};  // "parts[3] of scene.json"; empty on the command line
  std::optional<Up> up = {};   // that the manifest states
  NamedFile named = {};        // `file`, taken apart
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

// First lists everything that is to be placed, then reads each file once, with all nodes that are
// wanted of it, and places them.
class SceneReader {
 public:
  explicit SceneReader(const SceneReading& reading) : reading_(reading) {}

  Status add_manifest(const NamedFile& named);
  Status add_folder(const std::string& path, std::optional<double> meters_per_unit);
  void add(Placing placing);
  Result<Scene> finish();

 private:
  void leave_out_parts();
  void list_files();
  void tell(const std::string& path, double fraction_done);
  Status place_all();
  Status place(const Placing& placing);
  Result<std::uint32_t> assembly_of(const std::string& path);
  ReadOptions options_for(const std::string& path);
  std::vector<std::string> nodes_wanted_of(const std::string& path) const;
  Up up_of(const std::string& path) const;
  Status check_up() const;
  bool is_in_shard(std::size_t number) const {
    return number % reading_.shard.count == reading_.shard.index;
  }
  bool may_hold_objects(const Placing& placing, std::size_t number) const {
    return is_in_shard(number) || may_have_nodes(placing.file);
  }

  const SceneReading& reading_;
  Scene scene_;
  std::vector<Placing> placings_;
  std::vector<std::string> without_;              // names and lists of them
  std::size_t number_ = 0;                        // of the placing in hand
  std::vector<FileToRead> files_;                 // that will be read, in order
  std::map<std::string, std::uint32_t> read_;     // files read so far
  std::mutex telling_;                            // guards the two below
  std::map<std::string, double> fractions_read_;  // of files
  double files_read_ = 0;                         // the sum of these
  GroupedWarnings warnings_{"files"};
};

void SceneReader::add(Placing placing) {
  placing.named = named_file(placing.file);
  placings_.push_back(std::move(placing));
}

// Whether a name, of a part or of several, means the manifest's part that is called so.
bool means_part(const std::string& name, const std::string& part) {
  return !part.empty() && (fits_name(part, name) || fits_name(part, command::unescaped(name)));
}

// The names of a list, unless a part is called as the list is written.
template <typename Parts>
std::vector<std::string> part_names_in(const std::string& list, const Parts& parts) {
  return names_in(list, std::any_of(parts.begin(), parts.end(),
                                    [&](const auto& part) { return bears_name(part.name, list); }));
}

// Keeps the parts that one of the names means.
Status keep_parts(const NamedFile& named, Manifest& manifest) {
  std::vector<bool> is_kept(manifest.objects.size());
  for (const std::string& list : named.nodes) {
    for (const std::string& name : part_names_in(list, manifest.objects)) {
      bool any = false;
      for (std::size_t i = 0; i < manifest.objects.size(); ++i) {
        if (!means_part(name, manifest.objects[i].name)) continue;
        any = is_kept[i] = true;
      }
      if (any) continue;
      std::string parts;
      constexpr std::size_t kListed = 8;
      for (std::size_t i = 0, listed = 0; i < manifest.objects.size() && listed < kListed; ++i) {
        if (manifest.objects[i].name.empty()) continue;
        parts +=
            (listed++ == 0 ? "use one of the names, such as " : ", ") + manifest.objects[i].name;
      }
      return Error{ErrorCode::kSceneInvalid, named.path, "#" + name,
                   "no entry under \"parts\" has this \"name\"",
                   parts.empty() ? "give the wanted entry this \"name\"" : parts};
    }
  }
  std::size_t n = 0;
  std::erase_if(manifest.objects, [&](const ManifestObject&) { return !is_kept[n++]; });
  return {};
}

Status SceneReader::add_manifest(const NamedFile& named) {
  const std::string& path = named.path;
  auto manifest = read_manifest(path);
  if (!manifest) return manifest.error();
  if (!reading_.allow_outside) {
    if (Status inside = check_inside(path, *manifest); !inside) return inside;
  }
  if (!named.nodes.empty()) {
    if (Status kept = keep_parts(named, *manifest); !kept) return kept;
  }
  scene_.voxel_size_m = manifest->voxel_size_m;
  scene_.layers = manifest->layers;
  scene_.roi_m = manifest->roi_m;
  scene_.free_seeds_m.insert(scene_.free_seeds_m.end(), manifest->free_seeds_m.begin(),
                             manifest->free_seeds_m.end());
  scene_.without.insert(scene_.without.end(), manifest->without.begin(), manifest->without.end());
  for (std::size_t i = 0; i < manifest->objects.size(); ++i) {
    const ManifestObject& object = manifest->objects[i];
    add({object.mesh, object.name, object.meters_per_unit, object.world_from_object,
         object.free_seeds_m, object.deviation_m, "parts[" + std::to_string(i) + "] of " + path,
         object.up});
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
    return Error{ErrorCode::kSceneInvalid, path, "", "the folder contains no mesh files",
                 "name a folder with mesh files"};
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) add({file, "", meters_per_unit, {}, {}, 0});
  return {};
}

// The nodes of a file that the placings being read ask for; empty means the whole file.
std::vector<std::string> SceneReader::nodes_wanted_of(const std::string& path) const {
  std::vector<std::string> wanted;
  for (const Placing& placing : placings_) {
    if (placing.named.path != path) continue;
    if (placing.named.nodes.empty()) return {};
    for (const std::string& node : placing.named.nodes) {
      if (std::find(wanted.begin(), wanted.end(), node) == wanted.end()) wanted.push_back(node);
    }
  }
  return wanted;
}

Up SceneReader::up_of(const std::string& path) const {
  for (const Placing& placing : placings_) {
    if (placing.named.path == path && placing.up) return *placing.up;
  }
  return reading_.up;
}

// A file is read once, for all its placings.
Status SceneReader::check_up() const {
  for (const Placing& placing : placings_) {
    if (placing.up.value_or(reading_.up) == up_of(placing.named.path)) continue;
    return Error{ErrorCode::kSceneInvalid, placing.named.path, placing.stated_in,
                 "the scene uses this file with two different \"up\" axes",
                 "give the same \"up\" to all entries of \"parts\" that use this file"};
  }
  return {};
}

ReadOptions SceneReader::options_for(const std::string& path) {
  ReadOptions options;
  const auto voxel_size_m = reading_.voxel_size_m ? reading_.voxel_size_m : scene_.voxel_size_m;
  if (voxel_size_m) options.deflection_m = baked_deflection_m(*voxel_size_m);
  options.missing_faces = reading_.missing_faces;
  options.up = up_of(path);
  options.nodes = nodes_wanted_of(path);
  options.without = without_;
  options.progress = [this, path](const ReadingProgress& file) { tell(path, file.fraction_done); };
  return options;
}

// Lists the files of all placings that this shard may hold objects of.
void SceneReader::list_files() {
  std::set<std::string> listed;
  for (std::size_t number = 0; number < placings_.size(); ++number) {
    if (!may_hold_objects(placings_[number], number)) continue;
    const std::string& path = placings_[number].named.path;
    if (listed.insert(path).second) files_.push_back({path, options_for(path)});
  }
}

// Files may be read side by side.
void SceneReader::tell(const std::string& path, double fraction_done) {
  const std::lock_guard lock(telling_);
  files_read_ += fraction_done - std::exchange(fractions_read_[path], fraction_done);
  if (reading_.progress) reading_.progress(files_read_ / static_cast<double>(files_.size()));
}

// Reads a file on its first use.
Result<std::uint32_t> SceneReader::assembly_of(const std::string& path) {
  if (const auto found = read_.find(path); found != read_.end()) return found->second;
  const FileToRead& file = files_[read_.size()];  // they are listed in the order of first use
  auto assembly = reading_.read(file.path, file.options);
  if (!assembly) return assembly.error();
  tell(path, 1);
  for (const std::string& warning : assembly->warnings) {
    warnings_.add(path, warning);
  }
  scene_.assemblies.push_back(std::move(*assembly));
  return read_[path] = static_cast<std::uint32_t>(scene_.assemblies.size() - 1);
}

// The instances of an assembly, and the paths of their nodes, that a placing names.
struct Chosen {
  std::vector<bool> instances;
  std::set<std::string> paths;
};

Result<Chosen> chosen_of(const Placing& placing, const Assembly& assembly) {
  Chosen chosen{std::vector<bool>(assembly.instances.size(), placing.named.nodes.empty()), {}};
  const auto is_chosen = choose_nodes(placing.named.nodes, assembly.nodes);
  if (!is_chosen) return is_chosen.error();
  for (std::size_t i = 0; i < assembly.nodes.size(); ++i) {
    const AssemblyNode& node = assembly.nodes[i];
    if (!(*is_chosen)[i]) continue;
    chosen.paths.insert(node.path);
    std::fill_n(chosen.instances.begin() + node.first_instance, node.instance_count, true);
  }
  return chosen;
}

Status SceneReader::place(const Placing& placing) {
  std::size_t number = number_++;
  if (!may_hold_objects(placing, number)) return {};
  const auto index = assembly_of(placing.named.path);
  if (!index) return index.error();
  const Assembly& assembly = scene_.assemblies[*index];
  const auto chosen = chosen_of(placing, assembly);
  if (!chosen) return chosen.error();
  std::vector<std::string> warnings;
  const auto unit =
      meters_per_unit(assembly, placing.named.path, placing.meters_per_unit, warnings);
  if (!unit) {
    Error error = unit.error();
    if (!placing.stated_in.empty())
      error.mend = "add the unit to this part, for example \"units\": \"mm\"";
    return error;
  }
  for (const std::string& warning : warnings) warnings_.add(placing.named.path, warning);
  const Affine world_from_assembly = compose(placing.world_from_object, scaling(*unit));
  for (MissingFace face : assembly.missing_faces) {
    const bool may_be_elsewhere = !placing.named.nodes.empty() && !face.node.empty();
    if (may_be_elsewhere && !chosen->paths.contains(face.node)) continue;
    if (!placing.name.empty()) face.node = placing.name + "/" + face.node;
    face.center = mesh::apply(world_from_assembly, face.center);
    face.size *= largest_stretch(world_from_assembly);
    scene_.missing_faces.push_back(std::move(face));
  }
  const auto count = std::count(chosen->instances.begin(), chosen->instances.end(), true);
  for (std::size_t i = 0; i < assembly.instances.size(); ++i) {
    if (!chosen->instances[i]) continue;
    const MeshInstance& instance = assembly.instances[i];
    if (!is_in_shard(number++)) continue;
    MeshObject& object = scene_.objects.emplace_back();
    object.name = placing.name;
    if (object.name.empty() || count > 1) {
      object.name += (object.name.empty() ? "" : "/") + instance.name;
    }
    object.file = placing.file;
    object.assembly = *index;
    object.mesh = instance.mesh;
    object.world_from_mesh = compose(world_from_assembly, instance.assembly_from_mesh);
    object.box_m = box_of(instance.box, world_from_assembly);
    object.free_seeds_m = placing.free_seeds_m;
    object.deviation_m =
        placing.deviation_m + instance.deviation_units * largest_stretch(world_from_assembly);
  }
  return {};
}

Status SceneReader::place_all() {
  for (const Placing& placing : placings_) {
    const Status placed = place(placing);
    if (placed) continue;
    Error error = placed.error();
    if (error.file.empty()) error.file = placing.named.path;
    if (placing.stated_in.empty()) return error;
    // A file is read for the first placing that needs it, with the nodes of all.
    const auto culprit =
        std::find_if(placings_.begin(), placings_.end(), [&](const Placing& other) {
          return other.named.path == placing.named.path && !other.named.nodes.empty() &&
                 error.where == "#" + other.named.nodes.front();
        });
    const Placing& stated = culprit == placings_.end() ? placing : *culprit;
    if (error.code == ErrorCode::kUsage) error.code = ErrorCode::kSceneInvalid;
    error.where = stated.stated_in + (error.where.empty() ? "" : ", " + error.where);
    return error;
  }
  return {};
}

// Takes the names of --without that are those of a manifest's parts: such a part is not read.
void SceneReader::leave_out_parts() {
  std::vector<std::string> names;
  for (const std::string& list : without_) {
    for (std::string& name : part_names_in(list, placings_)) names.push_back(std::move(name));
  }
  const auto is_left_out = [&](const Placing& placing) {
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      if (!means_part(name, placing.name)) return false;
      scene_.parts_left_out.insert(name);
      return true;
    });
  };
  std::erase_if(placings_, is_left_out);
}

Result<Scene> SceneReader::finish() {
  for (const auto* list : {&reading_.without, &std::as_const(scene_.without)}) {
    without_.insert(without_.end(), list->begin(), list->end());
  }
  leave_out_parts();
  if (Status same = check_up(); !same) return same.error();
  scene_.up = reading_.up;
  list_files();
  if (reading_.read_ahead) reading_.read_ahead(files_);
  if (Status placed = place_all(); !placed) return placed.error();
  std::vector<std::string> parts;
  for (const Placing& placing : placings_) {
    if (!placing.name.empty()) parts.push_back(placing.name);
  }
  const Status named = check_left_out(without_, scene_.assemblies, scene_.parts_left_out, parts);
  if (!named) return named.error();
  if (scene_.objects.empty() && !scene_.parts_left_out.empty()) {
    return Error{
        ErrorCode::kMeshEmpty, "", "--without",
        "leaves out all parts of the manifest, so the scene would be empty",
        "leave out fewer parts, or add a part; nothing can block the last part of an assembly"};
  }
  // A name that occurs again gets a number: "bolt", "bolt#2", ...
  std::map<std::string, int> seen;
  for (MeshObject& object : scene_.objects) {
    const int number = ++seen[object.name];
    if (number > 1) object.name += "#" + std::to_string(number);
  }
  scene_.warnings = warnings_.lines();
  return std::move(scene_);
}

}  // namespace

bool is_manifest(const std::string& input) {
  return std::filesystem::path(file_of(input)).extension() == ".json";
}

Result<Scene> read_scene(std::span<const std::string> inputs, std::optional<double> meters_per_unit,
                         const SceneReading& reading) {
  SceneReader reader(reading);
  for (const std::string& input : inputs) {
    std::error_code ignored;
    Status added;
    if (is_manifest(input)) {
      added = reader.add_manifest(named_file(input));
    } else if (std::filesystem::is_directory(input, ignored)) {
      added = reader.add_folder(input, meters_per_unit);
    } else {
      reader.add({input, "", meters_per_unit, {}, {}, 0});
    }
    if (!added) return added.error();
  }
  return reader.finish();
}

Result<Scene> read_manifest(const NamedFile& named, const ReadOptions& options,
                            const AssemblyReader& read) {
  SceneReading reading;
  reading.up = options.up;
  reading.allow_outside = options.allow_outside;
  reading.missing_faces = options.missing_faces;
  reading.without = options.without;
  reading.read = [&](const std::string& path, ReadOptions own) {
    own.deflection_m = options.deflection_m;
    return read(path, own);
  };
  std::vector<std::string> inputs;
  for (const std::string& node : named.nodes) inputs.push_back(named.path + "#" + node);
  if (inputs.empty()) inputs.push_back(named.path);
  return read_scene(inputs, {}, reading);
}

}  // namespace forcelayer::mesh
