// Where along its whole path a part is near to what, as colors on both.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "runtime/clearance/center_path.h"
#include "workbench/exact/surface/animation.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

// How a map was made, m.
struct MapScale {
  double required_m = 0;
  double reach_m = 0;   // a vertex that is as far or farther has this clearance
  double within_m = 0;  // no clearance is too small by more, deviations and rounding apart;
                        // color_by_clearance() sets it to 0 where they are exact
  double margin_m = 0;  // deviations and rounding, which are taken off
  double edge_m = 0;    // no edge is longer where the clearance is less than `reach_m`
};

// The scale for a required clearance: four times that, or eight voxels where none is required.
MapScale scale_of(double required_m, double voxel_m, double margin_m);

// Gives each vertex of the nodes its clearance along the rows and a color, and cuts large triangles
// first. The edges stay longer than scale.edge_m, which is then set to their length, where shorter
// ones would be more than `max_more` triangles more. `scene` holds the objects that count; nodes of
// others get no clearance. Throws Stopped (watch.h), and then has changed nothing.
void color_by_clearance(MovingScene& moving, const Surface& scene, const Surface& part,
                        const clearance::CenterPath& path, MapScale& scale, std::size_t max_more,
                        const std::function<void(double)>& progress);

// Writes the file that request.map names; the answer has warnings alone. Where request.max_s is
// over first, the file has no clearances, with a warning. Errors: those of read_meshes(), of
// reading a path and of write_glb().
Result<voxcheck::ExactAnswer> write_map(const voxcheck::ExactRequest& request);

}  // namespace forcelayer::exact
