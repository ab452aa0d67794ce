// A closed surface around the solid of a scene, from the stored distances.
//
// The corners of the grid are the voxel centers, and V = max(0, D - margin)^2, where D is the
// stored lower bound of a center's distance from the mesh and the margin is e_static (plus the
// offset). The space between the centers is cut into tetrahedra, six in each cube around its
// diagonal, in which V is interpolated linearly. The surface is where V = 3/4 s^2.
//
// It contains every point p of the true solid: a center outside of the solid is no farther from it
// than from p, so V <= |p - center|^2 there, and the barycentric mean of these squares is
// sum_a t_a (1 - t_a) s^2 <= 3/4 s^2, where t_a is the position of p between the centers along axis
// a. A center inside of the solid has a negative distance, or lies in a voxel of the mesh, whose
// points are at most sqrt(3/4) s away. Such a center takes the mean over 3/4 s^2 in no case, as a
// center outside is then nearer to the mesh: their distances add up to at most that between them.
//
// It is a manifold without self-intersections: on each edge of the grid it has at most one vertex,
// and each tetrahedron has one triangle or two of it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer::voxinfo {

struct SolidSurface {
  std::vector<std::array<double, 3>> vertices_m;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // outward
};

// The surface that contains all points within `offset_m` of the true solid. With `single_precision`
// it contains them also after its vertices are rounded to floats. Errors (kUsage, with `path`):
// no distances, a cropped side, an offset that the distances do not reach, vertices that floats
// cannot tell apart, no solid, too much of it.
Result<SolidSurface> solid_surface(const Voxmap& map, double offset_m, bool single_precision,
                                   const std::string& path);

// Writes the surface to a .stl, .ply or .glb file. Errors: those of AtomicFile, and kUsage for a
// .glb in a build without the mesh libraries.
Status write_stl(const SolidSurface& surface, const std::string& out);
Status write_ply(const SolidSurface& surface, const std::string& out);
Status write_surface_glb(const SolidSurface& surface, const std::string& out);

}  // namespace forcelayer::voxinfo
