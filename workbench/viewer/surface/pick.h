// The first voxel that a ray through a voxmap meets.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <string_view>

#include "formats/voxmap.h"
#include "workbench/viewer/surface/cut.h"
#include "workbench/viewer/surface/shown_voxels.h"

namespace forcelayer::viewer {

// In the world. `along` need not have unit length, but some.
struct Ray {
  glm::dvec3 from_m{0, 0, 0}, along{0, 0, 1};
};

// The first interior voxel on the ray, on the side that the cut leaves, that is of no hidden
// object; nothing where there is none.
std::optional<std::array<std::int64_t, 3>> interior_on(const Voxmap& voxmap, const Ray& ray,
                                                       const std::optional<Cut>& cut,
                                                       const HiddenObjects& hidden = {});

// How far along the ray that voxel begins.
double entry_of(const Voxmap& voxmap, const Ray& ray, const std::array<std::int64_t, 3>& voxel);

// The name of the object that a voxel is nearest to; empty where none is known.
std::string_view object_of(const Voxmap& voxmap, const std::array<std::int64_t, 3>& voxel);

}  // namespace forcelayer::viewer
