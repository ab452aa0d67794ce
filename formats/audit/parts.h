// The parts of audit_voxmap(). Internal to formats/audit/.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "formats/voxmap.h"

namespace forcelayer::voxmap_audit {

using Voxel = std::array<std::int64_t, 3>;

class Contents;
class Effort;

// Each proves a part of the facts, and ends with strewn() where the effort is spent before.

// Proves every clearance (section 5). Inside nodes, distances that spread from cell to cell prove
// it. Where they prove too little, and for directory cells, every box within the clearance's reach
// is looked at.
Status audit_clearances(const Voxmap& map, const Contents& contents, Effort& effort,
                        std::string_view name);

// Proves that the values are the layers around the interior (voxmap_format.md, section 10): the
// force layers around it are surface, one more layer is proximity, and all else is free. With k = 0
// in the Chebyshev metric only proximity is checked. Equal neighborhoods of nodes are checked once.
Status audit_layers(const Voxmap& map, const Contents& contents, Effort& effort,
                    std::string_view name);

// Proves that the interior can be that of offset_layers layers (section 13.6), where only values
// say so: without distances. Equal neighborhoods of nodes are checked once.
Status audit_layer_count(const Voxmap& map, const Contents& contents, Effort& effort,
                         std::string_view name);

// Proves that the header's lengths and layers agree; and that every code is possible beside its
// value (section 13.2). Equal pairs of entries are checked once.
Status audit_distances(const Voxmap& map, Effort& effort, std::string_view name);

// Proves that every code is possible beside those of its neighbors (section 13.5). Equal
// surroundings are checked once where they stand near each other.
Status audit_code_neighbors(const Voxmap& map, Effort& effort, std::string_view name);

// Proves that no brick names an object above object_count.
Status audit_objects(const Voxmap& map, std::string_view name);

inline Error untrue(std::string_view name, std::string where, std::string what) {
  return {ErrorCode::kEntryInvalid, std::string(name), std::move(where), std::move(what),
          "bake it again"};
}

// For a file that would take far longer to prove than one of its size that was baked.
inline Error strewn(std::string_view name) {
  return untrue(name, "tree",
                "uses the same nodes and bricks at too many positions: they cannot all be checked");
}

inline std::string voxel_text(const Voxel& at) {
  return "voxel " + std::to_string(at[0]) + " " + std::to_string(at[1]) + " " +
         std::to_string(at[2]);
}

// A half-open box of world voxels.
struct Span {
  Voxel low{}, high{};

  static Span cube(const Voxel& low, std::int64_t edge) {
    return {low, {low[0] + edge, low[1] + edge, low[2] + edge}};
  }
  bool empty() const { return low[0] >= high[0] || low[1] >= high[1] || low[2] >= high[2]; }
  bool operator==(const Span&) const = default;
};

inline Span intersection(const Span& a, const Span& b) {
  Span both;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    both.low[axis] = std::max(a.low[axis], b.low[axis]);
    both.high[axis] = std::min(a.high[axis], b.high[axis]);
  }
  return both;
}

inline Span shifted(Span box, const Voxel& by, std::int64_t sign) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] += sign * by[axis];
    box.high[axis] += sign * by[axis];
  }
  return box;
}

inline Span grown(Span box, std::int64_t by) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] -= by;
    box.high[axis] += by;
  }
  return box;
}

// The voxels of a box that no cropped side hides.
inline Span known_part(const Span& box, const KnownBox& known) {
  Span part = box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    part.low[axis] = std::max(part.low[axis], known.low[axis]);
    part.high[axis] = std::min(part.high[axis], known.high[axis]);
  }
  return part;
}

// The distances that a code stands for, in words.
std::string range_text(const VoxmapHeader& header, std::uint32_t code);

}  // namespace forcelayer::voxmap_audit
