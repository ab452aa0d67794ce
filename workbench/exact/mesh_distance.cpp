#include "workbench/exact/mesh_distance.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace forcelayer::exact {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

// In place: FCL's models share their memory when they are assigned.
void build(Model& model, const Surface& surface) {
  model.beginModel(static_cast<int>(surface.triangles.size()),
                   static_cast<int>(surface.vertices_m.size()));
  const auto vertex = [&](std::uint32_t i) {
    const glm::dvec3& v = surface.vertices_m[i];
    return fcl::Vector3d(v.x, v.y, v.z);
  };
  for (const mesh::Triangle& t : surface.triangles) {
    model.addTriangle(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  }
  model.endModel();
}

fcl::Transform3d transform_of(const Pose& pose) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  const glm::dquat& q = pose.orientation;
  transform.linear() = Eigen::Quaterniond(q.w, q.x, q.y, q.z).toRotationMatrix();
  transform.translation() = fcl::Vector3d(pose.position_m.x, pose.position_m.y, pose.position_m.z);
  return transform;
}

glm::dvec3 point_of(const fcl::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

using Corners = std::array<glm::dvec3, 3>;

Corners corners_of(const Model& model, std::size_t triangle, const Pose& world_from_model) {
  Corners corners;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto vertex = model.tri_indices[triangle][static_cast<int>(n)];
    corners[n] = world_from_model.position_m +
                 world_from_model.orientation * point_of(model.vertices[vertex]);
  }
  return corners;
}

double to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const double square = glm::dot(b - a, b - a);
  const double share = square > 0 ? std::clamp(glm::dot(p - a, b - a) / square, 0.0, 1.0) : 0;
  return glm::length(p - a - share * (b - a));
}

// How far a place is from a triangle.
double off_triangle(const glm::dvec3& p, const Corners& t, const glm::dvec3& normal) {
  const double area = glm::length(normal);
  bool inside = area > 0;
  double least = voxcheck::kNothingM;
  for (std::size_t n = 0; n < 3; ++n) {
    const glm::dvec3 &a = t[n], &b = t[(n + 1) % 3];
    inside = inside && glm::dot(glm::cross(normal, b - a), p - a) >= 0;
    least = std::min(least, to_segment(p, a, b));
  }
  return inside ? std::abs(glm::dot(normal, p - t[0])) / area : least;
}

// A place where two triangles meet: where an edge of one comes through the plane of the other, the
// nearest to that one.
glm::dvec3 meeting_place(const Corners& s, const Corners& t) {
  glm::dvec3 place = s[0];
  double least = voxcheck::kNothingM;
  for (const auto& [from, into] : {std::pair(&s, &t), std::pair(&t, &s)}) {
    const glm::dvec3 normal = glm::cross((*into)[1] - (*into)[0], (*into)[2] - (*into)[0]);
    for (std::size_t n = 0; n < 3; ++n) {
      const glm::dvec3 &a = (*from)[n], &b = (*from)[(n + 1) % 3];
      const double at_a = glm::dot(normal, a - (*into)[0]), at_b = glm::dot(normal, b - (*into)[0]);
      const double share = at_a == at_b ? 0 : std::clamp(at_a / (at_a - at_b), 0.0, 1.0);
      const glm::dvec3 p = a + share * (b - a);
      const double off = off_triangle(p, *into, normal);
      if (off >= least) continue;
      least = off;
      place = p;
    }
  }
  return place;
}

}  // namespace

struct MeshPair::Models {
  Model scene, part;
  bool empty = false;
};

MeshPair::MeshPair(const Surface& scene, const Surface& part) : models_(new Models) {
  models_->empty = scene.triangles.empty() || part.triangles.empty();
  if (models_->empty) return;
  build(models_->scene, scene);
  build(models_->part, part);
}
MeshPair::~MeshPair() = default;
MeshPair::MeshPair(MeshPair&&) noexcept = default;

MeshDistance MeshPair::at(const Pose& world_from_center, double hint_m) const {
  if (models_->empty) return {};
  const fcl::DistanceRequestd request(true);  // with the nearest points
  // The search leaves out what is farther apart than the result so far.
  fcl::DistanceResultd result(hint_m);
  const auto measure = [&] {
    fcl::distance<double>(&models_->scene, fcl::Transform3d::Identity(), &models_->part,
                          transform_of(world_from_center), request, result);
  };
  measure();
  if (result.b1 == fcl::DistanceResultd::NONE) {  // the hint was too small
    result = fcl::DistanceResultd();
    measure();
  }
  const auto triangle = static_cast<std::size_t>(result.b1);
  if (result.min_distance > 0) {
    return {result.min_distance, triangle, point_of(result.nearest_points[1]),
            point_of(result.nearest_points[0])};
  }
  const glm::dvec3 place = meeting_place(
      corners_of(models_->scene, triangle, {}),
      corners_of(models_->part, static_cast<std::size_t>(result.b2), world_from_center));
  return {0, triangle, place, place};
}

}  // namespace forcelayer::exact
