// Which way the static surface faces at each contact: the field's slope, averaged over neighbours.
//
// Two estimates of it are at hand, and each fails in its way. The point's own normal is that of the
// part: where an edge or a tilted face touches, it is off by the tilt, and always to the same side,
// so that the part pushes itself along the surface and gives the hand energy without end. The slope
// of the two-bit field at the point is that of the scene, but off by ten degrees and more, to all
// sides, along a plane that is oblique to the grid. Its error has a wave-length of about a voxel:
// over the collected points around, near contacts too, it averages out.
#pragma once

#include "runtime/field/contact_set.h"
#include "runtime/field/force_field.h"
#include "runtime/query/contact_query.h"

namespace forcelayer {

// Sets the direction of every contact of `set` that is deeper than `least_depth_m`. `samples` are
// the field's measure() of `points`, and contact n of `set` is sample n.
//
// The average runs over the 32 samples around in the shell's order (16 before, 15 after; at the
// ends of the list its first or last 32), which keeps neighbours together, with the weight max(0, 1
// - r^2 / R^2)^2 max(0, g . g_i)^2 for slope g at the distance r, R = kNeighbourVoxels voxels: a
// wall that faces another way does not count. Where the slopes cancel, the field's own direction
// takes over. The same bits for any vector width.
void average_directions(const CollectedPoints& points, const FieldSamples& samples,
                        float voxel_size_m, float least_depth_m, ContactSet& set) noexcept;

inline constexpr float kNeighbourVoxels = 5.0f;

}  // namespace forcelayer
