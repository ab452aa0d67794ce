// Joins faces that stand loose.
#pragma once

#include <TopoDS_Shape.hxx>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace forcelayer::mesh {

// A shape whose loose faces are sewn.
struct SewnShape {
  TopoDS_Shape shape;
  std::uint64_t faces = 0;       // that were loose
  double gap_mm = 0;             // how far a joined edge may be from its faces, by its tolerance
  std::uint64_t open_edges = 0;  // count_open_edges()
};

// Joins the faces of `shape` that are in no shell, as IGES has them, where their edges are within
// `tolerance_mm` of each other: they then get the same triangles' corners there. Nothing where
// fewer than two are loose, no two meet, or a face would be lost.
std::optional<SewnShape> sew_loose_faces(const TopoDS_Shape& shape, double tolerance_mm);

// How many edges only one face of `shape` ends at.
std::uint64_t count_open_edges(const TopoDS_Shape& shape);

// The same where all faces are sewn within `tolerance_mm`.
std::uint64_t count_open_edges(const TopoDS_Shape& shape, double tolerance_mm);

// The first shape that each of `shapes` meets, over others too: shapes meet where edges at which
// their faces end are within `tolerance_mm` of each other.
std::vector<std::size_t> first_met(std::span<const TopoDS_Shape> shapes, double tolerance_mm);

// The faces of `shapes`, in no shell.
TopoDS_Shape loose_faces_of(std::span<const TopoDS_Shape> shapes);

}  // namespace forcelayer::mesh
