#include "tests/bench/wrench_bench_pairs.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <stdexcept>

#include "formats/mesh/scene.h"
#include "tests/bench/bench_mesh.h"
#include "tests/bench/wrench_bench_scene.h"
#include "tests/stress/baked.h"
#include "tests/stress/shapes.h"
#include "tests/support/curve_order.h"
#include "tests/support/places.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::bench {
namespace {

using test::VoxelKind;

constexpr int kLayers = 2;
constexpr double kFineVoxels = 0.5;  // edge of the pieces of the exact surface
constexpr std::size_t kBlockPoints = 64;
constexpr double kFitThicknesses = 1;           // offsets that are tried, each side
constexpr double kTouchM = 1e-7;                // of the approach
constexpr double kSceneM = 0.6, kPartM = 0.15;  // longest sides of models
constexpr double kCellsPerVoxel = 3;  // of the grid from which the offset surface is drawn
constexpr double kKeptVoxels = 10;    // of a cropped map, around what comes near
constexpr VoxelKind kKinds[] = {VoxelKind::kChebyshev, VoxelKind::kLean, VoxelKind::kFull};

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

glm::dvec3 glm_of(const mesh::Vec3d& v) { return {v[0], v[1], v[2]}; }
glm::dvec3 glm_of(const part::Vec3& v) { return {v.x, v.y, v.z}; }
part::Vec3 vec3_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

glm::dvec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return glm::normalize(glm::dvec3(x, y, z));
}

glm::dquat random_turn(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
  return glm::normalize(glm::dquat(w, x, y, z));
}

// Scaled so that its longest side is this, m.
mesh::Mesh of_size(mesh::Mesh mesh, double longest_m) {
  const double scale = longest_m / longest_side(mesh);
  for (mesh::Vec3d& v : mesh.vertices) {
    for (double& x : v) x *= scale;
  }
  return mesh;
}

// Cuts a triangle at its longest side until no side is longer.
void cut(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double longest_m,
         std::vector<glm::dvec3>& middles, std::vector<double>& areas) {
  const double ab = glm::distance(a, b), bc = glm::distance(b, c), ca = glm::distance(c, a);
  if (std::max({ab, bc, ca}) <= longest_m) {
    middles.push_back((a + b + c) / 3.0);
    areas.push_back(glm::length(glm::cross(b - a, c - a)) / 2);
  } else if (ab >= bc && ab >= ca) {
    const glm::dvec3 m = (a + b) / 2.0;
    cut(a, m, c, longest_m, middles, areas), cut(m, b, c, longest_m, middles, areas);
  } else {
    cut(b, c, a, longest_m, middles, areas);
  }
}

}  // namespace

MeshPair mesh_pair(const std::string& name, const std::string& models) {
  const auto read = [](const std::string& path, std::optional<double> unit_m) {
    if (!std::filesystem::exists(path)) {
      throw std::runtime_error("no file " + path +
                               " (--models FOLDER, or --contact for the pairs that are there)");
    }
    return merged(value_of(mesh::read_scene(std::span(&path, 1), unit_m)));
  };
  const std::string sample = test::source_path("sample_data/"), shared = models + "/";
  if (name == "pump on bay") {
    return {name, read(sample + "bay.json", std::nullopt), read(sample + "part.obj", 1e-3)};
  }
  const auto pair = [&](const std::string& scene, std::optional<double> unit_m,
                        const std::string& part) -> MeshPair {
    return {name, of_size(read(scene, unit_m), kSceneM), of_size(read(shared + part, 1.0), kPartM)};
  };
  if (name == "bracket on gearbox") {
    return pair(sample + "gearbox.glb", std::nullopt, "cad/featuretype.stl");
  }
  if (name == "teapot on dragon") {
    return pair(shared + "scan/dragon-100k.obj", 1.0, "scan/teapot.obj");
  }
  if (name == "bunny on engine") {
    return pair(shared + "cad/2CylinderEngine.glb", std::nullopt, "scan/stanford-bunny.obj");
  }
  if (name == "module on counter") {
    return pair(shared + "cad/counter.unitsmm.stl", 1e-3, "cad/ADIS16480.stl");
  }
  throw std::runtime_error("no pair of meshes is named " + name);
}

PairPart::PairPart(const MeshPair& pair, double voxel_size_m, double covering_radius_m)
    : mesh(pair.part), shell(stress::BakedPart(pair.part, voxel_size_m, covering_radius_m).open()) {
  const PshellView view = shell.view();
  const auto& center = shell.header().center_m;
  for (mesh::Vec3d& v : mesh.vertices) {
    for (std::size_t d = 0; d < 3; ++d) v[d] -= center[d];
  }
  const double mean = shell.header().area_m2 / static_cast<double>(view.point_count);
  for (std::uint64_t i = 0; i < view.point_count; ++i) {
    tested.points_m.push_back({view.x[i], view.y[i], view.z[i]});
    tested.normals.push_back({view.nx[i], view.ny[i], view.nz[i]});
    tested.areas_m2.push_back(double{view.weight_m2[i]} / mean);
  }
  tested.covering_radius_m = shell.header().covering_radius_m;
  tested.radius_m = shell.header().bounding_radius_m;
  tested.area_m2 = shell.header().area_m2;
  std::vector<glm::dvec3> middles;
  std::vector<double> areas;
  for (const mesh::Triangle& t : mesh.triangles) {
    cut(glm_of(mesh.vertices[t[0]]), glm_of(mesh.vertices[t[1]]), glm_of(mesh.vertices[t[2]]),
        kFineVoxels * voxel_size_m, middles, areas);
  }
  for (const std::uint32_t i : test::curve_order(middles, tested.radius_m)) {
    fine_m.push_back(middles[i]);
    fine_area.push_back(areas[i] / mean);
  }
  for (std::size_t first = 0; first < fine_m.size(); first += kBlockPoints) {
    Block block{first, std::min(kBlockPoints, fine_m.size() - first), glm::dvec3(0), 0};
    for (std::size_t i = first; i < first + block.count; ++i) {
      block.center_m += fine_m[i] / static_cast<double>(block.count);
    }
    for (std::size_t i = first; i < first + block.count; ++i) {
      block.radius_m = std::max(block.radius_m, glm::distance(fine_m[i], block.center_m));
    }
    blocks.push_back(block);
  }
}

PairContact::PairContact(const mesh::Mesh& scene, const ExactDistance& distance,
                         const PairPart& part, double voxel_size_m, std::mt19937_64& random)
    : scene_(scene),
      distance_(distance),
      part_(part),
      s_(voxel_size_m),
      reach_m_(2 * longest_side(scene) + part.tested.radius_m) {
  const glm::dquat world_from_scene_turn = random_turn(random);
  std::uniform_real_distribution<double> fraction(0, 1);
  for (std::size_t i = 0; i < kShifts; ++i) {
    const double x = fraction(random), y = fraction(random), z = fraction(random);
    world_from_scene_.push_back({glm::dvec3(x, y, z) * s_, world_from_scene_turn});
  }
  for (int tries = 0; !approach(random); ++tries) {
    if (tries > 100) throw std::runtime_error("the part does not meet the scene");
  }
  keep_near_points();
  tabulate_truth();
}

Pose PairContact::at_height(double height_m) const { return {aim_m_ + height_m * line_, turn_}; }

glm::dvec3 PairContact::placed(const glm::dvec3& on_part_m, double height_m) const {
  return turn_ * on_part_m + aim_m_ + height_m * line_;
}

// Comes down from `height_m` until the least distance of the part is `distance_m`: steps by what is
// surely free. The height, or minus infinity where it passes by or begins too near.
double PairContact::advanced_to(double height_m, double distance_m) {
  for (;;) {
    double smallest = 1e300;
    // The least that a distance can be now, measured anew where that is below `smallest`, and then
    // not much farther than matters.
    const auto at_least = [&](Measured& last, const glm::dvec3& on_part_m, double radius_m) {
      const auto now = [&] {
        return last.distance_m - std::abs(last.height_m - height_m) - radius_m;
      };
      if (now() >= smallest) return now();
      const double within_m = 3 * smallest + radius_m;  // of use for a while
      const auto foot = distance_.foot(placed(on_part_m, height_m), within_m);
      last = {std::min(foot.distance_m, within_m), height_m};
      return now();
    };
    for (std::size_t b = 0; b < part_.blocks.size(); ++b) {
      const PairPart::Block& block = part_.blocks[b];
      if (at_least(block_at_[b], block.center_m, block.radius_m) >= smallest) continue;
      for (std::size_t i = block.first; i < block.first + block.count; ++i) {
        const double distance = at_least(point_at_[i], part_.fine_m[i], 0);
        if (distance < smallest) smallest = distance, nearest_ = i;
      }
    }
    if (smallest < distance_m - kTouchM) return -INFINITY;  // it was nearer before it began
    if (smallest <= distance_m + kTouchM) return height_m;
    height_m -= smallest - distance_m;
    if (height_m < -reach_m_) return -INFINITY;
  }
}

bool PairContact::approach(std::mt19937_64& random) {
  std::uniform_int_distribution<std::size_t> some(0, distance_.soup().triangles.size() - 1);
  const mesh::Triangle& t = distance_.soup().triangles[some(random)];
  aim_m_ = glm_of(distance_.soup().vertices[t[0]]);
  line_ = random_direction(random);
  turn_ = random_turn(random);
  block_at_.assign(part_.blocks.size(), {-1e300, 0});
  point_at_.assign(part_.fine_m.size(), {-1e300, 0});
  double height = reach_m_;
  for (double gap_m = reach_m_; gap_m > 4 * s_; height -= gap_m - 3 * s_) {  // by its sphere alone
    if (height < -reach_m_) return false;
    gap_m = distance_.foot(placed(glm::dvec3(0), height)).distance_m - part_.tested.radius_m;
  }
  height = advanced_to(height, 2.5 * s_);
  if (!std::isfinite(height)) return false;
  const glm::dvec3 normal = world_from_scene_[0].orientation *
                            distance_.foot(placed(part_.fine_m[nearest_], height)).direction;
  thickness_m_ = norm1(normal) * s_;
  std::vector<std::pair<double, std::size_t>> distances;  // and the kind's number
  for (std::size_t k = 0; k < layers_.size(); ++k) {
    layers_[k] = {};
    layers_[k].offset_m = zero_force_voxels(kKinds[k], kLayers, normal) * s_;
    for (std::size_t d = 0; d < kDepths; ++d) {
      const double depth = (0.5 - (static_cast<double>(d) + 0.5) / kDepths) * thickness_m_;
      layers_[k].depths_m.push_back(depth);
      distances.emplace_back(layers_[k].offset_m - depth, k);
    }
  }
  height += 4 * s_;  // above the outermost, on a line that was free
  std::sort(distances.rbegin(), distances.rend());
  for (const auto& [distance_m, k] : distances) {
    height = advanced_to(height, distance_m);
    if (!std::isfinite(height)) return false;
    layers_[k].heights_m.insert(layers_[k].heights_m.begin(), height);
  }
  return true;
}

void PairContact::keep_near_points() {
  double lowest = 1e300, highest = -1e300, farthest = 0;
  for (const Layer& layer : layers_) {
    lowest = std::min(lowest, layer.heights_m.front());
    highest = std::max(highest, layer.heights_m.back());
    farthest = std::max(farthest, layer.offset_m + kFitThicknesses * thickness_m_);
  }
  const double reach_m = farthest + (highest - lowest) / 2, middle = (lowest + highest) / 2;
  const auto is_near = [&](const glm::dvec3& on_part_m, double radius_m) {
    const double within_m = reach_m + radius_m;
    return std::isfinite(distance_.foot(placed(on_part_m, middle), within_m).distance_m);
  };
  for (const PairPart::Block& block : part_.blocks) {
    if (!is_near(block.center_m, block.radius_m)) continue;
    for (std::size_t i = block.first; i < block.first + block.count; ++i) {
      if (is_near(part_.fine_m[i], 0)) near_.push_back(i);
    }
  }
}

void PairContact::tabulate_truth() {
  // A distance changes by no more than the part goes, so one pose bounds the search at the next.
  std::vector<Measured> last(near_.size(), {1e300, 0});
  for (Layer& layer : layers_) {
    const double first_m = layer.offset_m - kFitThicknesses * thickness_m_;
    const double last_m = layer.offset_m + kFitThicknesses * thickness_m_;
    for (const double height : layer.heights_m) {
      std::vector<SurfaceSample> samples;
      for (std::size_t n = 0; n < near_.size(); ++n) {
        const std::size_t i = near_[n];
        const double max_m = last[n].distance_m + std::abs(last[n].height_m - height) + kTouchM;
        const auto foot = distance_.foot(placed(part_.fine_m[i], height), std::min(max_m, last_m));
        if (!std::isfinite(foot.distance_m)) continue;
        last[n] = {foot.distance_m, height};
        samples.push_back(
            {foot.distance_m, part_.fine_area[i], foot.direction, turn_ * part_.fine_m[i]});
      }
      layer.truth.emplace_back(samples, first_m, last_m);
    }
  }
}

Voxmap PairContact::bake(VoxelKind kind, std::size_t shift, bool whole) const {
  const Pose& world_from_scene = world_from_scene_[shift];
  mesh::Mesh world;
  stress::append(world, scene_, world_from_scene);
  std::optional<std::array<double, 6>> kept_m;
  if (!whole) {
    glm::dvec3 low(1e300), high(-1e300);
    for (const std::size_t i : near_) {
      const glm::dvec3 place =
          world_from_scene.orientation * placed(part_.fine_m[i], layers_[0].heights_m.front()) +
          world_from_scene.position_m;
      low = glm::min(low, place), high = glm::max(high, place);
    }
    low -= kKeptVoxels * s_, high += kKeptVoxels * s_;
    kept_m = {low.x, low.y, low.z, high.x, high.y, high.z};
  }
  const test::ScratchFolder folder;  // the bytes outlive the file
  stress::bake_scene_file(world, s_, kind, folder / "scene.vox", 0, kept_m);
  return value_of(Voxmap::open(folder / "scene.vox"));
}

DenseDistances PairContact::distances(std::size_t shift) const {
  const Layer& full = layer(VoxelKind::kFull);
  const Pose& world_from_scene = world_from_scene_[shift];
  const Pose scene_from_world = inverse(world_from_scene);
  const double deepest = full.heights_m.front(), way_m = full.heights_m.back() - deepest;
  const int steps = 4 * static_cast<int>(std::ceil(way_m / s_)) + 1;
  std::vector<glm::ivec3> cells;  // of the points that come near, their lowest voxels
  for (const glm::dvec3& p : part_.tested.points_m) {
    const double near_m = full.offset_m + way_m + s_;
    if (!std::isfinite(distance_.foot(placed(p, deepest), near_m).distance_m)) continue;
    for (int n = 0; n <= steps; ++n) {
      const glm::dvec3 place =
          world_from_scene.orientation * placed(p, deepest + way_m * (double(n) / steps)) +
          world_from_scene.position_m;
      cells.emplace_back(glm::floor(place / s_ - 0.5));
    }
  }
  glm::ivec3 low(1 << 30), high(-(1 << 30));
  for (const glm::ivec3& cell : cells) low = glm::min(low, cell), high = glm::max(high, cell);
  DenseDistances box;
  std::size_t count = 1;
  for (int d = 0; d < 3; ++d) {
    box.low[static_cast<std::size_t>(d)] = low[d] - 1;
    box.dims[static_cast<std::size_t>(d)] = high[d] - low[d] + 4;
    count *= static_cast<std::size_t>(high[d] - low[d] + 4);
  }
  constexpr float kUnknown = -1;
  box.distance_m.assign(count, kUnknown);
  for (const glm::ivec3& cell : cells) {
    // A voxel around them too, so that no pose between two steps needs another.
    for (int k = 0; k < 64; ++k) {
      const glm::ivec3 voxel = cell + glm::ivec3(k >> 4, k >> 2 & 3, k & 3) - 1;
      float& distance_m = box.distance_m[box.index({voxel.x, voxel.y, voxel.z})];
      if (distance_m != kUnknown) continue;
      const glm::dvec3 middle = (glm::dvec3(voxel) + 0.5) * s_;
      distance_m = static_cast<float>(
          distance_.foot(scene_from_world.orientation * middle + scene_from_world.position_m)
              .distance_m);
    }
  }
  const auto far_m = static_cast<float>(full.offset_m + 20 * s_);
  std::replace(box.distance_m.begin(), box.distance_m.end(), kUnknown, far_m);
  return box;
}

Quality PairContact::judge(VoxelKind kind, const WrenchAt& wrench_at, std::size_t shifts,
                           LoadOfTruth load) const {
  const Layer& through = layer(kind);
  bench::Measured measured(kDepths);
  for (std::size_t d = 0; d < kDepths; ++d) {
    for (std::size_t i = 0; i < shifts; ++i) {
      const Pose& world_from_scene = world_from_scene_[i];
      const Wrench w = wrench_at(i, world_from_scene * at_height(through.heights_m[d]));
      const glm::dquat back = glm::conjugate(world_from_scene.orientation);
      measured[d].push_back({back * w.force_n, back * w.torque_nm});
    }
  }
  const TruthAt truth_at = [&](std::size_t d, double offset_m) {
    return true_wrench_at(through.truth[d], offset_m, load);
  };
  std::vector<double> offsets_m;
  const double reach_m = kFitThicknesses * thickness_m_;
  for (double at = -reach_m; at < reach_m; at += 0.01 * s_) {
    offsets_m.push_back(through.offset_m + at);
  }
  return judged(measured, truth_at, {through.offset_m, through.depths_m, s_ / 4}, offsets_m,
                part_.tested.radius_m);
}

std::vector<Pose> PairContact::frames(VoxelKind kind) const {
  const std::vector<double>& heights_m = layer(kind).heights_m;
  std::vector<Pose> poses;
  for (std::size_t n = 0; n < kFrames; ++n) {
    const double fraction = 1 - static_cast<double>(n) / (kFrames - 1);
    const double height = heights_m.front() + fraction * (heights_m.back() - heights_m.front());
    poses.push_back(world_from_scene_[0] * at_height(height));
  }
  return poses;
}

mesh::Mesh PairContact::offset_mesh() const {
  const Layer& full = layer(VoxelKind::kFull);
  // Around what touches at the deepest pose.
  glm::dvec3 low(1e300), high(-1e300);
  for (const std::size_t i : near_) {
    const glm::dvec3 place = placed(part_.fine_m[i], full.heights_m.front());
    if (!std::isfinite(distance_.foot(place, full.offset_m + s_).distance_m)) continue;
    low = glm::min(low, place), high = glm::max(high, place);
  }
  const double margin_m = full.heights_m.back() - full.heights_m.front() + 2 * s_;
  low -= margin_m, high += margin_m;
  const double radius_m = glm::distance(low, high) / 2 + full.offset_m + 4 * s_;
  const double cell_m = s_ / kCellsPerVoxel;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  distance_.tree().visit_near(vec3_of((low + high) / 2.0), radius_m, [&](std::uint32_t t) {
    const auto first = static_cast<openvdb::Index32>(points.size());
    for (const std::uint32_t corner : distance_.soup().triangles[t]) {
      const glm::dvec3 cells =
          (glm_of(distance_.soup().vertices[corner]) - (low + high) / 2.0) / cell_m;
      points.emplace_back(static_cast<float>(cells.x), static_cast<float>(cells.y),
                          static_cast<float>(cells.z));
    }
    triangles.emplace_back(first, first + 1, first + 2);
  });
  const double band = full.offset_m / cell_m + 2;
  const auto grid = openvdb::tools::meshToUnsignedDistanceField<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(1), points, triangles, {},
      static_cast<float>(band));
  std::vector<openvdb::Vec3s> vertices;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, vertices, quads, full.offset_m / cell_m);
  mesh::Mesh mesh;
  mesh.single_precision = false;
  for (const openvdb::Vec3s& v : vertices) {
    const glm::dvec3 place = glm::dvec3(v.x(), v.y(), v.z()) * cell_m + (low + high) / 2.0;
    mesh.vertices.push_back({place.x, place.y, place.z});
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const glm::dvec3 p = glm_of(mesh.vertices[a]), q = glm_of(mesh.vertices[b]),
                     r = glm_of(mesh.vertices[c]), middle = (p + q + r) / 3.0;
    if (glm::clamp(middle, low, high) != middle) return;
    const glm::dvec3 outwards = distance_.foot(middle).direction;
    const bool out = glm::dot(glm::cross(q - p, r - p), outwards) >= 0;
    mesh.triangles.push_back(out ? mesh::Triangle{a, b, c} : mesh::Triangle{a, c, b});
  };
  for (const openvdb::Vec4I& q : quads) {
    add(q[0], q[1], q[2]);
    add(q[0], q[2], q[3]);
  }
  return mesh;
}

double PairContact::offset_mesh_deviation_m(const mesh::Mesh& mesh) const {
  const Layer& full = layer(VoxelKind::kFull);
  double largest = 0;
  for (const mesh::Vec3d& v : mesh.vertices) {
    // Near the part alone: at the border of the cut-out the mesh means nothing.
    double to_part2 = 1e300;
    for (std::size_t i = 0; i < near_.size(); i += 8) {
      const glm::dvec3 place = placed(part_.fine_m[near_[i]], full.heights_m.front());
      const glm::dvec3 way = place - glm_of(v);
      to_part2 = std::min(to_part2, glm::dot(way, way));
    }
    if (to_part2 > 4 * s_ * s_) continue;
    largest = std::max(largest, std::abs(distance_.foot(glm_of(v)).distance_m - full.offset_m));
  }
  return largest;
}

}  // namespace forcelayer::bench
