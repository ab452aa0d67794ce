#include <sys/stat.h>

#include <algorithm>
#include <new>

#include "formats/file/file_bytes.h"
#include "formats/mesh/foreign_files.h"
#include "formats/mesh/mesh.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/up_axis.h"

namespace forcelayer::mesh {
namespace {

struct Format {
  const char* name;
  std::string_view signature;   // first bytes of the file; empty where the format has none
  std::string_view extensions;  // each between dots
  bool has_nodes;               // whether "#NODE" makes sense
  bool is_text;                 // where the signature is another
  Assembly (*read)(const SourceFile&);
};

constexpr Format kFormats[] = {
    {"glTF", "glTF", ".glb.gltf.", true, true, read_gltf},
    {"Draco", "DRACO", ".drc.", false, true, read_drc},
    {"PLY", "ply", ".ply.", false, true, read_ply},
    {"STL", "", ".stl.", false, false, read_stl},
    {"OBJ", "", ".obj.", false, true, read_obj},
    {"OFF", "", ".off.", false, true, read_off},
    {"OpenMesh", "", ".om.", false, false, read_om},
    {"STEP", "", ".step.stp.", true, true, read_step},
    {"IGES", "", ".iges.igs.", true, true, read_step},
};

// The format of this extension, or null.
const Format* find_format(const std::string& extension) {
  const auto found =
      std::find_if(std::begin(kFormats), std::end(kFormats), [&](const Format& format) {
        return extension.size() > 1 &&
               format.extensions.find(extension + ".") != std::string_view::npos;
      });
  return found == std::end(kFormats) ? nullptr : found;
}

const Format& format_of(const SourceFile& file) {
  for (const Format& format : kFormats) {
    if (!format.signature.empty() && file.bytes.starts_with(format.signature)) return format;
  }
  const Format* const named = find_format(lower_case_extension(file.path));
  if (named == nullptr) refuse_extension(file);
  if (named->is_text) refuse_foreign_content(file);
  return *named;
}

// Identity, size and time of a file, to find out whether somebody wrote to it meanwhile.
struct PathStamp {
  explicit PathStamp(const std::string& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return;
    device = status.st_dev;
    file = status.st_ino;
    bytes = status.st_size;
    modified = status.st_mtim;
  }

  // False for a file that was replaced: the old one is whole.
  bool written_since(const PathStamp& before) const {
    return device == before.device && file == before.file &&
           (bytes != before.bytes || modified.tv_sec != before.modified.tv_sec ||
            modified.tv_nsec != before.modified.tv_nsec);
  }

  dev_t device = 0;
  ino_t file = 0;
  off_t bytes = 0;
  timespec modified{};
};

}  // namespace

std::vector<NamedFile> unite_by_file(std::span<const std::string> inputs) {
  std::vector<NamedFile> files;
  for (const std::string& input : inputs) {
    NamedFile named = named_file(input);
    const auto known = std::find_if(files.begin(), files.end(),
                                    [&](const NamedFile& file) { return file.path == named.path; });
    if (known == files.end()) {
      files.push_back(std::move(named));
    } else if (known->nodes.empty() || named.nodes.empty()) {
      known->nodes.clear();
    } else {
      known->nodes.push_back(named.nodes.front());
    }
  }
  return files;
}

bool has_mesh_extension(const std::string& path) {
  return find_format(lower_case_extension(path)) != nullptr;
}

bool may_have_nodes(const std::string& path) {
  const Format* const format = find_format(lower_case_extension(named_file(path).path));
  return format == nullptr || format->has_nodes;
}

bool may_crash_its_reader(const std::string& path) {
  const Format* const format = find_format(lower_case_extension(named_file(path).path));
  return format != nullptr && format->read == read_step;
}

// A file that its reader refuses may be of another format than its extension says.
Assembly read_as(const Format& format, const SourceFile& file) {
  try {
    return format.read(file);
  } catch (const ReadFailure&) {
    if (format.signature.empty() || !file.bytes.starts_with(format.signature))
      refuse_wrong_extension(file);
    throw;
  }
}

// Vertices that no triangle uses are no part of a surface: they would make boxes larger.
void drop_unused_vertices(Mesh& mesh) {
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) is_used[corner] = true;
  }
  if (std::find(is_used.begin(), is_used.end(), false) == is_used.end()) return;
  std::vector<std::uint32_t> number(mesh.vertices.size());
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    mesh.vertices[kept] = mesh.vertices[i];
    number[i] = kept++;
  }
  mesh.vertices.resize(kept);
  mesh.vertices.shrink_to_fit();
  for (Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) corner = number[corner];
  }
}

Result<Assembly> read_source(const SourceFile& file) {
  try {
    const std::vector<std::string>& nodes = file.options.nodes;
    if (std::find(nodes.begin(), nodes.end(), "") != nodes.end()) {
      fail_read(file, ErrorCode::kSceneInvalid, "#", "no name follows the #",
                "name a node that voxelize --list prints, or leave out the #");
    }
    const Format& format = format_of(file);
    if (!file.options.nodes.empty() && !format.has_nodes) {
      fail_read(file, ErrorCode::kSceneInvalid, "#" + file.options.nodes.front(),
                std::string(format.name) + " files have no nodes",
                "leave out the # and the text after it");
    }
    Assembly assembly = read_as(format, file);
    if (format.read == read_gltf) {
      assembly.up = file.options.up;
      if (file.options.up == Up::kZ) turn_z_up(assembly);
    }
    for (Mesh& mesh : assembly.meshes) drop_unused_vertices(mesh);
    measure_instances(assembly);
    return assembly;
  } catch (const ReadFailure& failure) {
    return failure.error;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kOutOfMemory, file.path, "", "not enough memory to read this mesh", ""};
  }
}

Result<Assembly> read_assembly(const std::string& path, const ReadOptions& options) {
  NamedFile named = named_file(path);
  SourceFile file{std::move(named.path), {}, options};
  file.options.nodes.insert(file.options.nodes.end(), named.nodes.begin(), named.nodes.end());
  const PathStamp before(file.path);
  const Result<FileBytes> bytes = FileBytes::read(file.path);
  if (!bytes) return bytes.error();
  file.bytes = text_of(*bytes);
  Result<Assembly> assembly = read_source(file);
  if (PathStamp(file.path).written_since(before)) {
    return Error{ErrorCode::kReadFailed, file.path, "", "has changed while it was being read",
                 "start again"};
  }
  return assembly;
}

}  // namespace forcelayer::mesh
