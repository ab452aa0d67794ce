// The arrows of a picture's contacts: which are drawn, and how long.
#pragma once

#include <cstddef>
#include <vector>

#include "workbench/viewer/plan/view_scene.h"
#include "workbench/viewer/run/contact_view.h"

namespace forcelayer::viewer {

struct Arrows {
  std::vector<std::size_t> points;  // of ContactView::points, the deepest first
  std::size_t left_out = 0;         // contacts that are less deep
  // How many times as long as its point is deep an arrow is: 1, 2 or 5 times a power of ten. As a
  // rule the same in all pictures of a scene and a part: a point a tenth of the force layer deep,
  // or of a voxel, has an arrow of at most half the part's radius. Less where one would be longer
  // than the radius.
  double per_depth = 1;
};

// Number of arrows that a reader can distinguish on a part.
inline constexpr std::size_t kMaxArrows = 100;

// Points in the interior have a mark of their own in place of an arrow.
Arrows arrows_of(const ViewScene& scene, const ContactView& contacts);

}  // namespace forcelayer::viewer
