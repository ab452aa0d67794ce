// The camera of a picture: frames a whole scene, or finds a direction in which nothing hides the
// part.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "formats/voxmap.h"
#include "workbench/viewer/plan/view_scene.h"

namespace forcelayer::viewer {

// A parallel projection, z up where the direction allows it.
struct CameraView {
  glm::dvec3 target_m{0, 0, 0};  // world
  glm::dvec3 to_eye{0, 0, 1};    // unit, from the target towards the eye
  glm::dvec3 up{0, 1, 0};        // unit, across to_eye
  double half_height_m = 1;      // of the picture, in the scene
};

// From ahead of -y, somewhat to +x and from above.
glm::dvec3 default_direction();

// `direction` towards the eye (any length but zero), with z upwards in the picture, y where the
// direction is along z.
CameraView camera_along(const glm::dvec3& direction);

// Where the eye is and what is up, both of unit length and across each other.
struct Orbit {
  glm::dvec3 to_eye, up;
};

// Goes about z by `about_z_rad`, and over the scene by `rise_rad`, to straight above or below at
// most. Up is never below the horizon after it.
Orbit turned(const Orbit& orbit, double about_z_rad, double rise_rad);

// The camera that shows all of `box`; `aspect` is width over height of the picture.
CameraView frame_box(const WorldBox& box, const glm::dvec3& direction, double aspect);

// The direction from which most of `points_m` (world) are seen past interior voxels, looking
// `reach_m` far. Near ties go to one across `forces` (any length), so that contacts are seen from
// the side, and near default_direction().
glm::dvec3 clearest_direction(const Voxmap& voxmap, const std::vector<glm::dvec3>& points_m,
                              const glm::dvec3& forces, double reach_m);

}  // namespace forcelayer::viewer
