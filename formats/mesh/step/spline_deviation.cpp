#include "formats/mesh/step/spline_deviation.h"

#include <BRep_Tool.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Poly_Triangulation.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "formats/mesh/step/edge_cover.h"

namespace forcelayer::mesh {
namespace {

constexpr double kFraction = 0.1;  // of the wanted deviation: what bounds are loose by
constexpr std::uint64_t kMaxEvaluations = 5'000'000;  // some seconds
constexpr int kMaxLevels = 16;

// A direction of parameters of a spline: where its polynomials begin and end.
struct Direction {
  std::vector<double> knots;  // with their multiplicities
  int degree = 0;

  // The spans that [low, high] touches, as indices of the knot that they begin at.
  std::pair<int, int> spans(double low, double high) const {
    return {span(low, false), span(high, true)};
  }

 private:
  int span(double at, bool is_end) const {
    const auto first = knots.begin() + degree, last = knots.end() - degree - 1;
    const auto after =
        is_end ? std::lower_bound(first, last, at) : std::upper_bound(first, last, at);
    return static_cast<int>(after - knots.begin()) - 1 + (after == first ? 1 : 0);
  }
};

// The lengths of the largest second derivatives in a span, or of several.
struct Curvature {
  double uu = 0, uv = 0, vv = 0;

  void extend(const Curvature& other) {
    uu = std::max(uu, other.uu);
    uv = std::max(uv, other.uv);
    vv = std::max(vv, other.vv);
  }
};

using Net = std::vector<std::vector<gp_XYZ>>;  // [u][v]

// The control points of the derivative along u of the spline with these ones.
Net derived(const Net& net, const Direction& u, int order) {
  Net result;
  for (std::size_t i = 0; i + 1 < net.size(); ++i) {
    const auto at = i + static_cast<std::size_t>(order);
    const double length =
        u.knots[at + static_cast<std::size_t>(u.degree - order) + 1] - u.knots[at + 1];
    auto& row = result.emplace_back();
    for (std::size_t j = 0; j < net[i].size(); ++j) {
      row.push_back((net[i + 1][j] - net[i][j]) * ((u.degree - order) / length));
    }
  }
  return result;
}

Net turned(const Net& net) {
  Net result(net.empty() ? 0 : net[0].size(), std::vector<gp_XYZ>(net.size()));
  for (std::size_t i = 0; i < net.size(); ++i) {
    for (std::size_t j = 0; j < net[i].size(); ++j) result[j][i] = net[i][j];
  }
  return result;
}

double max_length(const Net& net, int first_u, int count_u, int first_v, int count_v) {
  double square = 0;
  for (int i = std::max(0, first_u); i < first_u + count_u; ++i) {
    for (int j = std::max(0, first_v); j < first_v + count_v; ++j) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      if (a < net.size() && b < net[a].size()) square = std::max(square, net[a][b].SquareModulus());
    }
  }
  return std::sqrt(square);
}

// A polynomial spline whose tangents are continuous, and what its second derivatives are at most: a
// spline lies in the hull of its control points, so a derivative is no longer than the longest of
// its own.
class Spline {
 public:
  static std::optional<Spline> of(const Handle(Geom_Surface) & surface) {
    Handle(Geom_Surface) basis = surface;
    if (const auto trimmed = Handle(Geom_RectangularTrimmedSurface)::DownCast(basis);
        !trimmed.IsNull()) {
      basis = trimmed->BasisSurface();
    }
    const auto given = Handle(Geom_BSplineSurface)::DownCast(basis);
    if (given.IsNull() || given->IsURational() || given->IsVRational() || given->IsUPeriodic() ||
        given->IsVPeriodic()) {
      return {};
    }
    Spline spline;
    spline.u_ = direction(given->UKnotSequence(), given->UDegree());
    spline.v_ = direction(given->VKnotSequence(), given->VDegree());
    if (!is_smooth(spline.u_) || !is_smooth(spline.v_)) return {};
    spline.set_curvatures(given);
    return spline;
  }

  Curvature curvature(const std::array<gp_XY, 3>& corners) const {
    const auto [low_u, high_u] = std::minmax({corners[0].X(), corners[1].X(), corners[2].X()});
    const auto [low_v, high_v] = std::minmax({corners[0].Y(), corners[1].Y(), corners[2].Y()});
    const auto [first_u, last_u] = u_.spans(low_u, high_u);
    const auto [first_v, last_v] = v_.spans(low_v, high_v);
    Curvature all;
    for (int k = first_u; k <= last_u; ++k) {
      for (int l = first_v; l <= last_v; ++l) {
        all.extend(curvatures_[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)]);
      }
    }
    return all;
  }

 private:
  static Direction direction(const TColStd_Array1OfReal& knots, int degree) {
    return {{knots.begin(), knots.end()}, degree};
  }

  // Whether no knot within is as often there as the degree: there the surface may have an edge.
  static bool is_smooth(const Direction& direction) {
    if (direction.degree < 2)
      return direction.knots.size() == 2 * static_cast<std::size_t>(direction.degree + 1);
    const auto degree = static_cast<std::size_t>(direction.degree);
    for (std::size_t i = degree + 1; i + degree < direction.knots.size() - degree; ++i) {
      if (!(direction.knots[i + degree - 1] > direction.knots[i])) return false;
    }
    return true;
  }

  void set_curvatures(const Handle(Geom_BSplineSurface) & given) {
    Net net(static_cast<std::size_t>(given->NbUPoles()));
    for (Standard_Integer i = 1; i <= given->NbUPoles(); ++i) {
      for (Standard_Integer j = 1; j <= given->NbVPoles(); ++j) {
        net[static_cast<std::size_t>(i - 1)].push_back(given->Pole(i, j).XYZ());
      }
    }
    const Net of_u = derived(net, u_, 0), of_v = turned(derived(turned(net), v_, 0));
    const Net uu = u_.degree > 1 ? derived(of_u, u_, 1) : Net{};
    const Net uv = turned(derived(turned(of_u), v_, 0));
    const Net vv = v_.degree > 1 ? turned(derived(turned(of_v), v_, 1)) : Net{};
    const int p = u_.degree, q = v_.degree;
    curvatures_.assign(u_.knots.size(), std::vector<Curvature>(v_.knots.size()));
    for (int k = p; k + p + 1 < static_cast<int>(u_.knots.size()); ++k) {
      for (int l = q; l + q + 1 < static_cast<int>(v_.knots.size()); ++l) {
        curvatures_[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)] = {
            max_length(uu, k - p, p - 1, l - q, q + 1), max_length(uv, k - p, p, l - q, q),
            max_length(vv, k - p, p + 1, l - q, q - 1)};
      }
    }
  }

  Direction u_, v_;
  std::vector<std::vector<Curvature>> curvatures_;  // [knot of u][knot of v]
};

// Splits triangles in the parameters until their surface is known.
class Bound {
 public:
  Bound(const Spline& spline, const Handle(Geom_Surface) & surface, double wanted_mm)
      : spline_(spline), surface_(surface), wanted_mm_(wanted_mm) {}

  // A point of the surface is no farther from `triangle`, which is convex, than the farthest of the
  // corners of its part, and than the part is curved: by Taylor, and as a spread of width w has a
  // variance of at most w^2 / 4, an eighth of the second derivatives.
  void add(const std::array<gp_XY, 3>& corners, const std::array<double, 3>& distances_mm,
           const Corners& triangle, int level = 0) {
    const auto [low_u, high_u] = std::minmax({corners[0].X(), corners[1].X(), corners[2].X()});
    const auto [low_v, high_v] = std::minmax({corners[0].Y(), corners[1].Y(), corners[2].Y()});
    const double u = high_u - low_u, v = high_v - low_v;
    const Curvature largest = spline_.curvature(corners);
    const double curved_mm = (u * u * largest.uu + 2 * u * v * largest.uv + v * v * largest.vv) / 8;
    const double bound_mm = *std::max_element(distances_mm.begin(), distances_mm.end()) + curved_mm;
    if (bound_mm <= std::max(wanted_mm_, worst_mm) || curved_mm <= kFraction * wanted_mm_ ||
        level == kMaxLevels || evaluations > kMaxEvaluations) {
      worst_mm = std::max(worst_mm, bound_mm);
      return;
    }
    // Across the longer side, as the curvature weighs it, so that long parts become short.
    std::size_t longest = 0;
    const auto weight = [&](std::size_t n) {
      const gp_XY side = corners[(n + 1) % 3] - corners[n];
      return side.X() * side.X() * largest.uu + 2 * std::abs(side.X() * side.Y()) * largest.uv +
             side.Y() * side.Y() * largest.vv;
    };
    for (std::size_t n = 1; n < 3; ++n) {
      if (weight(n) > weight(longest)) longest = n;
    }
    const std::size_t next = (longest + 1) % 3, other = (longest + 2) % 3;
    const gp_XY middle = 0.5 * (corners[longest] + corners[next]);
    const double middle_mm = distance(middle, triangle);
    add({corners[longest], middle, corners[other]},
        {distances_mm[longest], middle_mm, distances_mm[other]}, triangle, level + 1);
    add({middle, corners[next], corners[other]},
        {middle_mm, distances_mm[next], distances_mm[other]}, triangle, level + 1);
  }

  double distance(const gp_XY& at, const Corners& triangle) {
    ++evaluations;
    return distance_to_triangle(surface_.Value(at.X(), at.Y()).XYZ(), triangle);
  }

  double worst_mm = 0;
  std::uint64_t evaluations = 0;

 private:
  const Spline& spline_;
  GeomAdaptor_Surface surface_;
  double wanted_mm_;
};

}  // namespace

std::optional<double> spline_deviation_mm(const TopoDS_Face& face, double wanted_mm) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) made = BRep_Tool::Triangulation(face, location);
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
  if (made.IsNull() || !made->HasUVNodes() || surface.IsNull()) return {};
  const std::optional<Spline> spline = Spline::of(surface);
  if (!spline) return {};
  Bound bound(*spline, surface, wanted_mm);
  for (Standard_Integer i = 1; i <= made->NbTriangles(); ++i) {
    std::array<gp_XY, 3> corners;
    std::array<double, 3> distances_mm{};
    Corners triangle;
    for (std::size_t n = 0; n < 3; ++n) {
      const Standard_Integer node = made->Triangle(i).Value(static_cast<int>(n) + 1);
      corners[n] = made->UVNode(node).XY();
      triangle[n] = made->Node(node).XYZ();
    }
    for (std::size_t n = 0; n < 3; ++n) distances_mm[n] = bound.distance(corners[n], triangle);
    bound.add(corners, distances_mm, triangle);
    if (bound.evaluations > kMaxEvaluations) return {};
  }
  return bound.worst_mm;
}

}  // namespace forcelayer::mesh
