#include "formats/mesh/reader.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

namespace forcelayer::mesh {

std::string_view text_of(const FileBytes& file) {
  return {reinterpret_cast<const char*>(file.bytes().data()), file.bytes().size()};
}

void fail_read(const SourceFile& file, ErrorCode code, std::string where, std::string what,
               std::string mend) {
  throw ReadFailure{{code, file.path, std::move(where), std::move(what), std::move(mend)}};
}

std::string lower_case_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::string at_byte(std::uint64_t offset) { return "byte " + std::to_string(offset); }

void check_count(const SourceFile& file, std::uint64_t count, const char* what) {
  if (count <= std::numeric_limits<std::uint32_t>::max()) return;
  fail_read(file, ErrorCode::kMeshUnsupported, "",
            std::to_string(count) + " " + what + " are too many for 32-bit indices",
            "split the mesh into several files");
}

void check_finite(const SourceFile& file, const Mesh& mesh, const std::string& where) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const auto& [x, y, z] = mesh.vertices[i];
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) continue;
    fail_read(file, ErrorCode::kMeshUnreadable,
              (where.empty() ? "" : where + " ") + "vertex " + std::to_string(i),
              "a coordinate is not a finite number", "export the mesh again");
  }
}

void check_not_empty(const SourceFile& file, const Mesh& mesh) {
  if (!mesh.triangles.empty()) return;
  fail_read(file, ErrorCode::kMeshEmpty, "",
            mesh.vertices.empty() ? "no triangles in this file"
                                  : "no triangles in this file, only points or lines",
            "export a surface mesh");
}

Assembly assembly_of(const SourceFile& file, Mesh mesh) {
  check_not_empty(file, mesh);
  Assembly assembly;
  assembly.meshes.push_back(std::move(mesh));
  assembly.instances.push_back({0, std::filesystem::path(file.path).stem().string(), {}});
  return assembly;
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text = "'";
  text += word.substr(0, kLongest);
  text += word.size() > kLongest ? "...'" : "'";
  return text;
}

std::string counted(std::uint64_t count, const char* singular) {
  std::string text = std::to_string(count) + " " + singular;
  if (count == 1) return text;
  if (text.ends_with('y')) return text.substr(0, text.size() - 1) + "ies";
  return text + "s";
}

}  // namespace forcelayer::mesh
