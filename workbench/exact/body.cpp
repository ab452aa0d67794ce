#include "workbench/exact/body.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "pointshell/normals/orientation.h"
#include "pointshell/part/mass_properties.h"
#include "workbench/exact/surface/shells.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

using part::Vec3;

// Places around an open edge at which the winding number is looked at.
constexpr int kDirections = 6, kMinSamples = 3, kMaxSamples = 16;
constexpr double kSampleSpacing = 16;   // widths of a crack
constexpr double kWidestCrack = 1e-3;   // of the diagonal of a surface
constexpr double kNarrowest = 0x1p-10;  // of the widest cracks: those looked for first
// A winding number that is farther from a whole number tells a hole. Beside a crack as wide as the
// way to the place it is off by 0.16, and the numbers are in error by 0.01.
constexpr double kWhole = 0.2;
// A winding number is only asked for whether it is nearer to 0: groups of triangles are dipoles
// from two of their radii on (Barill and others 2018).
constexpr double kFar = 2;
// Rounding of a length along a direction, as a fraction of the largest coordinate: far above it.
constexpr double kRounding = 1e-13;
constexpr double kRoundUp = 1 + 1e-9;  // exceeds the rounding of a distance

// The ends of a piece along a direction.
std::array<double, 2> shadow(const part::Piece& piece, const Vec3& direction) {
  const double a = part::dot(piece[0], direction), b = part::dot(piece[1], direction),
               c = part::dot(piece[2], direction);
  return {std::min({a, b, c}), std::max({a, b, c})};
}

// Whether a direction is found along which two triangles lie apart, by more than the rounding of
// `largest_m`, the largest coordinate: their normals, the normals of two edges, and those of each
// edge in its plane.
bool are_apart(const part::Piece& p, const part::Piece& q, double largest_m) {
  const auto parts = [&](const Vec3& direction) {
    const double smallest = kRounding * largest_m * part::length(direction);
    const auto [p_low, p_high] = shadow(p, direction);
    const auto [q_low, q_high] = shadow(q, direction);
    return q_low - p_high > smallest || p_low - q_high > smallest;
  };
  const Vec3 of_p = part::cross(p[1] - p[0], p[2] - p[0]);
  const Vec3 of_q = part::cross(q[1] - q[0], q[2] - q[0]);
  if (parts(of_p) || parts(of_q)) return true;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 edge = p[(n + 1) % 3] - p[n];
    if (parts(part::cross(of_p, edge))) return true;
    if (parts(part::cross(of_q, q[(n + 1) % 3] - q[n]))) return true;
    for (std::size_t m = 0; m < 3; ++m) {
      if (parts(part::cross(edge, q[(m + 1) % 3] - q[m]))) return true;
    }
  }
  return false;
}

double largest_of(const part::Piece& piece) {
  double largest = 0;
  for (const Vec3& p : piece) {
    largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  }
  return largest;
}

}  // namespace

Body::Body(part::Part part, double crack_m)
    : part_(std::move(part)),
      tree_(part_),
      winding_(std::make_unique<certificate::WindingNumber>(tree_)) {
  is_solid_ = part::is_closed(part_.triangles) || close_cracks(crack_m);
  if (!is_solid_) {
    // Faces may have been turned to different sides.
    normals::orient_outwards(part_, crack_m);
    winding_ = std::make_unique<certificate::WindingNumber>(tree_);
    is_solid_ = close_cracks(crack_m);
  }
  double volume = 0;
  const Vec3 origin = part_.vertices.front();
  for (std::size_t t = 0; t < part_.triangles.size(); ++t) {
    const part::Piece piece = part::triangle_piece(part_, t);
    volume += part::dot(piece[0] - origin, part::cross(piece[1] - origin, piece[2] - origin));
  }
  outward_ = volume < 0 ? -1 : 1;
}

// Finds how wide its cracks may be: the narrower, the closer a depth is known. An edge that is more
// than a crack is mostly more than one of another width, too, so it is looked at first then. The
// widest come first of all: an edge of a hole is found among them.
bool Body::close_cracks(double max_m) {
  std::vector<part::Edge> open;
  const std::map<part::Edge, int> balance = part::open_edges_of(part_.triangles);
  for (const auto& [edge, sum] : balance) open.push_back(edge);
  if (open.empty()) return true;  // some faces were turned, no more
  const part::Part caps = part::caps_of(part_, balance);
  const part::TriangleTree tree(caps);
  const certificate::WindingNumber winding(tree);
  const auto are_cracks = [&](double crack_m) {
    const auto more = std::find_if(open.begin(), open.end(), [&](const part::Edge& edge) {
      return !is_crack(edge, crack_m, winding);
    });
    if (more == open.end()) return true;
    std::iter_swap(more, open.begin());
    return false;
  };
  const bool closes = are_cracks(max_m);
  for (crack_m_ = kNarrowest * max_m; crack_m_ <= max_m; crack_m_ *= 2) {
    if (!(crack_m_ == max_m ? closes : are_cracks(crack_m_))) continue;
    cracks_ = std::make_unique<part::Part>();
    cracks_->vertices = part_.vertices;
    for (const auto& [low, high] : open) cracks_->triangles.push_back({low, high, high});
    crack_tree_ = std::make_unique<part::TriangleTree>(*cracks_);
    return true;
  }
  crack_m_ = 0;  // it is open: no crack widens what it may go through
  return false;
}

double Body::crack_near_m(const Vec3& place_m, double reach_m) const {
  if (crack_m_ == 0) return 0;
  return crack_tree_->is_within(place_m, kRoundUp * (reach_m + crack_m_)) ? crack_m_ : 0;
}

// Farther from open edges than cracks are wide the winding number is whole, but for what
// is_crack() allows. So along a ray that stays there it changes where that crosses triangles, by
// one each, and is 0 at the end.
std::optional<int> Body::windings_past_cracks(const Vec3& place_m) const {
  if (certificate::is_ray_within(*crack_tree_, place_m, kRoundUp * crack_m_)) return std::nullopt;
  return windings_by_ray(place_m);
}

bool Body::holds(const Vec3& place_m) const {
  if (is_solid_) {
    const auto windings = crack_m_ == 0 ? windings_by_ray(place_m) : windings_past_cracks(place_m);
    if (windings) return *windings != 0;
  }
  return std::abs(winding(place_m)) > 0.5;
}

double Body::winding(const Vec3& place_m) const { return winding_->at(place_m, kFar); }

bool Body::may_meet(const part::Piece& piece) const {
  const double largest_m = largest_of(piece);
  part::Box box;
  for (const Vec3& corner : piece) box.grow(corner);
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    const part::TriangleTree::Node& node = tree_.nodes()[at];
    // Rounded outwards, as the piece's may be off.
    const double off = kRounding * largest_m;
    if (node.low[0] > box.high.x + off || node.high[0] < box.low.x - off ||
        node.low[1] > box.high.y + off || node.high[1] < box.low.y - off ||
        node.low[2] > box.high.z + off || node.high[2] < box.low.z - off) {
      continue;
    }
    for (std::uint32_t n = 0; n < node.count; ++n) {
      const part::Piece other =
          part::triangle_piece(part_, tree_.ordered_triangles()[node.first + n]);
      if (!are_apart(piece, other, std::max(largest_m, largest_of(other)))) return true;
    }
    if (node.count > 0) continue;
    open.push_back(node.first);
    open.push_back(at + 1);
  }
  return false;
}

Body::OpenEdges Body::open_edges() const {
  OpenEdges found;
  double longest_m = -1;
  for (const auto& [edge, balance] : part::open_edges_of(part_.triangles)) {
    const Vec3 &a = part_.vertices[edge.first], &b = part_.vertices[edge.second];
    const double length_m = part::length(b - a);
    found.length_m += length_m;
    if (length_m > longest_m) longest_m = length_m, found.place_m = 0.5 * (a + b);
  }
  return found;
}

// Around an open edge the winding number is whole but where a hole is near. So is that of `caps`.
bool Body::is_crack(const part::Edge& open, double crack_m,
                    const certificate::WindingNumber& caps) const {
  const Vec3 from = part_.vertices[open.first], edge = part_.vertices[open.second] - from;
  const Vec3 along = part::normalized(edge), across = part::any_perpendicular(along);
  const Vec3 third = part::cross(along, across);
  const double wanted = part::length(edge) / (kSampleSpacing * crack_m);
  const int samples = std::clamp(static_cast<int>(std::min(wanted, 1e3)), kMinSamples, kMaxSamples);
  for (int n = 0; n < samples * kDirections; ++n) {
    keep_going();
    const double fraction = (n / kDirections + 0.5) / samples;
    const double turn = 2 * std::numbers::pi * (n % kDirections + 0.3) / kDirections;
    const Vec3 place = from + fraction * edge + (crack_m * std::cos(turn)) * across +
                       (crack_m * std::sin(turn)) * third;
    if (tree_.is_within(place, crack_m / 2)) continue;
    const double winding = caps.at(place);
    if (std::abs(winding - std::round(winding)) > kWhole) return false;
  }
  return true;
}

double widest_crack_m(const Surface& surface) {
  part::Box box;
  for (const mesh::Triangle& t : surface.triangles) {
    for (const std::uint32_t corner : t) box.grow(vec3_of(surface.vertices_m[corner]));
  }
  return surface.triangles.empty() ? 0 : kWidestCrack * part::length(box.high - box.low);
}

Bodies bodies_of(const Surface& surface, double crack_m) {
  Surface turned = surface;
  turn_outwards(turned);
  std::map<std::uint32_t, std::vector<mesh::Triangle>> by_object;
  for (std::size_t t = 0; t < turned.triangles.size(); ++t) {
    by_object[turned.object[t]].push_back(turned.triangles[t]);
  }
  Bodies bodies;
  const auto add = [&](std::vector<mesh::Triangle> triangles) {
    mesh::Assembly assembly;
    mesh::Mesh& mesh = assembly.meshes.emplace_back();
    std::map<std::uint32_t, std::uint32_t> own;  // number of a vertex in the mesh
    for (mesh::Triangle& t : triangles) {
      for (std::uint32_t& corner : t) {
        const auto [at, is_new] =
            own.try_emplace(corner, static_cast<std::uint32_t>(mesh.vertices.size()));
        const glm::dvec3& v = turned.vertices_m[corner];
        if (is_new) mesh.vertices.push_back({v.x, v.y, v.z});
        corner = at->second;
      }
    }
    mesh.triangles = std::move(triangles);
    assembly.instances.emplace_back();
    const part::PartInput input{&assembly, 1};
    auto part = part::assemble_part({&input, 1});
    if (part) bodies.push_back(std::make_unique<Body>(std::move(*part), crack_m));
    return part.ok();
  };
  Surface own;
  own.vertices_m = turned.vertices_m;
  for (auto& [object, triangles] : by_object) {
    if (!add(triangles)) continue;
    own.triangles = std::move(triangles);
    own.object.assign(own.triangles.size(), object);
    std::map<std::uint32_t, std::vector<mesh::Triangle>> by_body;
    const auto numbers = shells_apart(own, bodies.back()->crack_m());
    for (std::size_t t = 0; t < numbers.size(); ++t)
      by_body[numbers[t]].push_back(own.triangles[t]);
    if (by_body.size() == 1) continue;
    for (auto& [number, shell] : by_body) add(std::move(shell));
  }
  return bodies;
}

bool are_solid(const Bodies& bodies) {
  return !bodies.empty() && std::all_of(bodies.begin(), bodies.end(),
                                        [](const auto& body) { return body->is_solid(); });
}

}  // namespace forcelayer::exact
