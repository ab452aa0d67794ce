// Inward normals of shell points, smoothed over the covering radius without rounding real edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part/vec3.h"
#include "pointshell/sample/restricted_cells.h"

namespace forcelayer::normals {

struct ShellNormals {
  std::vector<part::Vec3> inward;  // unit
  std::vector<double> cone_cos;    // of the half-angle of the cone about `inward` that holds the
                                   // normals of all triangles within the radius of the point
  std::vector<std::uint8_t> two_sided;  // 1 on a sheet: `inward` is a normal of it, either way
};

// The part's triangles must face outwards; `cells` must have been made for all of `points`.
//
// Rule. (1) The seed is the normal at the nearest surface point: the face's, and on edges and
// corners the angle-weighted mean of the faces that meet there (Baerentzen and Aanaes, "Signed
// distance computation using the angle weighted pseudonormal", 2005). (2) The normal is the mean of
// the normals over the surface within `radius` of that point, weighted by area times a weight of
// the angle to the seed: 1 up to 30 degrees, falling to 0 at 60 (bilateral normal filtering: Zheng,
// Fu, Au and Tai 2011; without the angle's weight it is the integral invariant of Pottmann,
// Wallner, Huang and Yang 2009). The mean is an exact integral, so it changes continuously from
// point to point. The facets of a curved surface blend; the faces on the two sides of an edge do
// not.
//
// A point stands on a sheet where a triangle of one (`of_sheet`) passes through the point of the
// surface nearest to it. Its cone holds all directions.
ShellNormals shell_normals(const sample::RestrictedCells& cells, std::span<const part::Vec3> points,
                           double radius, const std::vector<bool>& of_sheet);

// Area of the part of triangle a, b, c that lies within `radius` of `center`.
double area_within_ball(const part::Vec3& center, double radius, const part::Vec3& a,
                        const part::Vec3& b, const part::Vec3& c);

}  // namespace forcelayer::normals
