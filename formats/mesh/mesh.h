// Triangle meshes as files give them: nothing is repaired, merged or dropped.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::mesh {

using Vec3d = std::array<double, 3>;
using Triangle = std::array<std::uint32_t, 3>;  // vertex indices

// One indexed triangle mesh in its own frame and unit. Polygons of the file are split into
// triangles; degenerate, duplicate and non-manifold triangles stay. Indices are in range,
// coordinates finite.
struct Mesh {
  std::vector<Vec3d> vertices;      // [n] file units, mesh frame
  std::vector<Triangle> triangles;  // [m]
  bool single_precision = true;     // whether the file stores its vertices as 32-bit floats
};

// Affine map, row-major 3x4: y = linear * x + translation.
struct Affine {
  std::array<double, 9> linear{1, 0, 0, 0, 1, 0, 0, 0, 1};
  Vec3d translation{0, 0, 0};
};
Vec3d apply(const Affine& a_from_b, const Vec3d& b);
// Bounds every sum that apply() passes through, for points of coordinates up to `largest` in each
// axis: far from the origin of a, a mesh that is brought back to it passes through large ones.
double largest_sum(const Affine& a_from_b, const Vec3d& largest);
Affine compose(const Affine& a_from_b, const Affine& b_from_c);
// Whether it makes a body flat, a line or a point: its columns lie in a plane to within rounding.
bool is_flat(const Affine& affine);

// An axis-aligned box; empty where low > high.
struct Box {
  Vec3d low, high;
};
Box empty_box();
void extend(Box& box, const Vec3d& point);
void extend(Box& box, const Box& other);
Box box_of(const Mesh& mesh, const Affine& a_from_mesh);  // around the vertices, in a
Box box_of(const Box& box, const Affine& a_from_b);       // around the corners of a box, in a

// One placing of a mesh in the assembly.
struct MeshInstance {
  std::uint32_t mesh = 0;  // index into Assembly::meshes
  std::string name;        // path of node names, "/" between; the file's stem where it has none
  Affine assembly_from_mesh;
  Box box{};  // around its vertices; file units, assembly frame
  // How far its triangles may lie from exact surfaces that the file holds (STEP, IGES), file units.
  double deviation_units = 0;
};

// A node of the tree that an assembly format holds.
struct AssemblyNode {
  std::string label;      // unique among its siblings
  std::string path;       // labels from the root on, "/" between
  std::size_t depth = 0;  // 0 for roots
  // The instances of the node and of all below it: those from `first_instance` on, in order.
  std::uint32_t first_instance = 0;
  std::uint32_t instance_count = 0;
};

// A face of an exact surface (STEP, IGES) that has no triangles, or another piece of such a file
// that could not be read: a hole that the user accepted.
struct MissingFace {
  std::string node;  // name of the node that it belongs to; empty where unknown
  Vec3d center{};   // of the box around its edges, else around its node; file units, assembly frame
  double size = 0;  // diagonal of that box, file units; 0 where the place is unknown
};

// The axis that is up.
enum class Up { kZ, kY };

// The content of one mesh file: meshes, and the places where they stand.
struct Assembly {
  std::vector<Mesh> meshes;
  std::vector<MeshInstance> instances;
  // The whole tree, each node before its children; empty for a format without nodes. Nodes that
  // were not read have no instances.
  std::vector<AssemblyNode> nodes;
  std::optional<double> meters_per_unit;  // where the format or file defines it (glTF: 1)
  std::optional<Up> up;                   // as it was read, of a format that is y up (glTF)
  std::vector<std::string> warnings;  // a line each: oddities of a file that was read all the same
  std::vector<MissingFace> missing_faces;  // at most ReadOptions::missing_faces
  std::vector<std::string> left_out;       // those of ReadOptions::without that name a node here
  std::uint64_t triangle_count() const;    // over all instances
  double deviation_units() const;          // the largest of all instances
};

// Sets MeshInstance::box of every instance. A small file may place more vertices than a lifetime
// measures; beyond this count, which takes a second, boxes are those around the corners of boxes,
// and larger than need be where instances are turned.
inline constexpr std::uint64_t kMaxMeasuredVertices = 200'000'000;
void measure_instances(Assembly& assembly);

// How far the reading of a file with exact surfaces is: reported before they are tessellated, and
// then after each node.
struct ReadingProgress {
  double fraction_done = 0;
  double expected_triangles = 0;  // of the whole file, forecast
};

struct ReadOptions {
  double deflection_m = 1e-4;  // of triangles from exact surfaces (STEP, IGES); 0: by their size
  Up up = Up::kZ;              // of glTF: turned to z up, or left as it is
  bool allow_outside = false;  // whether a glTF or STEP file may name files elsewhere
  std::uint64_t missing_faces = 0;  // how many faces of exact surfaces may stay without triangles
  std::vector<std::string> nodes = {};    // those read, with all below; empty: all
  std::vector<std::string> without = {};  // nodes left out, with all below
  std::function<void(const ReadingProgress&)> progress = {};  // of STEP and IGES; may be empty
};

// A ten-thousandth of each surface's size, and no finer than 0.1 mm: what a listing needs. A plant
// that is 300 m across has no more triangles than a bracket.
inline constexpr double kDeflectionBySize = 0;

// ReadOptions::deflection_m of every mesh that is baked for voxels of this size: a hundredth of a
// voxel, for the scene and for the part.
constexpr double baked_deflection_m(double voxel_size_m) { return 0.01 * voxel_size_m; }

// Reads STL, OBJ, PLY, OFF, OM, DRC, glTF/GLB (by content where the format has a signature, else by
// extension), STEP and IGES where built with OpenCASCADE. `path` may end in "#NODES" for nodes of
// an assembly format (node_names.h says how they are named). Never loses a face beyond
// ReadOptions::missing_faces: a file that cannot be read whole is an error with file, place and
// reason (kMesh* codes). A file with no triangles is kMeshEmpty.
Result<Assembly> read_assembly(const std::string& path, const ReadOptions& options = {});
using AssemblyReader =
    std::function<Result<Assembly>(const std::string& path, const ReadOptions& options)>;

}  // namespace forcelayer::mesh
