// The direction in which the static surface faces at a contact: the field's slope, averaged over
// neighbors.
//
// There are two estimates of it. The point's own normal is the part's: where an edge or a tilted
// face touches, it is off by the tilt, and always to the same side. A part pushed along its normals
// would push itself along the surface and give the hand energy without end. The slope of the level
// field is the scene's, but along a plane that is oblique to the grid it is off by ten degrees and
// more, to all sides. That error has a wave-length of about a voxel, so it averages out over the
// collected points around, near contacts included.
#pragma once

#include "runtime/field/contact_set.h"
#include "runtime/field/force_field.h"

namespace forcelayer::field {

inline constexpr float kNeighbourVoxels = 5.0f;

// Sets the direction of every contact of `set` that is deeper than `min_depth_m`. `samples` are
// the field's measure() of `points`, and contact n of `set` is sample n.
//
// The average runs over 32 samples in the shell's order, which keeps neighbors together: the 16
// before the contact, the contact and the 15 after it; at the ends of the list its first or last
// 32. A slope g_i at the distance r counts with the weight
//     max(0, 1 - r^2 / R^2)^2 max(0, g . g_i)^2,    R = kNeighbourVoxels voxels,
// so that a wall that faces another way does not count. Where the slopes cancel, the field's own
// direction takes over. Vectors of every width give the same bits.
void average_directions(const query::CollectedPoints& points, const FieldSamples& samples,
                        float voxel_size_m, float min_depth_m, ContactSet& set) noexcept;

}  // namespace forcelayer::field
