#include "tests/stress/collisions.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <random>
#include <stdexcept>

#include "formats/mesh/scene.h"
#include "runtime/coupling/coupling.h"
#include "runtime/query/contact_query.h"
#include "tests/stress/shapes.h"
#include "tests/support/places.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::stress {
namespace {

using test::Random;
using test::random_direction;
using test::uniform;

constexpr double kS = 0.005;         // paper 6.3
constexpr double kTurnRad = 0.2;     // 0.1 N m on the coupling of the usual parameters, or less
constexpr double kStrideM = 0.001;   // of the search for what is in the way
constexpr double kFarthestM = 0.15;  // it is given up there
constexpr double kSlowestMps = 0.05, kFastestMps = 0.5;
constexpr double kDeepestM = 0.02;  // how far beyond the touch the hand wants to be
constexpr double kSlideM = 0.04;

std::string sample(const char* name) {
  return test::source_path(std::string("sample_data/") + name);
}

// The sample bay in one mesh: beams, posts, tubes, wires, skin, floor plate and bulkhead.
mesh::Mesh bay_mesh() {
  const std::string input = sample("bay.json");
  const auto scene = mesh::read_scene(std::span(&input, 1), std::nullopt);
  if (!scene) throw std::runtime_error(to_line(scene.error()));
  mesh::Mesh all;
  for (const mesh::MeshObject& part : scene->objects) {
    mesh::Mesh mesh = scene->mesh_of(part);
    for (mesh::Vec3d& vertex : mesh.vertices)
      vertex = forcelayer::mesh::apply(part.world_from_mesh, vertex);
    append(all, mesh);
  }
  return all;
}

mesh::Mesh pump_mesh() {
  const auto assembly = mesh::read_assembly(sample("part.obj"));
  if (!assembly) throw std::runtime_error(to_line(assembly.error()));
  mesh::Mesh mesh = assembly->meshes.at(0);
  for (mesh::Vec3d& vertex : mesh.vertices)
    for (double& coordinate : vertex) coordinate *= 0.001;  // millimeters
  return mesh;
}

struct Bay {
  Bay() { points.reserve(shell.view().point_count); }

  // Whether a shell point is in the force layer or behind it.
  bool touches(const Pose& world_from_part) {
    const auto& c = shell.header().center_m;
    query.run(world_from_part * Pose{{c[0], c[1], c[2]}, {1, 0, 0, 0}}, points);
    return points.surface_count + points.interior_count > 0;
  }

  std::shared_ptr<const BakedScene> scene = std::make_shared<BakedScene>(bay_mesh(), kS);
  std::shared_ptr<const BakedPart> pump = std::make_shared<BakedPart>(pump_mesh(), kS);
  Voxmap voxmap = scene->open();
  Pshell shell = pump->open();
  query::ContactQuery query{voxmap, shell, {}};
  query::CollectedPoints points;
};

Bay& bay() {
  static Bay bay;
  return bay;
}

// A pose under the floor that touches nothing.
Pose free_pose(Random& random) {
  for (int attempt = 0; attempt < 10000; ++attempt) {
    const glm::dvec3 place(uniform(random, -0.5, 0.5), uniform(random, -0.25, 0.25),
                           uniform(random, 0.08, 0.36));
    const Pose pose{place,
                    coupling::rotation_by(random_direction(random) * uniform(random, 0, M_PI))};
    if (!bay().touches(pose)) return pose;
  }
  throw std::runtime_error("the bay has no room");
}

// How far the part can go along `direction` until it touches; negative where nothing is in the way.
double way_to_touch_m(const Pose& from, const glm::dvec3& direction) {
  for (double way = kStrideM; way < kFarthestM; way += kStrideM) {
    if (bay().touches({from.position_m + way * direction, from.orientation})) return way;
  }
  return -1;
}

// One collision the same path backward.
struct Strike {
  Pose from, deep, aside;
  double begin_s, strike_s, slide_s;
};

// Rest to rest with the smoothest speed: fraction of the way at a fraction of the time. Its peak
// speed is 15/8 of the mean.
double smooth(double fraction) {
  const double t = std::clamp(fraction, 0.0, 1.0);
  return t * t * t * (10 + t * (6 * t - 15));
}

Pose between(const Pose& a, const Pose& b, double fraction) {
  return {glm::mix(a.position_m, b.position_m, fraction),
          glm::slerp(a.orientation, b.orientation, fraction)};
}

Pose at(const Strike& strike, double t_s) {
  const double t = t_s - strike.begin_s;
  if (t < strike.strike_s) {
    return between(strike.from, strike.deep, smooth(t / strike.strike_s));
  }
  const double slid = (t - strike.strike_s) / strike.slide_s;
  if (slid < 1) return between(strike.deep, strike.aside, smooth(slid));
  return between(strike.aside, strike.from, smooth(slid - 1));
}

Strike random_strike(Random& random, const Pose& from, double begin_s) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const glm::dvec3 direction = random_direction(random);
    const double way = way_to_touch_m(from, direction);
    if (way < 0) continue;
    const double length = way + uniform(random, 0, kDeepestM);
    const double peak = kSlowestMps * std::pow(kFastestMps / kSlowestMps, uniform(random, 0, 1));
    Strike strike{from, from, from, begin_s, 1.875 * length / peak, uniform(random, 0.8, 2)};
    strike.deep.position_m += direction * length;
    strike.deep.orientation =
        coupling::rotation_by(random_direction(random) * uniform(random, 0, kTurnRad)) *
        from.orientation;
    const glm::dvec3 sideways = random_direction(random);
    strike.aside = strike.deep;
    strike.aside.position_m +=
        (sideways - direction * glm::dot(sideways, direction)) * uniform(random, 0, kSlideM);
    return strike;
  }
  throw std::runtime_error("nothing to strike");
}

}  // namespace

Trial collision_trial(std::uint64_t seed) {
  Random random(seed);
  Trial trial;
  trial.scene = bay().scene;
  trial.part = bay().pump;
  trial.start = free_pose(random);
  trial.duration_s = 20;
  trial.hand.emplace();
  std::vector<Strike> strikes;
  for (double end_s = 0; end_s < trial.duration_s;) {
    strikes.push_back(random_strike(random, trial.start, end_s));
    end_s += strikes.back().strike_s + 2 * strikes.back().slide_s;
  }
  trial.target = [strikes](double t) {
    std::size_t now = strikes.size() - 1;
    while (now > 0 && strikes[now].begin_s > t) --now;
    return at(strikes[now], t);
  };
  return trial;
}

}  // namespace forcelayer::stress
