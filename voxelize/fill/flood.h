// F and I of one object: the voxels that the outside reaches without entering the surface, and the
// rest.
#pragma once

#include <memory>
#include <span>

#include "voxelize/masks/mask_tree.h"

namespace forcelayer::fill {

// The interior: voxels neither in `geometry` nor reached by a 6-connected flood from outside the
// object's box and from `seeds` (voxels of the scene). Uniform interior comes as active tiles. A
// seed that lies in `geometry` adds nothing.
std::unique_ptr<masks::MaskTree> flood_interior(const masks::MaskTree& geometry,
                                                std::span<const masks::Coord> seeds);

}  // namespace forcelayer::fill
