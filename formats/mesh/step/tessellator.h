// Tessellates the shapes of a STEP or IGES file.
#pragma once

#include <TopoDS_Shape.hxx>
#include <TopoDS_TShape.hxx>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_set>
#include <vector>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// A face that got no triangles, or some that do not reach its outline.
struct LostFace {
  Vec3d center_mm{};      // of the box around its edges, in the shape's frame
  double size_mm = 0;     // diagonal of that box
  bool has_edges = true;  // else the box is that of the shape
};

// The box around the edges of a shape; size 0 where it has none.
LostFace box_of_edges(const TopoDS_Shape& shape);

using FaceSet = std::unordered_set<const TopoDS_TShape*>;

struct Tessellation {
  Mesh mesh;  // in the shape's frame, millimeters
  std::vector<LostFace> lost;
  std::uint64_t dropped = 0;    // faces without area that need no triangles
  double dropped_reach_mm = 0;  // no point of those is farther from their edges
  std::uint64_t sewn = 0;       // loose faces that were joined first
  double sewn_gap_mm = 0;       // how far an edge so joined may be from its faces
  double sewing_tolerance_mm = 0;
  std::uint64_t open_edges = 0;  // of the loose faces, after that
  double edge_gap_mm = 0;        // how far an edge may be from its faces, as OpenCASCADE found it
  // The same by tolerances alone, which tie edges to corners that are elsewhere: counts where
  // OpenCASCADE finds nothing.
  double tied_gap_mm = 0;
  double surface_gap_mm = 0;  // how far a surface may be from the triangles, where edges are not
  double deflection_mm = 0;   // of the triangles, as asked of OpenCASCADE
  double wanted_deflection_mm = 0;
  double deviation_mm = 0;  // how far a point of the shape may be from the triangles
};

// A shape whose faces do not all get triangles that reach their outlines is tried again at finer
// deflections; the whole shape each time, so that faces still meet at their edges. A face that then
// still has none is dropped where that leaves no hole: all its edges belong to faces that have
// triangles, and no point of it is farther than a deflection from them. For what is left coarser
// deflections are tried. Before all that, loose faces are sewn within a deflection.
class StepTessellator {
 public:
  StepTessellator(const SourceFile& file, double deflection_mm)
      : file_(file), deflection_mm_(deflection_mm) {}

  // Shapes, or parts of them, that should close and do not: holes in their triangles count.
  void add_open_bodies(std::span<const TopoDS_Shape> bodies);

  // `name` is the node, for errors.
  Tessellation tessellate(const TopoDS_Shape& shape, const std::string& name);

  // How many triangles `shape` will have, about.
  double forecast(const TopoDS_Shape& shape) const;

  // The deflection of `shape`, before it is known how large its triangles are.
  double deflection_mm(const TopoDS_Shape& shape) const;

 private:
  Tessellation tessellate_at(const TopoDS_Shape& shape, double deflection_mm) const;
  Tessellation tessellate_sewn(const TopoDS_Shape& shape, double deflection_mm) const;

  const SourceFile& file_;
  double deflection_mm_;
  FaceSet faces_of_open_bodies_;
};

}  // namespace forcelayer::mesh
