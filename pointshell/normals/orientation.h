// Making all triangles of a part face outwards, or refusing a mesh without a clear inside.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pointshell/part/copies.h"
#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::normals {

// An open patch with the outside on both sides.
struct Sheet {
  std::string body;
  std::uint64_t triangles = 0;
  double area_m2 = 0;
  part::Vec3 middle;  // of its box, m, part frame
  double size_m = 0;  // diagonal of that box
};

struct OrientationReport {
  std::uint64_t patches = 0;              // connected over edges that two triangles share
  std::uint64_t flipped_triangles = 0;    // turned round with respect to the file
  std::uint64_t hidden_triangles = 0;     // in patches that (almost) no ray leaves
  std::uint64_t undecided_triangles = 0;  // in patches too small to matter, left as in the file
  std::uint64_t boundary_edges = 0;       // with one triangle
  std::uint64_t nonmanifold_edges = 0;    // with more than two
  std::vector<Sheet> sheets;              // the largest area first
  std::vector<bool> of_sheet;             // [triangle]
  // [triangle] in an open patch that is hidden, or too small to matter: what it bounds is no volume
  std::vector<bool> loose;
};

// Turns triangles round so that their normals point out of the part. Those of sheets stay as they
// are in their patch.
//
// Triangles of a body that share an edge with exactly one other are joined into patches and made
// consistent: the smaller area is turned. Then rays decide which side of the whole patch is outside
// (Takayama, Jacobson, Kavan and Sorkine-Hornung, "A simple method for correcting facet
// orientations in polygon meshes based on ray casting", 2014). They start at points spread over the
// patch; the outside is the side from which more rays leave the part without meeting it again,
// whatever the orientation in the file. Holes and gaps do no harm while most rays from within meet
// the part. Only bodies of the same group count (separate_groups() with a reach of twice
// `negligible_size_m`), so bodies that are far away cast no shadow. A patch that no ray leaves,
// because other bodies of its group hide it, is judged within its own body. A patch that is hidden
// there too (a cavity) is turned as the larger area of its body's visible patches. A patch of flat
// triangles only stays as it is in itself.
//
// The decisiveness (front - back) / (front + back) of the fractions of rays that leave is 1 for a
// closed body and 0 for a flat sheet. A patch with less than 0.15 either way is a sheet, unless it
// is smaller than `negligible_size_m` or has no area. Copies are judged as their originals.
OrientationReport orient_outwards(part::Part& part, double negligible_size_m,
                                  std::span<const part::CopiedGroup> copies = {});

}  // namespace forcelayer::normals
