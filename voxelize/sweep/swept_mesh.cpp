#include "voxelize/sweep/swept_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "formats/lattice/voxel_overlap.h"
#include "formats/path/path_edit.h"
#include "formats/path/quaternion.h"
#include "formats/voxmap_format.h"

namespace forcelayer::sweep {
namespace {

using lattice::LatticePoint;
using mesh::Vec3d;

// How far the thinned path may be from the path, and the straight motion of corners between
// sub-poses from the turning motion, in voxels. More poses than these do not make the exported
// surface visibly tighter: its own excess is up to 0.87 voxel.
constexpr double kThinVoxels = 0.005, kStepVoxels = 0.02;
constexpr double kMaxThinVoxels = 0.08;  // of a path that is noisy

// Tetrahedra of one sweep: some minutes.
constexpr double kMaxTetrahedra = 2e10;

// Triangles of a part whose edges are short, some 300 bytes each.
constexpr double kMaxPartTriangles = 1e8;

// Between two rows that are farther apart than this, no row is left out.
constexpr double kWideTurnRad = std::numbers::pi / 2;

Vec3d minus(const Vec3d& a, const Vec3d& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3d cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

Vec3d rotated(const Quaternion& q, const Vec3d& v) {
  const Quaternion r = product(product(q, {0, v[0], v[1], v[2]}), conjugate(q));
  return {r[1], r[2], r[3]};
}

// A mesh whose corners at the same position are one vertex, with its edges.
struct Topology {
  std::vector<Vec3d> vertices;
  // [triangles] ascending vertices; their edges (0, 1), (1, 2), (0, 2)
  std::vector<mesh::Triangle> triangles;
  std::vector<std::array<std::uint32_t, 3>> edges_of;  // [triangles]
  std::vector<std::array<std::uint32_t, 2>> edges;     // ascending vertices
};

Topology topology_of(const mesh::Mesh& mesh) {
  Topology topology;
  std::map<Vec3d, std::uint32_t> number_of;
  std::vector<std::uint32_t> merged;
  merged.reserve(mesh.vertices.size());
  for (const Vec3d& vertex : mesh.vertices) {
    const auto [found, is_new] =
        number_of.emplace(vertex, static_cast<std::uint32_t>(topology.vertices.size()));
    if (is_new) topology.vertices.push_back(vertex);
    merged.push_back(found->second);
  }
  struct Side {
    std::uint32_t low, high, triangle;
    int place;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (const mesh::Triangle& corners : mesh.triangles) {
    mesh::Triangle sorted{merged[corners[0]], merged[corners[1]], merged[corners[2]]};
    std::sort(sorted.begin(), sorted.end());
    if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) continue;  // its edges are of others too
    const auto triangle = static_cast<std::uint32_t>(topology.triangles.size());
    topology.triangles.push_back(sorted);
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t low = sorted[n == 1 ? 1 : 0], high = sorted[n == 0 ? 1 : 2];
      sides.push_back({low, high, triangle, static_cast<int>(n)});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::pair(a.low, a.high) < std::pair(b.low, b.high);
  });
  topology.edges_of.resize(topology.triangles.size());
  for (std::size_t n = 0; n < sides.size();) {
    const Side& first = sides[n];
    for (; n < sides.size() && sides[n].low == first.low && sides[n].high == first.high; ++n) {
      topology.edges_of[sides[n].triangle][static_cast<std::size_t>(sides[n].place)] =
          static_cast<std::uint32_t>(topology.edges.size());
    }
    topology.edges.push_back({first.low, first.high});
  }
  return topology;
}

// The mesh with its triangles halved at their longest edges until no edge is longer than
// `longest_m`. Triangles that share an edge halve it at the same points. Nothing where there would
// be more than kMaxPartTriangles.
std::optional<mesh::Mesh> subdivided(const mesh::Mesh& mesh, double longest_m) {
  if (std::isinf(longest_m)) return mesh;
  // No triangle with such edges has a larger area than the equilateral one.
  double area_m2 = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    area_m2 += length(cross(minus(mesh.vertices[b], mesh.vertices[a]),
                            minus(mesh.vertices[c], mesh.vertices[a]))) /
               2;
  }
  if (area_m2 > kMaxPartTriangles * std::sqrt(3.0) / 4 * longest_m * longest_m) return {};
  mesh::Mesh fine{mesh.vertices, {}, mesh.single_precision};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  std::vector<mesh::Triangle> waiting(mesh.triangles.rbegin(), mesh.triangles.rend());
  while (!waiting.empty()) {
    const mesh::Triangle corners = waiting.back();
    waiting.pop_back();
    std::size_t longest = 0;
    double length_m = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      const double edge_m =
          length(minus(fine.vertices[corners[(n + 1) % 3]], fine.vertices[corners[n]]));
      if (edge_m > length_m) longest = n, length_m = edge_m;
    }
    if (!(length_m > longest_m)) {
      fine.triangles.push_back(corners);
      if (static_cast<double>(fine.triangles.size()) > kMaxPartTriangles) return {};
      continue;
    }
    const std::uint32_t a = corners[longest], b = corners[(longest + 1) % 3],
                        c = corners[(longest + 2) % 3];
    const auto [middle, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.vertices.size()));
    if (is_new) {
      Vec3d at;
      for (std::size_t d = 0; d < 3; ++d) {
        at[d] = (fine.vertices[a][d] + fine.vertices[b][d]) / 2;
      }
      fine.vertices.push_back(at);
    }
    waiting.push_back({a, middle->second, c});
    waiting.push_back({middle->second, b, c});
  }
  return fine;
}

// The sign of the volume of a tetrahedron: 1, -1, or 0 where rounding leaves it open.
int orientation(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
                const LatticePoint& d) {
  const auto from_a = [&](const LatticePoint& p) -> Vec3d {
    return {static_cast<double>(p[0] - a[0]), static_cast<double>(p[1] - a[1]),
            static_cast<double>(p[2] - a[2])};
  };
  const Vec3d u = from_a(b), v = from_a(c), w = from_a(d);
  const double yz = v[1] * w[2], zy = v[2] * w[1], zx = v[2] * w[0], xz = v[0] * w[2],
               xy = v[0] * w[1], yx = v[1] * w[0];
  const double volume = u[0] * (yz - zy) + u[1] * (zx - xz) + u[2] * (xy - yx);
  const double largest = std::abs(u[0]) * (std::abs(yz) + std::abs(zy)) +
                         std::abs(u[1]) * (std::abs(zx) + std::abs(xz)) +
                         std::abs(u[2]) * (std::abs(xy) + std::abs(yx));
  // Less than nine roundings of terms that are no larger.
  const double rounding = 1e-15 * largest;
  return volume > rounding ? 1 : volume < -rounding ? -1 : 0;
}

// The sides of a face on which tetrahedra lie: bit 0 and bit 1. Both: the face is inside.
constexpr unsigned kBothSides = 3;
unsigned side(int orientation) { return orientation > 0 ? 1 : orientation < 0 ? 2 : 0; }

// Builds a swept mesh, pose by pose.
class Sweep {
 public:
  Sweep(const Topology& part, double voxel_size_m)
      : part_(part),
        voxel_size_m_(voxel_size_m),
        below_(part.triangles.size()),
        edge_sides_(part.edges.size()) {}

  // `places` [vertices of the part].
  void add_pose(std::vector<LatticePoint> places) {
    from_ = std::move(to_);
    number_from_ = std::move(number_to_);
    to_ = std::move(places);
    number_to_.assign(to_.size(), kUnknown);
    if (from_.empty()) return;
    std::fill(edge_sides_.begin(), edge_sides_.end(), EdgeSides{});
    for (std::size_t t = 0; t < part_.triangles.size(); ++t) sweep_triangle(t);
    for (std::size_t e = 0; e < part_.edges.size(); ++e) {
      const auto [p, q] = part_.edges[e];
      if (edge_sides_[e].first != kBothSides) keep({p, false}, {q, false}, {q, true});
      if (edge_sides_[e].second != kBothSides) keep({p, false}, {p, true}, {q, true});
    }
    is_first_ = false;
  }

  mesh::Mesh finish() {
    for (const auto& [a, b, c] : part_.triangles) keep({a, true}, {b, true}, {c, true});
    swept_.single_precision = false;
    return std::move(swept_);
  }

  std::size_t triangles() const { return swept_.triangles.size(); }

 private:
  static constexpr std::uint32_t kUnknown = ~std::uint32_t{0};
  struct Corner {
    std::uint32_t vertex;
    bool moved;  // whether it is the vertex in the later pose
  };
  struct EdgeSides {
    unsigned first = 0, second = 0;  // of the triangles (p, q, moved q) and (p, moved p, moved q)
  };

  std::uint32_t number(const Corner& corner) {
    std::uint32_t& known = (corner.moved ? number_to_ : number_from_)[corner.vertex];
    if (known != kUnknown) return known;
    known = static_cast<std::uint32_t>(swept_.vertices.size());
    const LatticePoint& at = (corner.moved ? to_ : from_)[corner.vertex];
    const double unit_m = voxel_size_m_ / static_cast<double>(lattice::kSnapUnits);
    swept_.vertices.push_back({static_cast<double>(at[0]) * unit_m,
                               static_cast<double>(at[1]) * unit_m,
                               static_cast<double>(at[2]) * unit_m});
    return known;
  }

  void keep(const Corner& a, const Corner& b, const Corner& c) {
    swept_.triangles.push_back({number(a), number(b), number(c)});
  }

  // The three tetrahedra between a triangle (a, b, c) and where it moves, (x, y, z): abcz, abyz and
  // axyz. Each face of a prism's side has the same diagonal in both prisms that share it: from the
  // lower vertex to the higher one moved.
  void sweep_triangle(std::size_t t) {
    const auto [na, nb, nc] = part_.triangles[t];
    const LatticePoint &a = from_[na], &b = from_[nb], &c = from_[nc];
    const LatticePoint &x = to_[na], &y = to_[nb], &z = to_[nc];
    const int abcz = orientation(a, b, c, z), abyz = orientation(a, b, y, z),
              axyz = orientation(a, x, y, z);
    // The side of a face is the orientation of its corners, in their order, and the tetrahedron's
    // fourth. An odd permutation of the corners changes the sign.
    const unsigned below = below_[t] | side(abcz);  // abc
    if (is_first_ || below != kBothSides) keep({na, false}, {nb, false}, {nc, false});
    below_[t] = side(-axyz);  // xyz, the abc of the next pose
    const unsigned abz = side(-abcz) | side(-abyz), ayz = side(abyz) | side(axyz);
    if (abz != kBothSides) keep({na, false}, {nb, false}, {nc, true});
    if (ayz != kBothSides) keep({na, false}, {nb, true}, {nc, true});
    const auto& [ab, bc, ac] = part_.edges_of[t];
    edge_sides_[ab].first |= side(abyz);    // aby
    edge_sides_[ab].second |= side(axyz);   // axy
    edge_sides_[bc].first |= side(-abcz);   // bcz
    edge_sides_[bc].second |= side(-abyz);  // byz
    edge_sides_[ac].first |= side(abcz);    // acz
    edge_sides_[ac].second |= side(-axyz);  // axz
  }

  const Topology& part_;
  double voxel_size_m_;
  std::vector<LatticePoint> from_, to_;                 // [vertices] of the last two poses
  std::vector<std::uint32_t> number_from_, number_to_;  // [vertices] in the swept mesh
  std::vector<unsigned> below_;                         // [triangles] the sides before the pose
  std::vector<EdgeSides> edge_sides_;                   // [edges] of the current step
  bool is_first_ = true;
  mesh::Mesh swept_;
};

// The largest distances from the axis through the center about which a step turns.
struct Reach {
  double vertex_m = 0;  // of a vertex
  double edge_m = 0;    // of an edge's end from a parallel through its beginning
};

Reach reach_of(const Topology& part, const Vec3d& center_m, const Vec3d& axis) {
  Reach reach;
  for (const Vec3d& vertex : part.vertices) {
    reach.vertex_m = std::max(reach.vertex_m, length(cross(minus(vertex, center_m), axis)));
  }
  for (const auto& [p, q] : part.edges) {
    const Vec3d edge = minus(part.vertices[q], part.vertices[p]);
    reach.edge_m = std::max(reach.edge_m, length(cross(edge, axis)));
  }
  return reach;
}

// How far the prisms of a step may be from the turning motion. A vertex leaves its chord by at most
// r turn^2 / 8. In a prism the corners of a triangle move by vectors that differ by at most turn
// times its longest edge. The three tetrahedra interpolate them linearly. They are off from the
// triangle whose corners move in straight lines by at most a quarter of this difference.
double deviation_of_step_m(const Reach& reach, double turn_rad) {
  return reach.vertex_m * turn_rad * turn_rad / 8 + reach.edge_m * turn_rad / 4;
}

// The largest turn whose deviation_of_step_m() is `within_m`.
double turn_within_rad(const Reach& reach, double within_m) {
  const double linear = reach.edge_m / 4;
  return 2 * within_m / (linear + std::sqrt(linear * linear + reach.vertex_m * within_m / 2));
}

// Between two rows of a path, the turn and its axis (part frame).
struct Turn {
  double angle_rad = 0;
  Vec3d axis{0, 0, 1};
};
Turn turn_between(const PathRow& from, const PathRow& to) {
  const Quaternion turn = product(conjugate(from.orientation_wxyz), to.orientation_wxyz);
  const Vec3d axis{turn[1], turn[2], turn[3]};
  const double sine = length(axis);
  if (!(sine > 0)) return {};
  return {2 * std::atan2(sine, std::abs(turn[0])),
          {axis[0] / sine, axis[1] / sine, axis[2] / sine}};
}

// The rows of a path at times that grow by how far the part travels, so that a change of speed
// makes no difference. Rows at which the part stands still are left out, but for the first, the
// last, and those before a wide turn.
std::vector<PathRow> timed_by_travel(std::span<const PathRow> rows, const Vec3d& center_m,
                                     double radius_m) {
  std::vector<PathRow> timed;
  double travel_m = 0;
  const auto center = [&](const PathRow& row) {
    const Vec3d arm = rotated(row.orientation_wxyz, center_m);
    return Vec3d{row.position_m[0] + arm[0], row.position_m[1] + arm[1],
                 row.position_m[2] + arm[2]};
  };
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double step_m = 0;
    if (i > 0) {
      step_m = length(minus(center(rows[i]), center(timed.back()))) +
               radius_m * turn_between(timed.back(), rows[i]).angle_rad;
    }
    const double before_m = travel_m;
    travel_m += step_m;
    if (i > 0 && !(travel_m > before_m)) {
      const bool turns_wide =
          i + 1 < rows.size() && turn_between(rows[i], rows[i + 1]).angle_rad > kWideTurnRad;
      if (!turns_wide) continue;
      travel_m = std::nextafter(before_m, std::numeric_limits<double>::infinity());
    }
    timed.push_back(rows[i]);
    timed.back().time_s = travel_m;
  }
  if (timed.size() < 2) {
    timed.push_back(rows.back());
    timed.back().time_s = timed.front().time_s + 1;
  }
  return timed;
}

// The rows that make no difference left out; a pose may be repeated to make two.
struct StepsOfPath {
  std::vector<PathRow> rows;
  std::vector<std::size_t> steps;  // [rows - 1]
  double deviation_m = 0;
};

// The rows without those that thinned() leaves out, but with both rows of each wide turn. Without
// one of these the short way round can be the other way.
std::vector<PathRow> thinned_between_wide_turns(std::span<const PathRow> rows,
                                                const Vec3d& center_m, double radius_m,
                                                double within_m) {
  std::vector<PathRow> kept;
  for (std::size_t first = 0; first < rows.size();) {
    std::size_t end = first + 1;
    while (end < rows.size() && turn_between(rows[end - 1], rows[end]).angle_rad <= kWideTurnRad) {
      ++end;
    }
    const auto own = thinned(rows.subspan(first, end - first), center_m, radius_m, within_m);
    kept.insert(kept.end(), own.begin(), own.end());
    first = end;
  }
  return kept;
}

// Some times the edge that is as long as the farthest point travels in a step whose turn it limits.
// Longer edges make more poses and longer triangles, shorter ones make more triangles: with factors
// of 1, 4 and 10 the cover of sample_data/gearbox.glb takes 14.6, 4.6 and 6.3 s along a random
// path. Paths without turns need no edges to be short.
double longest_edge_m(std::span<const PathRow> rows, double radius_m, double voxel_size_m) {
  double turn_rad = 0;
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    turn_rad += turn_between(rows[i], rows[i + 1]).angle_rad;
  }
  if (!(turn_rad > 1e-9)) return std::numeric_limits<double>::infinity();
  constexpr double kFactor = 4;
  return kFactor * std::max(2 * voxel_size_m, std::sqrt(4 * kStepVoxels * voxel_size_m * radius_m));
}

double radius_about_m(std::span<const Vec3d> vertices, const Vec3d& center_m) {
  double radius_m = 0;
  for (const Vec3d& vertex : vertices) {
    radius_m = std::max(radius_m, length(minus(vertex, center_m)));
  }
  return radius_m;
}

StepsOfPath steps_of(const Topology& part, std::span<const PathRow> rows, const Vec3d& center_m,
                     double voxel_size_m) {
  const double radius_m = radius_about_m(part.vertices, center_m);
  StepsOfPath path;
  const std::vector<PathRow> timed = timed_by_travel(rows, center_m, radius_m);
  // No row is left out whose turn is off by more than half a radian.
  const double max_thin_m = std::min(kMaxThinVoxels * voxel_size_m, radius_m / 2);
  double thin_m = std::min(kThinVoxels * voxel_size_m, max_thin_m);
  path.rows = thinned_between_wide_turns(timed, center_m, radius_m, thin_m);
  // More rows than two in a voxel of travel are the noise of a recording.
  const double enough = 2 + 2 * timed.back().time_s / voxel_size_m;
  while (static_cast<double>(path.rows.size()) > enough && thin_m < max_thin_m) {
    thin_m = std::min(2 * thin_m, max_thin_m);
    path.rows = thinned_between_wide_turns(timed, center_m, radius_m, thin_m);
  }
  double deviation_m = 0;
  for (std::size_t i = 0; i + 1 < path.rows.size(); ++i) {
    const Turn turn = turn_between(path.rows[i], path.rows[i + 1]);
    const Reach reach = reach_of(part, center_m, turn.axis);
    const double largest_rad = turn_within_rad(reach, kStepVoxels * voxel_size_m);
    const double count = std::max(1.0, std::ceil(turn.angle_rad / largest_rad));
    path.steps.push_back(static_cast<std::size_t>(std::min(count, 1e15)));
    deviation_m = std::max(deviation_m, deviation_of_step_m(reach, turn.angle_rad / count));
  }
  // As unit quaternions, the rows of a step that is not wide are at most 45 degrees apart, and the
  // thinned path passes each of them within half a radian / 2. So it takes the step the same way
  // round. Two turns the same way round that are apart by an angle at their ends are apart by at
  // most sqrt(2) times that angle in between, as neither is more than half a turn.
  const double thinned_m = path.rows.size() < timed.size() ? std::sqrt(2.0) * thin_m : 0;
  path.deviation_m = thinned_m + deviation_m;
  return path;
}

// A bound on how far the lattice moves a corner, with the rounding of the pose.
double rounding_m(double largest_m, double voxel_size_m) {
  const double step_m = voxel_size_m / static_cast<double>(lattice::kSnapUnits);
  return std::sqrt(3.0) * (step_m / 2 + 64 * std::numeric_limits<double>::epsilon() * largest_m);
}

}  // namespace

Result<SweptMesh> sweep_mesh(const mesh::Mesh& part, std::span<const PathRow> rows,
                             const Vec3d& center_m, double voxel_size_m, const std::string& name) {
  if (rows.size() < 2) {
    return Error{ErrorCode::kUsage, "", name, "cannot be swept along a path of one pose",
                 "give a path of two or more rows"};
  }
  const double radius_m = radius_about_m(part.vertices, center_m);
  const auto fine = subdivided(part, longest_edge_m(rows, radius_m, voxel_size_m));
  if (!fine) {
    return Error{ErrorCode::kBakeTooLarge, "", name,
                 "is so large that its turns need more than 100 million triangles",
                 "use a larger voxel size"};
  }
  const Topology topology = topology_of(*fine);
  const StepsOfPath path = steps_of(topology, rows, center_m, voxel_size_m);
  double poses = 1;
  for (const std::size_t steps : path.steps) poses += static_cast<double>(steps);
  if (3 * poses * static_cast<double>(topology.triangles.size()) > kMaxTetrahedra) {
    return Error{ErrorCode::kBakeTooLarge, "", name,
                 "turns so far along the path that its swept space takes too long to compute",
                 "use a larger voxel size"};
  }
  const double limit_m = static_cast<double>(kMaxVoxelIndex) * voxel_size_m;
  double largest_m = 0;
  bool inside = true;
  const auto place = [&](const PathRow& pose) {
    std::vector<LatticePoint> places;
    places.reserve(topology.vertices.size());
    for (const Vec3d& vertex : topology.vertices) {
      const Vec3d arm = rotated(pose.orientation_wxyz, vertex);
      Vec3d world;
      for (std::size_t d = 0; d < 3; ++d) {
        world[d] = pose.position_m[d] + arm[d];
        largest_m = std::max({largest_m, std::abs(pose.position_m[d]), std::abs(vertex[d])});
        inside &= std::abs(world[d]) < limit_m;  // false for NaN too
      }
      places.push_back(inside ? lattice::snap(world, voxel_size_m) : LatticePoint{});
    }
    return places;
  };
  Sweep sweep(topology, voxel_size_m);
  sweep.add_pose(place(path.rows.front()));
  for (std::size_t i = 0; i < path.steps.size() && inside; ++i) {
    // Times from 0 to 1, so that late times lose no digits of the fraction.
    PathRow ends[] = {path.rows[i], path.rows[i + 1]};
    ends[0].time_s = 0;
    ends[1].time_s = 1;
    for (std::size_t n = 1; n <= path.steps[i]; ++n) {
      const double fraction = static_cast<double>(n) / static_cast<double>(path.steps[i]);
      sweep.add_pose(place(pose_at(ends, fraction, center_m)));
      constexpr std::size_t kMaxTriangles = 1'000'000'000;
      if (sweep.triangles() > kMaxTriangles) {
        return Error{ErrorCode::kBakeTooLarge, "", name,
                     "has a swept space of more than a billion triangles",
                     "use a larger voxel size"};
      }
    }
  }
  if (!inside) {
    return Error{ErrorCode::kSceneInvalid, "", name,
                 "goes more than 2^52 voxels from the origin along the path",
                 "check units and path, or use a larger voxel size"};
  }
  return SweptMesh{sweep.finish(), path.deviation_m + rounding_m(largest_m, voxel_size_m),
                   static_cast<std::uint64_t>(poses)};
}

}  // namespace forcelayer::sweep
