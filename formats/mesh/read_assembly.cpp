#include <algorithm>
#include <cctype>
#include <fstream>
#include <new>

#include "formats/mesh/mesh.h"
#include "formats/mesh/reader.h"

namespace forcelayer {
namespace {

struct Format {
  const char* name;
  std::string_view signature;   // first bytes of the file; empty where the format has none
  std::string_view extensions;  // ".a.b." each between dots
  Assembly (*read)(const SourceFile&);
};

constexpr Format kFormats[] = {
    {"PLY", "ply", ".ply.", read_ply},
    {"STL", "", ".stl.", read_stl},
    {"OBJ", "", ".obj.", read_obj},
    {"OFF", "", ".off.", read_off},
};

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

const Format& format_of(const SourceFile& file) {
  for (const Format& format : kFormats) {
    if (!format.signature.empty() && file.bytes.starts_with(format.signature)) return format;
  }
  const std::string extension = extension_of(file.path);
  for (const Format& format : kFormats) {
    if (extension.size() > 1 && format.extensions.find(extension + ".") != std::string::npos) {
      return format;
    }
  }
  fail_read(file, ErrorCode::kMeshUnsupported, "",
            "'" + extension + "' is not the extension of a mesh format that is read here",
            "use stl, obj, ply, off");
}

std::string read_whole(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) {
    throw ReadFailure{{ErrorCode::kFileNotFound, path, "", "no such file", ""}};
  }
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(std::filesystem::file_size(path), '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw ReadFailure{{ErrorCode::kReadFailed, path, "", "cannot be read", ""}};
  }
  return bytes;
}

SourceFile split_node(const std::string& path) {
  const auto hash = path.rfind('#');
  if (hash == std::string::npos || std::filesystem::exists(path)) return {path, "", {}};
  return {path.substr(0, hash), path.substr(hash + 1), {}};
}

}  // namespace

Result<Assembly> read_assembly(const std::string& path) {
  SourceFile file = split_node(path);
  try {
    const std::string bytes = read_whole(file.path);
    file.bytes = bytes;
    const Format& format = format_of(file);
    if (!file.node.empty()) {
      fail_read(file, ErrorCode::kSceneInvalid, "#" + file.node,
                std::string(format.name) + " files have no nodes", "leave the part after # out");
    }
    return format.read(file);
  } catch (const ReadFailure& failure) {
    return failure.error;
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kOutOfMemory, file.path, "", "not enough memory to read this mesh", ""};
  }
}

}  // namespace forcelayer
