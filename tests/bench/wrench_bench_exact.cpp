#include "tests/bench/wrench_bench_exact.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

namespace forcelayer::bench {
namespace {

part::Vec3 vec3_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
glm::dvec3 glm_of(const part::Vec3& v) { return {v.x, v.y, v.z}; }

part::Part soup_of(const mesh::Mesh& mesh) {
  mesh::Assembly assembly;
  assembly.meshes = {mesh};
  assembly.instances = {{0, "scene", {}}};
  assembly.meters_per_unit = 1;
  const part::PartInput input{&assembly, 1};
  auto soup = part::assemble_part({&input, 1});
  if (!soup) throw std::runtime_error(to_line(soup.error()));
  return std::move(*soup);
}

}  // namespace

ExactDistance::ExactDistance(const mesh::Mesh& mesh) : soup_(soup_of(mesh)), tree_(soup_) {}

ExactDistance::Foot ExactDistance::foot(const glm::dvec3& place, double within_m) const {
  const auto nearest = tree_.nearest(vec3_of(place), within_m);
  if (!nearest.found) return {std::numeric_limits<double>::infinity(), glm::dvec3(0)};
  const glm::dvec3 away = place - glm_of(nearest.point.position);
  const double distance = std::sqrt(nearest.distance_squared);
  return {distance, distance > 0 ? away / distance : glm::dvec3(0)};
}

void ExactDistance::check(std::size_t places, double spread_m, std::mt19937_64& random) const {
  std::uniform_int_distribution<std::size_t> some(0, soup_.vertices.size() - 1);
  std::normal_distribution<double> normal(0, spread_m);
  for (std::size_t i = 0; i < places; ++i) {
    const double x = normal(random), y = normal(random), z = normal(random);
    const glm::dvec3 place = glm_of(soup_.vertices[some(random)]) + glm::dvec3(x, y, z);
    double least2 = 1e300;
    for (const mesh::Triangle& t : soup_.triangles) {
      const part::Vec3 on = part::nearest_on_triangle(vec3_of(place), soup_.vertices[t[0]],
                                                      soup_.vertices[t[1]], soup_.vertices[t[2]]);
      least2 = std::min(least2, part::length_squared(on - vec3_of(place)));
    }
    if (std::abs(std::sqrt(least2) - foot(place).distance_m) > 1e-12) {
      throw std::runtime_error("the tree's distance is not that of all triangles");
    }
  }
}

}  // namespace forcelayer::bench
