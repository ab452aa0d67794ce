#include "tests/bench/wrench_bench_pairs.h"

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
#include "tests/bench/force_bench_scene.h"
#include "tests/stress/shapes.h"
#include "tests/support/places.h"

namespace forcelayer::bench {
namespace {

constexpr int kLayers = 2;
constexpr double kFineVoxels = 0.35;            // edge of the pieces of the exact surface
constexpr double kNearVoxels = 9;               // beyond the force layer: points that never matter
constexpr double kTouchM = 1e-7;                // of the approach
constexpr double kSceneM = 0.6, kPartM = 0.15;  // longest sides of models
constexpr int kCheckedPoints = 100;
constexpr double kCellsPerVoxel = 3;  // of the grid from which the offset surface is drawn

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

mesh::Mesh read_mesh(const std::string& path, std::optional<double> unit_m) {
  return merged(value_of(mesh::read_scene(std::span(&path, 1), unit_m)));
}

// Scaled so that its longest side is this, m.
mesh::Mesh of_size(mesh::Mesh mesh, double longest_m) {
  const double scale = longest_m / longest_side(mesh);
  for (mesh::Vec3d& v : mesh.vertices) {
    for (double& x : v) x *= scale;
  }
  return mesh;
}

forcelayer::part::Part soup_of(const mesh::Mesh& mesh) {
  mesh::Assembly assembly;
  assembly.meshes = {mesh};
  assembly.instances = {{0, "scene", {}}};
  assembly.meters_per_unit = 1;
  const part::PartInput input{&assembly, 1};
  return value_of(part::assemble_part({&input, 1}));
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

std::vector<MeshPair> mesh_pairs(const std::string& models) {
  const std::string sample = test::source_path("sample_data/");
  std::vector<MeshPair> pairs;
  pairs.push_back({"pump on bay", read_mesh(sample + "bay.json", std::nullopt),
                   read_mesh(sample + "part.obj", 1e-3)});
  const auto add = [&](const char* name, const std::string& scene, const std::string& part,
                       std::optional<double> scene_unit) {
    for (const std::string& file : {scene, part}) {
      if (std::filesystem::exists(models + "/" + file)) continue;
      std::printf("%s left out: no %s in %s\n", name, file.c_str(), models.c_str());
      return;
    }
    pairs.push_back({name, of_size(read_mesh(models + "/" + scene, scene_unit), kSceneM),
                     of_size(read_mesh(models + "/" + part, 1.0), kPartM)});
  };
  add("teapot on dragon", "scan/dragon-100k.obj", "scan/teapot.obj", 1.0);
  add("bunny on engine", "cad/2CylinderEngine.glb", "scan/stanford-bunny.obj", std::nullopt);
  return pairs;
}

PairPart::PairPart(const MeshPair& pair, double voxel_size_m)
    : mesh(pair.part), shell(stress::BakedPart(pair.part, voxel_size_m).open()) {
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
  for (const mesh::Triangle& t : mesh.triangles) {
    cut(glm_of(mesh.vertices[t[0]]), glm_of(mesh.vertices[t[1]]), glm_of(mesh.vertices[t[2]]),
        kFineVoxels * voxel_size_m, fine_m, fine_area);
  }
  for (double& area : fine_area) area /= mean;
}

PairCase::PairCase(const MeshPair& pair, const PairPart& part, double voxel_size_m,
                   std::mt19937_64& random, test::VoxelKind kind)
    : pair_(pair),
      part_(part),
      s_(voxel_size_m),
      kind_(kind),
      soup_(soup_of(pair.scene)),
      tree_(std::make_unique<part::TriangleTree>(soup_)),
      world_from_scene_turn_(random_turn(random)),
      reach_m_(2 * longest_side(pair.scene) + part.tested.radius_m) {
  check_tree(random);
  for (int tries = 0; !approach(random); ++tries) {
    if (tries > 100) throw std::runtime_error(pair.name + ": the part does not meet the scene");
  }
  keep_near_points();
  tabulate_truth();
  place(random);
}

PairCase::Foot PairCase::foot(const glm::dvec3& place) const {
  const auto nearest = tree_->nearest(vec3_of(place));
  const glm::dvec3 away = place - glm_of(nearest.point.position);
  const double distance = std::sqrt(nearest.distance_squared);
  return {distance, distance > 0 ? away / distance : glm::dvec3(0)};
}

// The oracle's twin: every triangle.
void PairCase::check_tree(std::mt19937_64& random) const {
  std::uniform_int_distribution<std::size_t> some(0, soup_.vertices.size() - 1);
  for (int i = 0; i < kCheckedPoints; ++i) {
    const glm::dvec3 place =
        glm_of(soup_.vertices[some(random)]) + 10.0 * s_ * random_direction(random);
    double least2 = 1e300;
    for (const mesh::Triangle& t : soup_.triangles) {
      const part::Vec3 on = part::nearest_on_triangle(vec3_of(place), soup_.vertices[t[0]],
                                                      soup_.vertices[t[1]], soup_.vertices[t[2]]);
      least2 = std::min(least2, part::length_squared(on - vec3_of(place)));
    }
    if (std::abs(std::sqrt(least2) - foot(place).distance_m) > 1e-12) {
      throw std::runtime_error(pair_.name + ": the tree's distance is not that of all triangles");
    }
  }
}

Pose PairCase::at_height(double height_m) const { return {aim_m_ + height_m * line_, turn_}; }

// Comes down from `height_m` until the least distance of the part is `distance_m`: steps by what is
// surely free. The height, or minus infinity where it passes by or begins too near.
double PairCase::advanced_to(double height_m, double distance_m) {
  for (;;) {
    const Pose pose = at_height(height_m);
    double least = 1e300;
    for (std::size_t i = 0; i < part_.fine_m.size(); ++i) {
      const double moved_m = std::abs(measured_at_m_[i] - height_m);
      if (measured_m_[i] - moved_m >= least) continue;
      const glm::dvec3 place = pose.orientation * part_.fine_m[i] + pose.position_m;
      measured_m_[i] = foot(place).distance_m;
      measured_at_m_[i] = height_m;
      least = std::min(least, measured_m_[i]);
    }
    if (least < distance_m - kTouchM) return -INFINITY;  // it was nearer before it began
    if (least <= distance_m + kTouchM) return height_m;
    height_m -= least - distance_m;
    if (height_m < -reach_m_) return -INFINITY;
  }
}

bool PairCase::approach(std::mt19937_64& random) {
  std::uniform_int_distribution<std::size_t> some(0, soup_.triangles.size() - 1);
  const mesh::Triangle& t = soup_.triangles[some(random)];
  aim_m_ = glm_of(soup_.vertices[t[0]]);
  line_ = random_direction(random);
  turn_ = random_turn(random);
  measured_m_.assign(part_.fine_m.size(), -1e300);
  measured_at_m_.assign(part_.fine_m.size(), 0);
  const double touched = advanced_to(reach_m_, 2.5 * s_);
  if (!std::isfinite(touched)) return false;
  const Pose pose = at_height(touched);
  double least = 1e300;
  glm::dvec3 normal(0);
  for (std::size_t i = 0; i < part_.fine_m.size(); ++i) {
    if (measured_m_[i] - std::abs(measured_at_m_[i] - touched) >= least) continue;
    const Foot near = foot(pose.orientation * part_.fine_m[i] + pose.position_m);
    if (near.distance_m < least) least = near.distance_m, normal = near.direction;
  }
  const glm::dvec3 slanted = world_from_scene_turn_ * normal;
  thickness_m_ = norm1(slanted) * s_;
  middle_m_ = zero_force_voxels(kind_, kLayers, slanted) * s_;
  measured_m_.assign(part_.fine_m.size(), -1e300);
  heights_m_.assign(kDepths, 0);
  double height = touched + 4 * s_;  // above the outermost depth, on a line that was free
  for (std::size_t d = kDepths; d-- > 0;) {
    const double share = (static_cast<double>(d) + 0.5) / kDepths - 0.5;
    height = advanced_to(height, middle_m_ + share * thickness_m_);
    if (!std::isfinite(height)) return false;
    heights_m_[d] = height;
  }
  return true;
}

void PairCase::keep_near_points() {
  const Pose pose = at_height(heights_m_.back());
  const double way_m = heights_m_.back() - heights_m_.front();
  for (std::size_t i = 0; i < part_.fine_m.size(); ++i) {
    const glm::dvec3 place = pose.orientation * part_.fine_m[i] + pose.position_m;
    if (foot(place).distance_m < middle_m_ + kNearVoxels * s_ + way_m) near_.push_back(i);
  }
}

void PairCase::tabulate_truth() {
  for (const double height : heights_m_) {
    const Pose pose = at_height(height);
    std::vector<SurfaceSample> samples;
    for (const std::size_t i : near_) {
      const glm::dvec3 arm = pose.orientation * part_.fine_m[i];
      const Foot near = foot(arm + pose.position_m);
      samples.push_back({near.distance_m, part_.fine_area[i], near.direction, arm});
    }
    truth_.emplace_back(samples, middle_m_ - 1.5 * thickness_m_, middle_m_ + 1.5 * thickness_m_);
  }
}

openvdb::FloatGrid::Ptr PairCase::distances_around(const Pose& world_from_scene) const {
  auto grid = openvdb::FloatGrid::create(static_cast<float>(middle_m_ + 20 * s_));
  auto accessor = grid->getAccessor();
  const Pose scene_from_world = inverse(world_from_scene);
  const double way_m = heights_m_.back() - heights_m_.front();
  const int steps = 4 * static_cast<int>(std::ceil(way_m / s_)) + 1;
  for (int n = 0; n <= steps; ++n) {
    const Pose pose =
        world_from_scene * at_height(heights_m_.front() + way_m * (double(n) / steps));
    for (const glm::dvec3& p : part_.tested.points_m) {
      const glm::dvec3 place = pose.orientation * p + pose.position_m;
      const glm::dvec3 low = glm::floor(place / s_ - 0.5);
      // Two voxels around, so that no pose between two of these needs another.
      const glm::dvec3 in_scene =
          scene_from_world.orientation * place + scene_from_world.position_m;
      if (foot(in_scene).distance_m > middle_m_ + 3 * s_) continue;
      for (int k = 0; k < 64; ++k) {
        const openvdb::Coord c(static_cast<int>(low.x) + (k >> 4) - 1,
                               static_cast<int>(low.y) + (k >> 2 & 3) - 1,
                               static_cast<int>(low.z) + (k & 3) - 1);
        if (accessor.isValueOn(c)) continue;
        const glm::dvec3 middle = (glm::dvec3(c.x(), c.y(), c.z()) + 0.5) * s_;
        accessor.setValueOn(c, static_cast<float>(foot(scene_from_world.orientation * middle +
                                                       scene_from_world.position_m)
                                                      .distance_m));
      }
    }
  }
  return grid;
}

void PairCase::place(std::mt19937_64& random) {
  std::uniform_real_distribution<double> share(0, 1);
  for (std::size_t i = 0; i < kShifts; ++i) {
    const double x = share(random), y = share(random), z = share(random);
    const Pose world_from_scene{glm::dvec3(x, y, z) * s_, world_from_scene_turn_};
    mesh::Mesh placed;
    stress::append(placed, pair_.scene, world_from_scene);
    placings_.push_back({world_from_scene, stress::BakedScene(placed, s_).open(kind_),
                         distances_around(world_from_scene)});
  }
}

Quality PairCase::judge(const WrenchAt& wrench_at, bool by_ten) const {
  Measured measured(kDepths);
  for (std::size_t d = 0; d < kDepths; ++d) {
    for (std::size_t i = 0; i < kShifts; ++i) {
      const Pose& world_from_scene = placings_[i].world_from_scene;
      const Wrench w = wrench_at(i, world_from_scene * at_height(heights_m_[d]));
      const glm::dquat back = glm::conjugate(world_from_scene.orientation);
      measured[d].push_back({back * w.force_n, back * w.torque_nm});
    }
  }
  const TruthAt truth_at = [&](std::size_t d, double offset_m) {
    Wrench w = truth_[d].wrench_at(offset_m);
    const double points = truth_[d].area_at(offset_m);
    if (by_ten && points >= 10) w.force_n *= 10 / points, w.torque_nm *= 10 / points;
    return w;
  };
  std::vector<double> offsets_m;
  for (double at = -1.5 * thickness_m_; at < 1.5 * thickness_m_; at += 0.01 * s_) {
    offsets_m.push_back(middle_m_ + at);
  }
  return judged(measured, truth_at, offsets_m, part_.tested.radius_m);
}

std::vector<Pose> PairCase::frames() const {
  std::vector<Pose> poses;
  const double way_m = heights_m_.back() - heights_m_.front();
  for (std::size_t n = 0; n < kFrames; ++n) {
    const double share = 1 - static_cast<double>(n) / (kFrames - 1);
    poses.push_back(placings_[0].world_from_scene * at_height(heights_m_.front() + share * way_m));
  }
  return poses;
}

mesh::Mesh PairCase::offset_mesh() const {
  // What can come near: around the part where it touches.
  const Pose pose = at_height(heights_m_.front());
  glm::dvec3 low(1e300), high(-1e300);
  for (const std::size_t i : near_) {
    const glm::dvec3 place = pose.orientation * part_.fine_m[i] + pose.position_m;
    low = glm::min(low, place), high = glm::max(high, place);
  }
  const double radius_m = glm::distance(low, high) / 2 + middle_m_ + 4 * s_;
  const double cell_m = s_ / kCellsPerVoxel;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  tree_->visit_near(vec3_of((low + high) / 2.0), radius_m, [&](std::uint32_t t) {
    const auto first = static_cast<openvdb::Index32>(points.size());
    for (const std::uint32_t corner : soup_.triangles[t]) {
      const glm::dvec3 cells = (glm_of(soup_.vertices[corner]) - (low + high) / 2.0) / cell_m;
      points.emplace_back(static_cast<float>(cells.x), static_cast<float>(cells.y),
                          static_cast<float>(cells.z));
    }
    triangles.emplace_back(first, first + 1, first + 2);
  });
  const double band = middle_m_ / cell_m + 2;
  const auto grid = openvdb::tools::meshToUnsignedDistanceField<openvdb::FloatGrid>(
      *openvdb::math::Transform::createLinearTransform(1), points, triangles, {},
      static_cast<float>(band));
  std::vector<openvdb::Vec3s> vertices;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*grid, vertices, quads, middle_m_ / cell_m);
  mesh::Mesh mesh;
  mesh.single_precision = false;
  for (const openvdb::Vec3s& v : vertices) {
    const glm::dvec3 place = glm::dvec3(v.x(), v.y(), v.z()) * cell_m + (low + high) / 2.0;
    mesh.vertices.push_back({place.x, place.y, place.z});
  }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const glm::dvec3 p = glm_of(mesh.vertices[a]), q = glm_of(mesh.vertices[b]),
                     r = glm_of(mesh.vertices[c]);
    const bool out = glm::dot(glm::cross(q - p, r - p), foot((p + q + r) / 3.0).direction) >= 0;
    mesh.triangles.push_back(out ? mesh::Triangle{a, b, c} : mesh::Triangle{a, c, b});
  };
  for (const openvdb::Vec4I& q : quads) {
    add(q[0], q[1], q[2]);
    add(q[0], q[2], q[3]);
  }
  return mesh;
}

double PairCase::offset_mesh_deviation_m(const mesh::Mesh& mesh) const {
  const Pose pose = at_height(heights_m_.front());
  double largest = 0;
  for (const mesh::Vec3d& v : mesh.vertices) {
    // Near the part alone: at the border of the cut-out the mesh means nothing.
    double to_part2 = 1e300;
    for (std::size_t i = 0; i < near_.size(); i += 8) {
      const glm::dvec3 place = pose.orientation * part_.fine_m[near_[i]] + pose.position_m;
      const glm::dvec3 way = place - glm_of(v);
      to_part2 = std::min(to_part2, glm::dot(way, way));
    }
    if (to_part2 > 4 * s_ * s_) continue;
    largest = std::max(largest, std::abs(foot(glm_of(v)).distance_m - middle_m_));
  }
  return largest;
}

}  // namespace forcelayer::bench
