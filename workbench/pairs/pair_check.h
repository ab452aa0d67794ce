// Two parts as installed: how far they are apart, or how deep one lies in the other, by their
// triangles.
//
// Surfaces that meet may touch or overlap. They overlap where a place of one surface is deeper in
// the other part than deviations and rounding explain (exact/depth.h). Parts of which all surfaces
// coincide have no such place: they overlap where a place in both is that far from both surfaces.
// Surfaces that do not meet overlap where one part lies inside the other. Beside an open mesh a
// pair is undecided where a place of the other part may be inside of it.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "workbench/exact/body.h"
#include "workbench/exact/mesh_distance.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::pairs {

// A part with the trees of its triangles. Several threads may use it.
class Shape {
 public:
  // `surface` in the world, with a triangle or more.
  Shape(exact::Surface surface, const mesh::Box& box_m);

  const mesh::Box& box_m() const { return box_m_; }
  const std::shared_ptr<const exact::MeshPair::Mesh>& mesh() const { return mesh_; }
  std::size_t triangles() const { return triangles_; }
  // None where no triangle has an area. It is made at the first call.
  const exact::Body* body() const;
  // It alone; none where body() is none.
  const exact::Bodies& bodies() const { return body(), bodies_; }
  bool is_solid() const { return body() != nullptr && body()->is_solid(); }

  // Triangles that hang together by their corners: a place of their surface, and their box. Found
  // at the first call of body().
  struct Piece {
    part::Vec3 place_m;
    mesh::Box box_m;
  };
  const std::vector<Piece>& pieces() const { return body(), pieces_; }

 private:
  mesh::Box box_m_;
  std::size_t triangles_;
  std::shared_ptr<const exact::MeshPair::Mesh> mesh_;
  mutable std::once_flag once_;
  mutable exact::Surface surface_;  // until the body is made
  mutable exact::Bodies bodies_;
  mutable std::vector<Piece> pieces_;
};

enum class Contact {
  kApart,      // no surfaces meet, and no part lies inside the other
  kTouch,      // no nearer and no deeper than deviations, rounding and near cracks explain
  kOverlap,    // deeper than these explain
  kClose,      // the depth is so near to that bound that it may lie on either side
  kUndecided,  // nobody knows whether a place is inside: a mesh is open
};

struct PairMeasure {
  Contact contact = Contact::kApart;
  double distance_m = 0;         // between the surfaces; 0 where they meet
  double depth_m = 0;            // of an overlap: of the deepest place that was found
  bool is_at_least = false;      // the depth may be more than was found
  double crack_m = 0;            // the width of the cracks near it, which explain as much depth
  bool is_first_deep = true;     // of an overlap: the first part's surface is inside the second
  std::array<double, 3> at_m{};  // the place, world: the middle of the nearest, or the deepest
  std::string doubt;             // why contact or distance is less certain; empty: it is not
};

// How two parts lie, whose deviations and rounding are `margin_m` together. None where they are
// `beyond_m` apart or more, and no part may lie inside the other. Names are for the doubt, and
// asked for where there is one.
struct NamedShape {
  const Shape& shape;
  std::function<std::string()> name;
};
std::optional<PairMeasure> measure_pair(const NamedShape& first, const NamedShape& second,
                                        double beyond_m, double margin_m);

}  // namespace forcelayer::pairs
