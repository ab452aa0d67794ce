// The parts of audit_voxmap(). Internal to formats/audit/.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "formats/voxmap.h"

namespace forcelayer::voxmap_audit {

using Voxel = std::array<std::int64_t, 3>;

class Contents;

// Every clearance is true (section 5): of the boxes inside nodes by distances that spread from cell
// to cell, of others, and where these say too little, by looking at all that lies within its reach.
Status audit_clearances(const Voxmap& map, const Contents& contents, std::string_view name);

// The values are the layers around the interior that voxmap_format.md, section 10, defines: the
// surface is the force layers around it, proximity one more, and all else is free. With k = 0
// in the Chebyshev metric proximity alone is looked at. A neighborhood of nodes that occurs many
// times is looked at once.
Status audit_layers(const Voxmap& map, const Contents& contents, std::string_view name);

// Codes of distances are possible beside the values (section 13.2) and beside each other: over a
// face an unsigned distance changes by a voxel at most. A pair of entries is looked at once.
Status audit_distances(const Voxmap& map, std::string_view name);

// No brick names an object above object_count.
Status audit_objects(const Voxmap& map, std::string_view name);

inline Error untrue(std::string_view name, std::string where, std::string what) {
  return {ErrorCode::kEntryInvalid, std::string(name), std::move(where), std::move(what),
          "bake it again"};
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

}  // namespace forcelayer::voxmap_audit
