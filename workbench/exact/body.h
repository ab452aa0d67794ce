// One body of a mesh: its triangles, and which places lie inside of them.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "pointshell/certificate/ray_winding.h"
#include "pointshell/certificate/winding_number.h"
#include "pointshell/part/open_edges.h"
#include "pointshell/part/part.h"
#include "pointshell/part/triangle_tree.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

inline part::Vec3 vec3_of(const glm::dvec3& p) { return {p.x, p.y, p.z}; }
inline glm::dvec3 dvec3_of(const part::Vec3& p) { return {p.x, p.y, p.z}; }

class Body {
 public:
  // Cracks between faces that are narrower than `crack_m` do not open a body. `part` has a triangle
  // with an area.
  Body(part::Part part, double crack_m);
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  const part::TriangleTree& tree() const { return tree_; }

  // Whether the triangles have an inside: each edge is closed, or nothing but a crack is open
  // there.
  bool is_solid() const { return is_solid_; }
  // How wide the cracks may be, m; 0 where each edge is closed.
  double crack_m() const { return crack_m_; }
  // The same of those cracks through which a way may lead from one place within `reach_m` of
  // `place_m` to another; 0 where all open edges are farther away.
  double crack_near_m(const part::Vec3& place_m, double reach_m) const;

  // Edges that triangles do not run along as often forwards as backwards: of holes and cracks, and
  // where more than two faces meet.
  struct OpenEdges {
    double length_m = 0;  // of all of them
    part::Vec3 place_m;   // the middle of the longest
  };
  OpenEdges open_edges() const;

  // 1 where the triangles' normals point outwards, -1 where they point inwards.
  double outward() const { return outward_; }

  // Whether a place lies inside: around it the triangles wind once or more, whatever their sides.
  bool holds(const part::Vec3& place_m) const;
  // About how often they do: a fraction where the body is open.
  double winding(const part::Vec3& place_m) const;

  // How often the triangles wind around a place: exact where each edge is closed. None where the
  // ray that counts comes too near an edge for its rounding.
  std::optional<int> windings_by_ray(const part::Vec3& place_m) const {
    return certificate::windings_by_ray(tree_, place_m);
  }

  // Whether a piece may meet the triangles. Where it does not, and the body is closed, all of the
  // piece lies inside or all of it outside.
  bool may_meet(const part::Piece& piece_m) const;

 private:
  bool close_cracks(double max_m);
  bool is_crack(const part::Edge& edge, double crack_m,
                const certificate::WindingNumber& caps) const;
  std::optional<int> windings_past_cracks(const part::Vec3& place_m) const;

  part::Part part_;
  part::TriangleTree tree_;
  std::unique_ptr<certificate::WindingNumber> winding_;
  std::unique_ptr<part::Part> cracks_;  // the open edges of a solid with cracks, as triangles
  std::unique_ptr<part::TriangleTree> crack_tree_;
  bool is_solid_ = false;
  double crack_m_ = 0, outward_ = 1;
};

// Nodes of a surface's tree, and pieces of its triangles.
struct Parts {
  std::vector<std::uint32_t> nodes;
  std::vector<part::Piece> pieces;
  bool empty() const { return nodes.empty() && pieces.empty(); }
};
inline Parts whole_surface() { return {{0}, {}}; }

using Bodies = std::vector<std::unique_ptr<Body>>;

// Cracks of a surface that are narrower do not open it: a thousandth of its diagonal.
double widest_crack_m(const Surface& surface);

// A body for each object of the surface; none for one without area. Closed pieces are turned first
// (turn_outwards()). After one whose shells may run through each other (shells_apart()), its shells
// follow as bodies of their own: a place that is near a face inside of the object may be deep in a
// shell. Two of them may join in a neck that is thinner than each, so the object counts as a whole,
// too.
Bodies bodies_of(const Surface& surface, double crack_m);

// Whether there are any, and each of them is solid.
bool are_solid(const Bodies& bodies);

}  // namespace forcelayer::exact
