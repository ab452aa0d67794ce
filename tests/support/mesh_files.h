// Meshes for tests, and writers that turn them into the bytes of every format that is read.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/reader.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {

using Corners = std::vector<std::array<mesh::Vec3d, 3>>;  // the three corners of each triangle

inline Corners corners_of(const mesh::Mesh& mesh, const mesh::Affine& placing = {}) {
  Corners corners;
  for (const auto& [a, b, c] : mesh.triangles) {
    corners.push_back({mesh::apply(placing, mesh.vertices[a]),
                       mesh::apply(placing, mesh.vertices[b]),
                       mesh::apply(placing, mesh.vertices[c])});
  }
  return corners;
}

inline Corners corners_of(const mesh::Assembly& assembly) {
  Corners corners;
  for (const mesh::MeshInstance& instance : assembly.instances) {
    const Corners more = corners_of(assembly.meshes[instance.mesh], instance.assembly_from_mesh);
    corners.insert(corners.end(), more.begin(), more.end());
  }
  return corners;
}

// A unit cube from the origin, 12 triangles, facing outwards.
inline mesh::Mesh cube() {
  mesh::Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2 & 1)});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// A soup of up to `largest` triangles over up to 30 vertices: degenerate and duplicate ones
// included, coordinates of all magnitudes, exact as 32-bit floats.
inline mesh::Mesh random_soup(std::mt19937_64& random, std::size_t largest = 40) {
  mesh::Mesh mesh;
  const std::size_t vertices = 3 + random() % 28;
  std::uniform_real_distribution<double> mantissa(-1, 1);
  for (std::size_t i = 0; i < vertices; ++i) {
    mesh::Vec3d& vertex = mesh.vertices.emplace_back();
    for (double& coordinate : vertex) {
      const int exponent = static_cast<int>(random() % 40) - 20;
      coordinate = static_cast<float>(std::ldexp(mantissa(random), exponent));
    }
  }
  const std::size_t triangles = 1 + random() % largest;
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto corner = [&] { return static_cast<std::uint32_t>(random() % vertices); };
    mesh.triangles.push_back({corner(), corner(), corner()});
  }
  return mesh;
}

// Appends a value's bytes, turned round where `swap`.
template <typename T>
void put(std::string& bytes, T value, bool swap = false) {
  std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (swap) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

inline std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

inline std::string line(const char* start, const mesh::Vec3d& vertex) {
  return start + number(vertex[0]) + " " + number(vertex[1]) + " " + number(vertex[2]) + "\n";
}

inline std::string as_stl_binary(const mesh::Mesh& mesh, std::string_view header = "binary") {
  std::string bytes(header);
  bytes.resize(80, ' ');
  put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& corners : corners_of(mesh)) {
    for (int i = 0; i < 3; ++i) put(bytes, 0.0f);
    for (const mesh::Vec3d& corner : corners) {
      for (const double coordinate : corner) put(bytes, static_cast<float>(coordinate));
    }
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

inline std::string as_stl_ascii(const mesh::Mesh& mesh) {
  std::string text = "solid a name with blanks\n";
  for (const auto& corners : corners_of(mesh)) {
    text += "  facet normal nan 0 0\n    outer loop\n";
    for (const mesh::Vec3d& corner : corners) text += line("      vertex ", corner);
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid a name with blanks\n";
}

inline std::string as_obj(const mesh::Mesh& mesh) {
  std::string text = "# a soup\no soup\n";
  for (const mesh::Vec3d& vertex : mesh.vertices) text += line("v ", vertex);
  for (const mesh::Triangle& t : mesh.triangles) {
    text += "f";
    for (const std::uint32_t corner : t) text += " " + std::to_string(corner + 1);
    text += "\n";
  }
  return text;
}

inline std::string as_off(const mesh::Mesh& mesh) {
  std::string text = "OFF\n" + std::to_string(mesh.vertices.size()) + " " +
                     std::to_string(mesh.triangles.size()) + " 0\n";
  for (const mesh::Vec3d& vertex : mesh.vertices) text += line("", vertex);
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  return text;
}

inline std::string ply_header(const mesh::Mesh& mesh, const char* encoding, const char* type) {
  const std::string property = std::string("property ") + type + " ";
  return std::string("ply\nformat ") + encoding + " 1.0\ncomment soup\nelement vertex " +
         std::to_string(mesh.vertices.size()) + "\n" + property + "x\n" + property + "y\n" +
         property + "z\nproperty uchar red\nelement face " + std::to_string(mesh.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}

inline std::string as_ply_ascii(const mesh::Mesh& mesh) {
  std::string text = ply_header(mesh, "ascii", "double");
  for (const mesh::Vec3d& v : mesh.vertices) {
    text += number(v[0]) + " " + number(v[1]) + " " + number(v[2]) + " 255\n";
  }
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  return text;
}

inline std::string as_ply_binary(const mesh::Mesh& mesh, std::endian order) {
  const bool big = order == std::endian::big;
  std::string bytes = ply_header(mesh, big ? "binary_big_endian" : "binary_little_endian", "float");
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) put(bytes, static_cast<float>(coordinate), big);
    put(bytes, std::uint8_t{255});
  }
  for (const mesh::Triangle& triangle : mesh.triangles) {
    put(bytes, std::uint8_t{3});
    for (const std::uint32_t corner : triangle) put(bytes, static_cast<std::int32_t>(corner), big);
  }
  return bytes;
}

// A GLB container around a JSON text and a binary chunk.
inline std::string as_glb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary.size()));
  put(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  put(bytes, static_cast<std::uint32_t>(binary.size()));
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

// Positions as floats, then indices of 32 bits.
inline std::string gltf_binary(const mesh::Mesh& mesh) {
  std::string binary;
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) put(binary, static_cast<float>(coordinate));
  }
  for (const mesh::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) put(binary, corner);
  }
  return binary;
}

// The JSON that describes gltf_binary(mesh), with `nodes` (and scene 0 of node 0) as given.
inline std::string gltf_json(const mesh::Mesh& mesh, const std::string& nodes = R"([{"mesh":0}])",
                             const std::string& more = "") {
  const std::string vertices = std::to_string(mesh.vertices.size());
  const std::string position_bytes = std::to_string(12 * mesh.vertices.size());
  const std::string index_bytes = std::to_string(12 * mesh.triangles.size());
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
         R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)" +
         R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" + vertices +
         R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)" +
         std::to_string(3 * mesh.triangles.size()) +
         R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + position_bytes +
         R"(},{"buffer":0,"byteOffset":)" + position_bytes + R"(,"byteLength":)" + index_bytes +
         R"(}],"buffers":[{"byteLength":)" +
         std::to_string(12 * (mesh.vertices.size() + mesh.triangles.size())) + "}]" + more + "}";
}

inline std::string as_glb(const mesh::Mesh& mesh) {
  return as_glb(gltf_json(mesh), gltf_binary(mesh));
}

inline std::string write_file(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path.string();
}

// Reads `bytes` as a file of the name "mesh" and `extension`, with "#" and `node` where given.
// In the file's own axes.
inline Result<mesh::Assembly> read_bytes(std::string_view bytes, const std::string& extension,
                                         const std::string& node = "") {
  mesh::SourceFile file{"mesh" + extension, bytes, {}};
  file.options.up = mesh::Up::kY;
  if (!node.empty()) file.options.nodes = {node};
  return mesh::read_source(file);
}

}  // namespace forcelayer::test
