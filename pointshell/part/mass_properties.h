// Area, volume, centroid and inertia of a part.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/pshell_format.h"
#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::part {

struct MassProperties {
  MassSource source = MassSource::kArea;
  double area_m2 = 0;
  double volume_m3 = 0;               // 0 where the source is the area
  std::uint64_t loose_triangles = 0;  // that do not count in the volume
  Vec3 centroid;                      // m, part frame
  // Inertia tensor about the centroid per unit mass, part axes: xx yy zz xy xz yz, m^2. The
  // off-diagonal elements are the tensor's own, -integral of xy and so on.
  std::array<double, 6> inertia_m2{};
};

// Whether triangles run along every edge as often forwards as backwards. Then the divergence
// theorem holds for the body that they bound.
bool is_closed(std::span<const mesh::Triangle> triangles);

// Computed from the volume where the part is closed, its volume positive and its moments those of
// some mass (a surface that crosses itself can have others), else from the area as of a thin sheet.
// The volume is that of all triangles or, where these are not closed, of those that are not
// `loose`. Triangles must face outwards. The integrals are those of Eberly, "Polyhedral Mass
// Properties", 2002, over tetrahedra about the middle of the part.
MassProperties mass_properties(const Part& part, const std::vector<bool>& loose = {});

}  // namespace forcelayer::part
