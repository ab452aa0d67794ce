#include "tests/stress/clearance_cases.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <map>
#include <stdexcept>

#include "formats/mesh/scene.h"
#include "runtime/coupling/coupling.h"
#include "tests/stress/baked.h"
#include "tests/stress/shapes.h"
#include "tests/support/places.h"

namespace forcelayer::stress {
namespace {

using test::integer;
using test::Random;
using test::random_direction;
using test::random_orientation;
using test::uniform;

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

struct Box {
  glm::dvec3 low{1e300}, high{-1e300};

  void add(const mesh::Mesh& mesh) {
    for (const mesh::Vec3d& v : mesh.vertices) {
      low = glm::min(low, {v[0], v[1], v[2]});
      high = glm::max(high, {v[0], v[1], v[2]});
    }
  }
  double longest() const { return std::max({high.x - low.x, high.y - low.y, high.z - low.z}); }
};

Box box_of(std::span<const mesh::Mesh> meshes) {
  Box box;
  for (const mesh::Mesh& mesh : meshes) box.add(mesh);
  return box;
}

mesh::Mesh scaled(mesh::Mesh mesh, double factor) {
  for (mesh::Vec3d& v : mesh.vertices) {
    for (double& x : v) x *= factor;
  }
  return mesh;
}

mesh::Mesh centered(const mesh::Mesh& mesh) {
  const Box box = box_of({&mesh, 1});
  mesh::Mesh moved;
  append(moved, mesh, {-0.5 * (box.low + box.high), {1, 0, 0, 0}});
  return moved;
}

std::vector<mesh::Mesh> read_objects(const std::string& path, std::optional<double> unit_m,
                                     const std::vector<std::string>& without = {}) {
  mesh::SceneReading reading;
  reading.without = without;
  const mesh::Scene scene = value_of(mesh::read_scene(std::span(&path, 1), unit_m, reading));
  std::vector<mesh::Mesh> objects;
  for (const mesh::MeshObject& object : scene.objects) {
    mesh::Mesh placed = scene.mesh_of(object);
    for (mesh::Vec3d& v : placed.vertices) v = mesh::apply(object.world_from_mesh, v);
    placed.single_precision = false;
    objects.push_back(std::move(placed));
  }
  return objects;
}

mesh::Mesh read_part(const std::string& path, std::optional<double> unit_m) {
  mesh::Mesh all;
  for (const mesh::Mesh& object : read_objects(path, unit_m)) append(all, object);
  return centered(all);
}

// A scene and a part from files, read once; longest sides of 0 leave them as they are.
struct FilePair {
  std::vector<mesh::Mesh> objects;
  mesh::Mesh part;
};

FilePair resized(FilePair pair, double scene_m, double part_m) {
  const double scene = scene_m / box_of(pair.objects).longest();
  for (mesh::Mesh& object : pair.objects) object = scaled(std::move(object), scene);
  pair.part = scaled(std::move(pair.part), part_m / box_of({&pair.part, 1}).longest());
  return pair;
}

// At a voxel size between two, turned at random.
ClearanceScene placed(const FilePair& pair, std::uint64_t seed, double min_m, double max_m) {
  Random random(seed);
  ClearanceScene scene;
  scene.voxel_size_m = min_m * std::pow(max_m / min_m, uniform(random, 0, 1));
  const Pose pose{scene.voxel_size_m * uniform(random, -50, 50) * random_direction(random),
                  random_orientation(random)};
  for (const mesh::Mesh& object : pair.objects) append(scene.objects.emplace_back(), object, pose);
  scene.part = pair.part;
  return scene;
}

std::string sample(const char* file) {
  return test::source_path(std::string("sample_data/") + file);
}

ClearanceScene pump_on_bay(std::uint64_t seed, const std::string&) {
  static const FilePair pair{read_objects(sample("bay.json"), std::nullopt),
                             read_part(sample("part.obj"), 1e-3)};
  return placed(pair, seed, 0.003, 0.01);
}

ClearanceScene cover_on_gearbox(std::uint64_t seed, const std::string&) {
  static const FilePair pair{read_objects(sample("gearbox.glb"), std::nullopt, {"Cover"}),
                             read_part(sample("gearbox.glb#Cover"), std::nullopt)};
  return placed(pair, seed, 0.001, 0.003);
}

ClearanceScene teapot_on_dragon(std::uint64_t seed, const std::string& models) {
  static const FilePair pair = resized({read_objects(models + "/scan/dragon-100k.obj", 1.0),
                                        read_part(models + "/scan/teapot.obj", 1.0)},
                                       0.6, 0.15);
  return placed(pair, seed, 0.003, 0.01);
}

ClearanceScene bunny_on_engine(std::uint64_t seed, const std::string& models) {
  static const FilePair pair =
      resized({read_objects(models + "/cad/2CylinderEngine.glb", std::nullopt),
               read_part(models + "/scan/stanford-bunny.obj", 1.0)},
              0.6, 0.15);
  return placed(pair, seed, 0.004, 0.01);
}

ClearanceScene module_on_counter(std::uint64_t seed, const std::string& models) {
  static const FilePair pair = resized({read_objects(models + "/cad/counter.unitsmm.stl", 1e-3),
                                        read_part(models + "/cad/ADIS16480.stl", 1e-3)},
                                       0.6, 0.15);
  return placed(pair, seed, 0.003, 0.01);
}

ClearanceScene generated(std::uint64_t seed, const std::string&) {
  return generated_clearance_scene(seed);
}

constexpr ClearanceFamily kFamilies[] = {
    {"generated", "generated", 100, generated, ""},
    {"pump on bay", "sample", 1000, pump_on_bay, ""},
    {"cover on gearbox", "sample", 1000, cover_on_gearbox, ""},
    {"teapot on dragon", "shared", 2000, teapot_on_dragon, "scan/dragon-100k.obj"},
    {"bunny on engine", "shared", 2000, bunny_on_engine, "cad/2CylinderEngine.glb"},
    {"module on counter", "shared", 2000, module_on_counter, "cad/counter.unitsmm.stl"}};

Pose random_pose(Random& random, double size_m) {
  return {size_m * uniform(random, 0, 1) * random_direction(random), random_orientation(random)};
}

mesh::Mesh random_solid(Random& random, double v) {
  const auto half = [&] {
    return v * (0.05 + glm::abs(glm::dvec3(uniform(random, 0, 8), uniform(random, 0, 8),
                                           uniform(random, 0, 8))));
  };
  switch (integer(random, 0, 5)) {
    case 0:
      return sphere(uniform(random, 0.3, 8) * v, 20);
    case 1:
      return box(half());
    case 2:
      return sheet(uniform(random, 0.2, 12) * v, uniform(random, 0.2, 12) * v);
    case 3:
      return tube(5 * v, uniform(random, 5.1, 8) * v, uniform(random, 1, 9) * v, 18);
    case 4:
      return cylinder(uniform(random, 0.1, 4) * v, uniform(random, 0.5, 12) * v, 12);
    default:
      return thread(5 * v, 1.5 * v, 3 * v, 3, 16);
  }
}

mesh::Mesh random_part(Random& random, double v) {
  switch (integer(random, 0, 4)) {
    case 0:
      return sphere(uniform(random, 2, 6) * v, 18);
    case 1:
      return box(v * (0.3 + glm::dvec3(uniform(random, 0, 6), uniform(random, 0, 6),
                                       uniform(random, 0, 6))));
    case 2:
      return cylinder(uniform(random, 0.5, 4) * v, uniform(random, 1, 9) * v, 14);
    case 3:
      return box({uniform(random, 50, 400) * v, v, uniform(random, 0.2, 2) * v});
    default:
      return centered(
          prism({{0, 0}, {8 * v, 0}, {8 * v, v}, {v, v}, {v, 6 * v}, {0, 6 * v}}, 3 * v));
  }
}

}  // namespace

std::span<const ClearanceFamily> clearance_families() { return kFamilies; }

ClearanceScene generated_clearance_scene(std::uint64_t seed) {
  Random random(seed);
  ClearanceScene scene;
  const double v = scene.voxel_size_m = std::pow(10, uniform(random, -3.5, -1.5));
  const bool far = seed % 5 == 0;
  const glm::dvec3 origin = v * (far ? 1e5 : 10) * random_direction(random);
  for (std::int64_t n = integer(random, 1, 5); n > 0; --n) {
    Pose pose = random_pose(random, 14 * v);
    pose.position_m += origin;
    append(scene.objects.emplace_back(), random_solid(random, v), pose);
  }
  scene.part = random_part(random, v);
  if (seed % 4 == 0) {
    const Box all = box_of(scene.objects);
    const glm::dvec3 size = all.high - all.low;
    scene.roi_m.emplace();
    for (int a = 0; a < 3; ++a) {
      const auto n = static_cast<std::size_t>(a);
      (*scene.roi_m)[n] = all.low[a] - 12 * v + uniform(random, 0, 0.7) * (size[a] + 12 * v);
      (*scene.roi_m)[n + 3] = (*scene.roi_m)[n] + v + uniform(random, 0.3, 1) * (size[a] + 24 * v);
    }
  }
  return scene;
}

BakedClearance::BakedClearance(const ClearanceScene& scene) {
  bake_objects_file(scene.objects, scene.voxel_size_m, folder_ / "scene.vox", scene.standoff_m,
                    scene.roi_m);
  bake_part_file(scene.part, scene.voxel_size_m, folder_ / "part.pshell");
}

Voxmap BakedClearance::open_scene() const { return value_of(Voxmap::open(folder_ / "scene.vox")); }
Pshell BakedClearance::open_part() const { return value_of(Pshell::open(folder_ / "part.pshell")); }

Approach::Approach(const ClearanceScene& scene, std::uint64_t seed)
    : random_(seed), scene_(scene), part_radius_m_(radius_m(scene.part)) {
  start_m_ = 2 * box_of(scene.objects).longest() + part_radius_m_ + 10 * scene.voxel_size_m;
}

Pose Approach::begin() {
  const auto& vertices = scene_
                             .objects[static_cast<std::size_t>(integer(
                                 random_, 0, static_cast<std::int64_t>(scene_.objects.size()) - 1))]
                             .vertices;
  const auto& aim = vertices[static_cast<std::size_t>(
      integer(random_, 0, static_cast<std::int64_t>(vertices.size()) - 1))];
  aim_m_ = {aim[0], aim[1], aim[2]};
  way_ = random_direction(random_);
  // The line leads some place of the part to the vertex, not always its middle.
  aim_m_ += uniform(random_, 0, 1) * part_radius_m_ * random_direction(random_);
  return {aim_m_ - start_m_ * way_, random_orientation(random_)};
}

Pose Approach::next(const Pose& at, double exact_m) {
  const double s = scene_.voxel_size_m;
  const bool passed = glm::dot(at.position_m - aim_m_, way_) > part_radius_m_ + 8 * s;
  if (exact_m < 0.1 * s || passed) return begin();
  // Far away to within eight voxels, then about a fifth of a voxel at a time.
  const double step_m = exact_m > 8 * s
                            ? std::max(0.5 * exact_m, exact_m - uniform(random_, 3, 8) * s)
                            : std::min(0.6 * exact_m, s * uniform(random_, 0, 0.5));
  const double angle = uniform(random_, 0, 0.9) * (exact_m - step_m) / part_radius_m_;
  return {at.position_m + step_m * way_,
          glm::normalize(coupling::rotation_by(std::min(angle, 1.0) * random_direction(random_)) *
                         at.orientation)};
}

}  // namespace forcelayer::stress
