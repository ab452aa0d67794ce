#include "pointshell/cost.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <thread>
#include <tuple>
#include <unordered_map>

#include "pointshell/part/copies.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/pieces.h"

namespace forcelayer::pointshell {
namespace {

// Fitted to the parts of tests/support/part_traps.py on a core of 2025. Lengths in covering radii.
constexpr double kBytesOfProgram = 9e6;  // before it reads anything
// Points of wide surface over the planar bound; along sharp and open edges, a cell that they run
// through; along needles, a cell that holds little other surface.
constexpr double kOverBound = 1.15, kPointsPerEdgeCell = 1.1, kPointsPerNeedleCell = 3;
constexpr double kSharpCosine = 0.9;
// A needle is longer than this, and its area is that of so narrow a band.
constexpr double kNeedleLength = 8, kNeedleWidth = 0.5;
// Along open edges losses are proven in small pieces.
constexpr double kSecondsPerOpenRadius = 350e-6;
constexpr double kBytesPerOpenRadius = 1750, kMaxOpenRadiiPerPoint = 3;
constexpr double kSecondsPerPoint = 50e-6, kBytesPerPoint = 300, kBytesPerNeedlePoint = 900;
// Triangles once, and those of copies, which are read and placed, and give normals to the points.
constexpr double kSecondsPerTriangle = 8e-6, kBytesPerTriangle = 450;
constexpr double kSecondsPerCopied = 9e-6, kBytesPerCopied = 175;
// Rays tell the outside of a patch; they start on so many of its triangles at most.
constexpr double kSecondsPerPatchTriangle = 60e-6, kMaxPatchTriangles = 128;
// Triangles that share a cell: the points there are relaxed on some of them, the proof meets all,
// and bounds many as a whole.
constexpr double kFewLines = 4, kSecondsPerWideLine = 55e-6;
constexpr double kNarrow = 0.1, kMaxNarrowLines = 32, kSecondsPerNarrowLine = 20e-6;
// Surface that fills space, as of a bundle: from so many times a cell's own face on, in more than
// so many triangles, its points cover a volume.
constexpr double kFilled = 2.5, kFilledLines = 64, kSecondsPerFilledCell = 20e-3;
constexpr double kSecondsPerProof = 7e-6, kSecondsOfMany = 300e-6, kSecondsPerOfMany = 0.5e-6;

// The triangles that are no copies by pieces of surface, which share no vertex: the sum of those
// that rays start on.
double patch_triangles(const part::Part& part, std::span<const std::uint32_t> originals) {
  std::vector<std::uint32_t> parent(part.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    if (originals[t] != t) continue;
    for (const std::uint32_t corner : part.triangles[t]) {
      parent[root(part.triangles[t][0])] = root(corner);
    }
  }
  std::vector<std::uint32_t> triangles(part.vertices.size());
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    if (originals[t] == t) ++triangles[root(part.triangles[t][0])];
  }
  double sum = 0;
  for (const std::uint32_t n : triangles) sum += std::min<double>(n, kMaxPatchTriangles);
  return sum;
}

// Cells of two radii, and what runs through them.
class Cells {
 public:
  struct Content {
    double wide = 0, narrow = 0, area_m2 = 0;
    bool needles = false;
  };

  // The grid is moved by `shift` cells: a bundle of lines on a face of one grid is inside of cells
  // of another.
  Cells(double radius, double shift) : edge_m_(2 * radius), shift_(shift) {}

  Content& at(const part::Vec3& p) {
    std::uint64_t cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double at = std::floor(part::coordinate(p, axis) / edge_m_ + shift_);
      cell = (cell << 21) ^ (static_cast<std::uint64_t>(std::llround(at)) & 0x1fffff);
    }
    return contents_[cell];
  }

  const std::unordered_map<std::uint64_t, Content>& contents() const { return contents_; }

 private:
  const double edge_m_, shift_;
  std::unordered_map<std::uint64_t, Content> contents_;
};

constexpr double kShifts[] = {0, 0.5};
// More steps than this are not taken: every so many lines stand for all.
constexpr double kMaxSteps = 1 << 19;

double steps_of(double length_m, double radius) {
  return std::min(std::ceil(length_m / (2 * radius)), kMaxRadiusVoxels);
}

// Work and points of triangles that share cells, along their longest edges.
struct Sharing {
  double needle_points = 0, thread_s = 0;
  double spared_m2 = 0;  // of surface in filled cells that takes no points of its own
};

class TriangleLines {
 public:
  explicit TriangleLines(double radius) : radius_(radius) {}

  void add(const part::Piece& piece) {
    const part::LongestEdge edge = part::longest_edge(piece);
    lines_.push_back({piece, edge.from, std::sqrt(edge.length_squared)});
    steps_ += steps_of(lines_.back().length_m, radius_);
  }

  Sharing sharing() const {
    std::array<Sharing, 2> of;
    part::parallel_for_each_index(of.size(), 1,
                                  [&](std::size_t n) { of[n] = in(cells(kShifts[n])); });
    return {std::min(of[0].needle_points, of[1].needle_points),
            std::min(of[0].thread_s, of[1].thread_s), std::min(of[0].spared_m2, of[1].spared_m2)};
  }

 private:
  struct Line {
    part::Piece piece;
    int from;
    double length_m;
  };

  Cells cells(double shift) const {
    Cells cells(radius_, shift);
    const auto stride = static_cast<std::size_t>(std::ceil(std::max(1.0, steps_ / kMaxSteps)));
    const auto weight = static_cast<double>(stride);
    for (std::size_t n = 0; n < lines_.size(); n += stride) {
      const auto& [piece, from, length_m] = lines_[n];
      const part::Vec3 along = piece[(from + 1) % 3] - piece[from];
      const part::Vec3 aside = piece[(from + 2) % 3] - piece[from];
      const double doubled_m2 = part::length(part::cross(along, aside));
      const double foot = part::dot(along, aside) / std::max(length_m * length_m, 1e-300);
      const double steps = std::max(1.0, steps_of(length_m, radius_));
      const double width = doubled_m2 / std::max(2 * length_m * radius_, 1e-300);
      const bool needle = length_m > kNeedleLength * radius_ && width < kNeedleWidth;
      for (double step = 0; step < steps; ++step) {
        const double t = (step + 0.5) / steps;
        const double height = t < foot ? t / foot : (1 - t) / (1 - foot);  // of the triangle there
        Cells::Content& content = cells.at(piece[from] + t * along);
        (width < kNarrow ? content.narrow : content.wide) += weight;
        content.area_m2 += weight * doubled_m2 * std::clamp(height, 0.0, 1.0) / steps;
        content.needles |= needle;
      }
    }
    return cells;
  }

  Sharing in(const Cells& cells) const {
    const double full_m2 = 4 * radius_ * radius_;
    Sharing sum;
    for (const auto& [cell, content] : cells.contents()) {
      if (content.needles) {
        const double full = content.area_m2 / full_m2;
        sum.needle_points += kPointsPerNeedleCell * std::clamp(1 - full, 0.0, 1.0);
      }
      const double lines = content.wide + content.narrow;
      if (lines > kFilledLines && content.area_m2 > kFilled * full_m2) {
        sum.spared_m2 += content.area_m2 - kFilled * full_m2;
        sum.thread_s += kSecondsPerFilledCell;
      }
      sum.thread_s +=
          kSecondsPerWideLine * std::max(0.0, content.wide - kFewLines) +
          kSecondsPerNarrowLine * std::clamp(content.narrow - kFewLines, 0.0, kMaxNarrowLines) +
          std::min(kSecondsPerProof * lines, kSecondsOfMany + kSecondsPerOfMany * lines);
    }
    return sum;
  }

  const double radius_;
  double steps_ = 0;
  std::vector<Line> lines_;
};

// Edges of triangles that are no copies.
struct Edges {
  double open_m = 0;  // the length of those that only one triangle has
  double cells = 0;   // that these and sharp ones run through
};

Edges edges_of(const part::Part& part, std::span<const std::uint32_t> originals, double radius) {
  struct Side {
    std::uint32_t low, high, triangle;
    bool same_edge(const Side& other) const { return low == other.low && high == other.high; }
    bool operator<(const Side& other) const {
      return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle);
    }
  };
  std::vector<Side> sides;
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    if (originals[t] != t) continue;
    for (int n = 0; n < 3; ++n) {
      const auto [low, high] =
          std::minmax<std::uint32_t>(part.triangles[t][n], part.triangles[t][(n + 1) % 3]);
      sides.push_back({low, high, t});
    }
  }
  tbb::parallel_sort(sides.begin(), sides.end());
  Edges edges;
  std::array<Cells, 2> with{Cells(radius, kShifts[0]), Cells(radius, kShifts[1])};
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].same_edge(sides[first])) ++end;
    const part::Vec3 from = part.vertices[sides[first].low];
    const part::Vec3 along = part.vertices[sides[first].high] - from;
    if (end - first == 1) {
      edges.open_m += part::length(along);
    } else {
      const part::Vec3 a = part::doubled_area_normal(part, sides[first].triangle);
      const part::Vec3 b = part::doubled_area_normal(part, sides[first + 1].triangle);
      if (part::dot(a, b) > kSharpCosine * part::length(a) * part::length(b)) continue;
    }
    if (static_cast<double>(with[0].contents().size()) > kMaxSteps) continue;  // enough is known
    const double steps = std::max(1.0, steps_of(part::length(along), radius));
    for (double step = 0; step < steps; ++step) {
      for (Cells& cells : with) cells.at(from + ((step + 0.5) / steps) * along);
    }
  }
  edges.cells = static_cast<double>(std::min(with[0].contents().size(), with[1].contents().size()));
  return edges;
}

}  // namespace

BakeCost expected_cost(const part::Part& part, const ShellOptions& options) {
  const double radius = requested_covering_radius(options);
  std::vector<part::CopiedGroup> groups;
  if (options.method == ShellMethod::kSurface) groups = part::find_copies(part, radius);
  const std::vector<std::uint32_t> originals = part::original_triangles(part, groups);
  double area_m2 = 0, area_once_m2 = 0, once = 0;
  TriangleLines lines(radius);
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    const double own_m2 = part::length(part::doubled_area_normal(part, t)) / 2;
    area_m2 += own_m2;
    if (originals[t] != t) continue;
    area_once_m2 += own_m2, ++once;
    lines.add(part::triangle_piece(part, t));
  }
  const Sharing sharing = lines.sharing();
  const Edges edges = edges_of(part, originals, radius);
  const double copied = static_cast<double>(part.triangles.size()) - once;
  const double of_area =
      kOverBound * planar_bound(std::max(0.0, area_once_m2 - sharing.spared_m2), radius);
  const double along_lines = std::max(sharing.needle_points, kPointsPerEdgeCell * edges.cells);
  const double open_radii =
      std::min(edges.open_m / radius, kMaxOpenRadiiPerPoint * (of_area + along_lines));
  const double points_once = of_area + along_lines;
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const double threads = options.threads == 0 ? cores : std::min(options.threads, cores);
  BakeCost cost;
  cost.points = points_once * (area_once_m2 > 0 ? area_m2 / area_once_m2 : 1);
  cost.thread_s = kSecondsPerPoint * points_once + kSecondsPerOpenRadius * open_radii +
                  kSecondsPerTriangle * once + kSecondsPerCopied * copied +
                  kSecondsPerPatchTriangle * patch_triangles(part, originals) + sharing.thread_s;
  cost.seconds = cost.thread_s / threads;
  cost.bytes = kBytesOfProgram + kBytesPerPoint * cost.points +
               kBytesPerNeedlePoint * sharing.needle_points + kBytesPerOpenRadius * open_radii +
               kBytesPerTriangle * once + kBytesPerCopied * copied;
  return cost;
}

}  // namespace forcelayer::pointshell
