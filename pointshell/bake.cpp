#include "pointshell/bake.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <optional>

#include "pointshell/certificate/certificate.h"
#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/certificate/surface_losses.h"
#include "pointshell/normals/normals.h"
#include "pointshell/part/mass_properties.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/triangle_tree.h"
#include "pointshell/portions.h"
#include "pointshell/sample/hole_filling.h"
#include "pointshell/sample/order.h"
#include "pointshell/sample/voxel_centers.h"
#include "pointshell/sample/weights.h"

namespace forcelayer::pointshell {
namespace {

// The stages of a bake and about which fraction of its processor time each takes: at full effort,
// at fast effort, with voxel centers; and of a part of few triangles, on whose flat faces points
// are spread soon and the proof takes longest.
struct StageFraction {
  const char* stage;
  double full, fast, centers;
  double few_full, few_fast, few_centers;
};
constexpr StageFraction kStageFractions[] = {{"orientation", 0.02, 0.03, 0.03, 0.01, 0.01, 0.01},
                                             {"points", 0.66, 0.35, 0.2, 0.36, 0.21, 0.16},
                                             {"hidden", 0, 0, 0.02, 0, 0, 0},
                                             {"corners", 0.115, 0.195, 0, 0.11, 0.16, 0},
                                             {"order", 0, 0, 0.015, 0, 0, 0.02},
                                             {"losses", 0.16, 0.315, 0.435, 0.49, 0.57, 0.65},
                                             {"normals", 0.035, 0.085, 0.255, 0.02, 0.035, 0.13},
                                             {"weights", 0.01, 0.025, 0.045, 0.01, 0.015, 0.03}};

// 1 where there are no triangles to speak of beside the points, 0 where there are many.
double fewness(const part::Part& part, double radius) {
  constexpr double kHalf = 1 / 15.0;  // triangles a point
  const double points = planar_bound(part::area(part), radius);
  return 1 / (1 + static_cast<double>(part.triangles.size()) / (kHalf * points));
}

double fraction_of(const StageFraction& stage, const ShellOptions& options, double few) {
  const auto mean = [few](double usual, double of_few) { return usual + few * (of_few - usual); };
  if (options.method == ShellMethod::kVoxelCenters) return mean(stage.centers, stage.few_centers);
  if (options.effort == sample::Effort::kFast) return mean(stage.fast, stage.few_fast);
  return mean(stage.full, stage.few_full);
}

class Stages {
 public:
  Stages(const ShellOptions& options, double few, double expected_s, BakedShell& shell,
         const BakeProgress& progress)
      : options_(options), few_(few), expected_s_(expected_s), shell_(shell), progress_(progress) {}

  void begin(const std::string& name) {
    end();
    name_ = name;
    started_ = std::chrono::steady_clock::now();
    before_ = 0;
    for (const StageFraction& stage : kStageFractions) {
      fraction_ = fraction_of(stage, options_, few_);
      if (name == stage.stage) break;
      before_ += fraction_;
    }
    show(0);
  }

  // `fraction_done`: of the stage.
  void show(double fraction_done) const {
    progress_(name_, 1 - rest_ * (1 - before_ - fraction_ * fraction_done));
  }

  void end() {
    if (name_.empty()) return;
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - started_;
    if (shell_.stage_seconds.empty() || shell_.stage_seconds.back().first != name_) {
      shell_.stage_seconds.push_back({name_, 0});
    }
    shell_.stage_seconds.back().second += spent.count();
    if (name_ == kStageFractions[0].stage && expected_s_ > 0) {
      const double fraction = std::max(fraction_, spent.count() / (spent.count() + expected_s_));
      rest_ = (1 - fraction) / (1 - fraction_);
    }
    name_.clear();
  }

 private:
  const ShellOptions& options_;
  const double few_;
  const double expected_s_;
  BakedShell& shell_;
  const BakeProgress& progress_;
  std::string name_;
  double before_ = 0, fraction_ = 0;  // of the bake: what is done, and the stage's own
  // The rays that find the outside of thousands of bodies take more than the usual fraction: what
  // comes after them is made smaller by this.
  double rest_ = 1;
  std::chrono::steady_clock::time_point started_;
};

// The most points that a method needs, as a multiple of the planar bound.
constexpr double kMaxOfBound = 3;
constexpr double kBytesPerPoint = 400;
// The fraction of the covering radius that rounding may take in a proof. Points stand so much
// denser; from 1 on none would do.
constexpr double kMaxMargin = 0.25;

// In covering radii: pieces of surface that another body's surface crosses are weighed by it.
constexpr double kWeighedPiece = 0.5;

double physical_memory_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
}

// Refuses a bake that would run for hours and then out of memory, or make what no file holds.
Status check_size(const part::Part& part, const part::MassProperties& mass, double radius,
                  double voxel_size_m) {
  if (!(certificate::proof_margin(part, radius) <= kMaxMargin * radius)) {
    char what[160];
    std::snprintf(what, sizeof what,
                  "the part is up to %.3g m from its frame's origin: double precision is too "
                  "coarse for points with this covering radius",
                  part.largest_coordinate);
    return Error{ErrorCode::kBakeTooLarge, "", "", what,
                 "move the mesh nearer to this origin, and check --units"};
  }
  const auto farthest = std::max_element(
      part.vertices.begin(), part.vertices.end(), [&](const part::Vec3& a, const part::Vec3& b) {
        return part::length_squared(a - mass.centroid) < part::length_squared(b - mass.centroid);
      });
  const double reach_m = part::length(*farthest - mass.centroid);
  if (reach_m > kMaxRadiusVoxels * voxel_size_m) {
    char what[200];
    std::snprintf(what, sizeof what,
                  "the vertex at (%.6g, %.6g, %.6g) m is %.3g m from the centroid, more than a "
                  "million voxels",
                  farthest->x, farthest->y, farthest->z, reach_m);
    return Error{ErrorCode::kBakeTooLarge, "", "", what,
                 "look for a stray vertex in the mesh, and check --units"};
  }
  const double expected = planar_bound(mass.area_m2, radius), largest = kMaxOfBound * expected;
  if (largest < static_cast<double>(kMaxShellPoints) &&
      largest * kBytesPerPoint < physical_memory_bytes()) {
    return {};
  }
  char what[160];
  std::snprintf(what, sizeof what,
                "the shell would need about %.2g points, which is too many for this machine's "
                "memory or the file format",
                expected);
  return Error{ErrorCode::kBakeTooLarge, "", "", what,
               "use a larger voxel size or covering radius, and check --units"};
}

// Voxel centers reach sqrt(3)/2 voxel; their rounding to floats is added to that.
double rounded_center_radius(double voxel_size_m, const part::Part& centered) {
  double extent = voxel_size_m;
  for (const part::Vec3& v : centered.vertices)
    extent = std::max(extent, part::max_abs(v) + voxel_size_m);
  return std::sqrt(0.75) * (voxel_size_m + extent * 0x1p-22) * (1 + 1e-6);
}

// Adds the centers of the voxels that hold the holes; false where all are there already.
bool add_voxel_centers_at(const std::vector<certificate::Hole>& holes, const part::Vec3& center,
                          double voxel_size_m, std::vector<part::Vec3>& points) {
  std::vector<part::Vec3> wanted, added;
  for (const certificate::Hole& hole : holes) {
    wanted.push_back(sample::voxel_center_at(hole.position, voxel_size_m, center));
  }
  std::sort(wanted.begin(), wanted.end(), part::lexicographic_less);
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::sort(points.begin(), points.end(), part::lexicographic_less);
  std::set_difference(wanted.begin(), wanted.end(), points.begin(), points.end(),
                      std::back_inserter(added), part::lexicographic_less);
  points.insert(points.end(), added.begin(), added.end());
  return !added.empty();
}

// The centers of the voxels that the snapped mesh touches, and of the few more that only the mesh
// before snapping touches.
Result<certificate::CoveringProof> cover_by_voxel_centers(const part::Part& part,
                                                          const part::Part& centered,
                                                          const part::Vec3& center,
                                                          double voxel_size_m, double radius,
                                                          std::vector<part::Vec3>& points) {
  auto centers = sample::voxel_centers(part, voxel_size_m, center);
  if (!centers) return centers.error();
  points = std::move(*centers);
  certificate::CoveringProof proof = certificate::prove_covering(centered, points, radius);
  while (!proof.proven) {
    if (!add_voxel_centers_at(proof.holes, center, voxel_size_m, points)) {
      return Error{ErrorCode::kInternal, "", "", "voxel centers do not cover the part", ""};
    }
    proof = certificate::continue_proof(centered, points, radius, proof);
  }
  return proof;
}

double norm_rounded_up(std::span<const part::Vec3> points) {
  double squared = 0;
  for (const part::Vec3& p : points) squared = std::max(squared, part::length_squared(p));
  return std::sqrt(squared) * (1 + 0x1p-40);
}

void fill_points(std::span<const part::Vec3> points, const normals::ShellNormals& normals,
                 std::span<const double> weights, BakedShell& shell) {
  for (std::size_t n = 0; n < points.size(); ++n) {
    shell.x.push_back(static_cast<float>(points[n].x));
    shell.y.push_back(static_cast<float>(points[n].y));
    shell.z.push_back(static_cast<float>(points[n].z));
    shell.nx.push_back(static_cast<float>(normals.inward[n].x));
    shell.ny.push_back(static_cast<float>(normals.inward[n].y));
    shell.nz.push_back(static_cast<float>(normals.inward[n].z));
    shell.weight_m2.push_back(static_cast<float>(weights[n]));
    shell.cone_cos.push_back(static_cast<float>(normals.cone_cos[n]));
  }
  if (std::find(normals.two_sided.begin(), normals.two_sided.end(), 1) != normals.two_sided.end()) {
    shell.two_sided = normals.two_sided;
  }
}

void fill_blocks(std::span<const part::Vec3> points, BakedShell& shell) {
  shell.blocks = sample::bounding_spheres(points, kDefaultBlockPoints);
  shell.super_blocks =
      sample::bounding_spheres(points, std::size_t{kDefaultBlockPoints} * kDefaultSuperBlockBlocks);
  double sum = 0;
  for (const BoundingSphere& block : shell.blocks) sum += block.radius;
  shell.mean_block_radius_m = sum / static_cast<double>(shell.blocks.size());
}

void fill_header(const ShellOptions& options, const part::MassProperties& mass,
                 std::span<const part::Vec3> points, double radius, const part::Part& part,
                 BakedShell& shell) {
  PshellHeader& header = shell.header;
  header.point_count = points.size();
  header.block_points = kDefaultBlockPoints;
  header.super_block_blocks = kDefaultSuperBlockBlocks;
  header.block_count = shell.blocks.size();
  header.super_block_count = shell.super_blocks.size();
  header.covering_radius_m = radius;
  header.voxel_size_m = options.voxel_size_m;
  header.bounding_radius_m = norm_rounded_up(points);
  header.part_deviation_m = options.mesh_deviation_m + part.deviation_m;
  header.center_m = {mass.centroid.x, mass.centroid.y, mass.centroid.z};
  header.area_m2 = mass.area_m2;
  header.volume_m3 = mass.volume_m3;
  header.inertia_m2 = mass.inertia_m2;
  header.mass_source = static_cast<std::uint32_t>(mass.source);
  header.method = static_cast<std::uint32_t>(options.method);
  header.triangles = part.input_triangles;
}

std::vector<part::Vec3> in_block_order(std::span<const part::Vec3> points) {
  std::vector<part::Vec3> ordered;
  ordered.reserve(points.size());
  for (const std::uint32_t n :
       sample::block_order(points, kDefaultBlockPoints, kDefaultSuperBlockBlocks)) {
    ordered.push_back(points[n]);
  }
  return ordered;
}

// Calls work(portion, progress) for each of them. How far the stage is goes by their areas.
template <typename Work>
void for_each_portion(std::span<Portion> portions, const Stages& stages, const Work& work) {
  double all_m2 = 0, before_m2 = 0;
  for (const Portion& portion : portions) all_m2 += part::area(*portion.part);
  for (Portion& portion : portions) {
    const double own_m2 = part::area(*portion.part);
    work(portion,
         [&](double fraction_done) { stages.show((before_m2 + own_m2 * fraction_done) / all_m2); });
    before_m2 += own_m2;
  }
}

// Points that cover each portion by itself.
void cover(std::span<Portion> portions, sample::Effort effort, const Stages& stages) {
  for_each_portion(portions, stages, [&](Portion& portion, const part::Progress& progress) {
    sample::CoveringPoints covering =
        sample::covering_points(*portion.tree, portion.radius, effort, progress);
    portion.points = std::move(covering.positions);
    portion.proof = std::move(covering.proof);
  });
}

void leave_out_hidden_points(std::span<Portion> portions, Stages& stages, BakedShell& shell) {
  for (Portion& portion : portions) {
    portion.hidden = std::make_unique<certificate::HiddenSurface>(*portion.part, portion.slack);
    if (portion.hidden->possible()) {
      stages.begin("hidden");
      shell.hidden_points += portion.times() * certificate::leave_out_hidden_points(
                                                   *portion.part, *portion.hidden, portion.radius,
                                                   portion.points, portion.proof);
    }
    shell.certificate_pieces += portion.proof.pieces;
  }
}

certificate::CoveredPart covered_by(const Portion& portion, double radius, double voxel_size_m) {
  return {*portion.part, portion.points, radius, voxel_size_m, portion.hidden.get(), portion.slack};
}

Result<BakedShell> bake(part::Part part, const ShellOptions& options, const BakeProgress& progress,
                        double expected_s) {
  BakedShell shell;
  const bool on_lattice = options.method == ShellMethod::kVoxelCenters;
  double radius = requested_covering_radius(options);
  Stages stages(options, fewness(part, radius), expected_s, shell, progress);

  stages.begin("orientation");
  std::vector<part::CopiedGroup> groups;  // voxel centers of a copy are no copies
  if (!on_lattice) groups = part::find_copies(part, radius);
  shell.orientation = normals::orient_outwards(part, radius, groups);
  const part::MassProperties mass = part::mass_properties(part, shell.orientation.loose);
  shell.loose_triangles = mass.loose_triangles;
  if (const Status fits = check_size(part, mass, radius, options.voxel_size_m); !fits)
    return fits.error();
  const part::Part centered = part::relative_to(part, mass.centroid);

  stages.begin("points");
  const part::TriangleTree tree(centered);
  if (on_lattice) radius = rounded_center_radius(options.voxel_size_m, centered);
  std::vector<Portion> portions = portions_of(tree, radius, mass.centroid, groups);
  if (on_lattice) {
    auto covered = cover_by_voxel_centers(part, centered, mass.centroid, options.voxel_size_m,
                                          radius, portions.front().points);
    if (!covered) return covered.error();
    portions.front().proof = std::move(*covered);
  } else {
    cover(portions, options.effort, stages);
  }
  leave_out_hidden_points(portions, stages, shell);
  if (!on_lattice) {
    stages.begin("corners");
    for_each_portion(portions, stages, [&](Portion& portion, const part::Progress& done) {
      const auto covered = covered_by(portion, radius, options.voxel_size_m);
      shell.corner_points +=
          portion.times() * sample::fill_lossy_places(covered, portion.points, done);
    });
  }

  stages.begin("order");
  for (Portion& portion : portions) portion.points = in_block_order(portion.points);
  const std::vector<part::Vec3> ordered =
      groups.empty() ? portions.front().points : in_block_order(all_points(portions));
  fill_blocks(ordered, shell);

  stages.begin("losses");
  certificate::SurfaceLosses losses;
  for_each_portion(portions, stages, [&](const Portion& portion, const part::Progress& done) {
    unite(losses,
          certificate::find_losses(covered_by(portion, radius, options.voxel_size_m), done));
  });
  shell.loss_pieces = losses.pieces;
  shell.losses = std::move(losses.losses);

  stages.begin("normals");
  sample::RestrictedCells cells(tree, radius);
  cells.find_lists(ordered);
  const normals::ShellNormals normals =
      normals::shell_normals(cells, ordered, radius, shell.orientation.of_sheet);
  stages.begin("weights");
  // Portions know only what hides within themselves.
  std::optional<certificate::HiddenSurface> of_all;
  if (!groups.empty()) of_all.emplace(centered);
  const std::vector<double> weights = sample::area_weights(
      cells, ordered, of_all ? *of_all : *portions.front().hidden, kWeighedPiece * radius);
  shell.covered_area_m2 = std::accumulate(weights.begin(), weights.end(), 0.0);
  fill_points(ordered, normals, weights, shell);
  if (std::all_of(shell.weight_m2.begin(), shell.weight_m2.end(), [](float w) { return w == 0; })) {
    return Error{ErrorCode::kMeshEmpty, "", "", "the part's area is too small for single precision",
                 "check --units"};
  }
  fill_header(options, mass, ordered, radius, part, shell);
  shell.header.convex_radius_m = losses.convex_radius;
  shell.header.convex_gap_m = losses.convex_gap;
  stages.end();
  return shell;
}

}  // namespace

double planar_bound(double area_m2, double radius_m) {
  return 2 / (3 * std::sqrt(3.0)) * area_m2 / (radius_m * radius_m);
}

double requested_covering_radius(const ShellOptions& options) {
  return options.covering_radius_m > 0 ? options.covering_radius_m
                                       : std::sqrt(0.75) * options.voxel_size_m;
}

Result<BakedShell> bake_shell(part::Part part, const ShellOptions& options,
                              const BakeProgress& progress, double expected_s) {
  std::optional<Result<BakedShell>> shell;
  part::with_threads(options.threads,
                     [&] { shell = bake(std::move(part), options, progress, expected_s); });
  return std::move(*shell);
}

SurfaceDistanceTerms BakedShell::surface_distance_terms() const {
  return {header.covering_radius_m, header.convex_radius_m, header.convex_gap_m, losses};
}

PshellContent BakedShell::content() const {
  PshellContent content;
  content.header = header;
  content.x = x, content.y = y, content.z = z;
  content.nx = nx, content.ny = ny, content.nz = nz;
  content.weight_m2 = weight_m2;
  content.cone_cos = cone_cos;
  content.blocks = blocks;
  content.super_blocks = super_blocks;
  content.losses = losses;
  content.two_sided = two_sided;
  return content;
}

}  // namespace forcelayer::pointshell
