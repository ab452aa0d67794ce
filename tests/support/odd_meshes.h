// Whole mesh files that are odd, damaged or empty, as exporters and broken transfers leave them.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/mesh_files.h"
#include "tests/support/models.h"

namespace forcelayer::test {

struct OddMesh {
  const char* file;         // its name, whose extension tells the format
  std::string (*bytes)();   // null: the bytes of that file of tests/models
  std::uint64_t triangles;  // what a reader makes of it; 0: an error
  ErrorCode code = ErrorCode::kInternal;
  const char* fragment = "";  // a part of the error's line
};

inline void PrintTo(const OddMesh& mesh, std::ostream* out) { *out << mesh.file; }

// The file's path: in tests/models, or in `folder` where it is written first.
inline std::string path_of(const OddMesh& mesh, const ScratchFolder& folder) {
  return mesh.bytes == nullptr ? model_path(mesh.file)
                               : write_file(folder / mesh.file, mesh.bytes());
}

namespace odd {

// A grid of rows x columns quads bent to a torus: closed, facing outwards.
inline mesh::Mesh torus(std::uint32_t rows, std::uint32_t columns) {
  mesh::Mesh mesh;
  for (std::uint32_t i = 0; i < rows * columns; ++i) {
    const double turn = 2 * std::numbers::pi * (i / columns) / rows;
    const double tube = 2 * std::numbers::pi * (i % columns) / columns;
    const double from_axis = 3 + std::cos(tube);
    mesh.vertices.push_back(
        {from_axis * std::cos(turn), from_axis * std::sin(turn), std::sin(tube)});
  }
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; j < columns; ++j) {
      const std::uint32_t i1 = (i + 1) % rows, j1 = (j + 1) % columns;
      const std::uint32_t a = i * columns + j, b = i1 * columns + j, c = i1 * columns + j1;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, i * columns + j1});
    }
  }
  return mesh;
}

// A hundred triangles that share nothing.
inline mesh::Mesh soup() {
  std::mt19937_64 random(100);
  std::uniform_real_distribution<double> place(0, 1);
  mesh::Mesh mesh;
  for (std::uint32_t n = 0; n < 100; ++n) {
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back({place(random), place(random), place(random)});
    }
    mesh.triangles.push_back({3 * n, 3 * n + 1, 3 * n + 2});
  }
  return mesh;
}

// A closed surface with triangles missing, doubled, turned round and without area, in any order.
inline mesh::Mesh broken() {
  mesh::Mesh mesh = torus(40, 50);
  std::mt19937_64 random(1);
  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  mesh.triangles.resize(3800);
  for (std::size_t n = 0; n < 40; ++n) {
    std::swap(mesh.triangles[n][0], mesh.triangles[n][1]);
    mesh.triangles.push_back(mesh.triangles[100 + n]);
    const auto [a, b, c] = mesh.triangles[200 + n];
    mesh.triangles.push_back({a, b, n % 2 == 0 ? a : b});
  }
  return mesh;
}

// PLY's strips: two triangles a quad, the rows parted by -1. A strip's every other triangle stands
// the other way round.
inline std::string tristrips(std::uint32_t rows, std::uint32_t columns) {
  const mesh::Mesh mesh = torus(rows, columns);
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " +
      std::to_string(mesh.vertices.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n";
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) put(bytes, static_cast<float>(coordinate));
  }
  put(bytes, static_cast<std::int32_t>(rows * (2 * columns + 3)));
  for (std::uint32_t i = 0; i < rows; ++i) {
    for (std::uint32_t j = 0; j <= columns; ++j) {
      put(bytes, static_cast<std::int32_t>(i * columns + j % columns));
      put(bytes, static_cast<std::int32_t>((i + 1) % rows * columns + j % columns));
    }
    put(bytes, std::int32_t{-1});
  }
  return bytes;
}

// A prism over the outline of a wall with a window, whose edges a slit joins: two polygons that are
// not convex, and the walls inside and outside. Lines go on after a backslash, and corners name
// texture coordinates and normals that stand only behind the faces.
inline std::string wall_with_hole() {
  constexpr std::array<std::array<int, 2>, 10> kOutline = {
      {{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}, {3, 3}, {3, 7}, {7, 7}, {7, 3}, {3, 3}}};
  std::string text = "# a wall\r\n\r\nmtllib none.mtl\r\nusemtl \r\n", behind;
  const int corners = static_cast<int>(kOutline.size());
  for (const char* z : {" 0", " 1"}) {
    for (const auto& [x, y] : kOutline) {
      text += "v " + std::to_string(x) + " " + std::to_string(y) + z + "\r\n";
      behind += "vt 0 0\r\nvn 0 0 1\r\n";
    }
  }
  const auto corner = [](int number) {
    const std::string name = std::to_string(number + 1);
    return " " + name + "/" + name + "/" + name;
  };
  for (const bool top : {false, true}) {
    text += "f";
    for (int i = 0; i < corners; ++i) {
      text += corner(top ? corners + i : corners - 1 - i);
      if (i % 4 == 3) text += " \\\r\n";
    }
    text += "\r\n";
  }
  for (int i = 0; i + 1 < corners; ++i) {
    if (i == 4) continue;  // the slit
    text +=
        "f" + corner(i) + corner(i + 1) + corner(corners + i + 1) + corner(corners + i) + "\r\n";
  }
  return text + behind;
}

// Three cubes, each below the one before and stretched by it.
inline std::string nested_glb() {
  const mesh::Mesh mesh = cube();
  return as_glb(
      gltf_json(mesh,
                R"([{"name":"block01","mesh":0,"children":[1],"scale":[0.25,0.5,0.25],)"
                R"("translation":[-1,0.5,0]},)"
                R"({"name":"block02","mesh":0,"children":[2],"scale":[1,3.5,1],)"
                R"("translation":[3,-2.5,0]},)"
                R"({"name":"block03","mesh":0,"scale":[0.75,0.5,0.75],"translation":[0,-2,0]}])"),
      gltf_binary(mesh));
}

inline std::string cube_off_body() {
  return " 1 0 1\n 0 1 1 # see this vertex be odd\n-1 0 1\n 0 -1 1\n 1 0 -1\n 0 1 -1\n-1 0 -1\n"
         " 0 -1 -1\n4 0 1 2 3  1 0 0 0.75\n4 7 4 0 3  0.3 0.4 0 0.75\n4 4 5 1 0  0.2 0.5 0.1 0.75\n"
         "4 5 6 2 1  0.1 0.6 0.2 0.75\n4 3 2 6 7  0 0.7 0.3 0.75\n4 6 5 4 7  0 1 0 0.75\n";
}

inline std::string ply_of_points(std::size_t points) {
  std::mt19937_64 random(points);
  std::uniform_real_distribution<double> place(-100, 100);
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face 0\n"
                     "property list uchar int vertex_indices\nend_header\n";
  for (std::size_t i = 0; i < points; ++i) {
    text += line("", {place(random), place(random), place(random)});
  }
  return text;
}

inline std::string obj_vertices(const mesh::Mesh& mesh, const char* behind = "") {
  std::string text = "# a modeler's export\no Cube\n";
  for (const mesh::Vec3d& v : mesh.vertices) {
    text += "v " + number(v[0]) + " " + number(v[1]) + " " + number(v[2]) + behind + "\n";
  }
  return text;
}

inline std::string obj_faces(const mesh::Mesh& mesh, const char* line_end) {
  std::string text;
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " +
            std::to_string(c + 1) + line_end;
  }
  return text;
}

// Every triangle with three vertices of its own.
inline mesh::Mesh unwelded(const mesh::Mesh& mesh) {
  mesh::Mesh apart;
  for (const auto& corners : corners_of(mesh)) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    apart.vertices.insert(apart.vertices.end(), corners.begin(), corners.end());
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

// An ASCII STL of two solids, with the line ends of another system.
inline std::string two_solids() {
  const std::string text = as_stl_ascii(cube()) + as_stl_ascii(torus(4, 3));
  std::string bytes;
  for (const char c : text) bytes += c == '\n' ? std::string("\r\n") : std::string(1, c);
  return bytes;
}

// A scan that broke off in the middle.
inline std::string cut_in_half() {
  const std::string whole = as_stl_binary(torus(250, 100));
  return whole.substr(0, whole.size() / 2);
}

inline std::string nodes_without_meshes() {
  return as_glb(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"extras":{"age":32,"height":0.987},)"
      R"("nodes":[2]}],"nodes":[{"name":"children_1","translation":[-5,5,0]},)"
      R"({"name":"children_2"},{"children":[0,1],"name":"parent"}]})",
      "");
}

inline std::string ply_without_vertices() {
  return "ply\nformat ascii 1.0\ncomment without vertices\nelement vertex 0\n"
         "property float x\nproperty float y\nproperty float z\nproperty float nx\n"
         "element face 0\nproperty list uchar uint vertex_indices\nend_header\n";
}

inline std::string cube_with_colors_that_are_no_numbers() {
  return obj_vertices(cube(), " nan nan nan") + obj_faces(cube(), "\r\n") + "\r\n";
}

inline std::string cube_of_lines() {
  return obj_vertices(cube()) + "l 1 2\nl 3 4\nl 5 6\nl 7 8\nl 1 3\nl 2 4\nl 5 7\nl 6 8\nl 1 5\n";
}

constexpr OddMesh kReadable[] = {
    {"broken.STL", [] { return as_stl_binary(broken(), "FileType: Binary"); }, 3880},
    {"comments.off", [] { return "OFF\n#\n#  cube.off\n#\n\n8 6 12\n" + cube_off_body(); }, 12},
    {"nested.glb", nested_glb, 36},
    {"multibody.stl", two_solids, 36},
    {"nancolor.obj", cube_with_colors_that_are_no_numbers, 12},
    {"unwelded.obj", [] { return as_obj(unwelded(torus(8, 6))); }, 96},
    {"soup.stl", [] { return as_stl_binary(soup(), std::string(1, '\0')); }, 100},
    {"tristrips.ply", [] { return tristrips(200, 100); }, 40000},
    {"wallhole.obj", wall_with_hole, 32},
    {"whitespace.off", [] { return "\t             OFF8 6 12 # or nah\n" + cube_off_body(); }, 12},
};

constexpr OddMesh kUnreadable[] = {
    {"empty.obj", [] { return std::string("# nothing but a remark\n"); }, 0, ErrorCode::kMeshEmpty,
     "no triangles"},
    {"empty.ply", ply_without_vertices, 0, ErrorCode::kMeshEmpty, "no triangles"},
    {"empty.stl", [] { return std::string("solid Empty\nendsolid Empty"); }, 0,
     ErrorCode::kMeshEmpty, "no triangles"},
    {"empty_nodes.glb", nodes_without_meshes, 0, ErrorCode::kMeshEmpty, "no node with a mesh"},
    {"obj_points.obj", [] { return obj_vertices(cube()); }, 0, ErrorCode::kMeshEmpty,
     "only points or lines"},
    {"obj_wireframe.obj", cube_of_lines, 0, ErrorCode::kMeshEmpty, "only points or lines"},
    {"ply_empty_header.ply", [] { return std::string("ply\nformat ascii 1.0\nend_header\n"); }, 0,
     ErrorCode::kMeshEmpty, "no triangles"},
    {"ply_points_ascii.ply", [] { return ply_of_points(8); }, 0, ErrorCode::kMeshEmpty,
     "only points or lines"},
    {"points_emptyface.ply", [] { return ply_of_points(1024); }, 0, ErrorCode::kMeshEmpty,
     "only points or lines"},
    {"stl_empty_ascii.stl",
     [] { return std::string("solid Exported 2.91.0\nendsolid Exported 2.91.0\n"); }, 0,
     ErrorCode::kMeshEmpty, "no triangles"},
    {"stl_empty_bin.stl", [] { return as_stl_binary({}, "Exported 2.91.0"); }, 0,
     ErrorCode::kMeshEmpty, "no triangles"},
    {"truncated_binary.stl", cut_in_half, 0, ErrorCode::kMeshIncomplete,
     "announces 50000 triangles"},
};

}  // namespace odd

}  // namespace forcelayer::test
