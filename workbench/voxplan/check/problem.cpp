#include "workbench/voxplan/check/problem.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::voxplan {
namespace {

glm::dvec3 turn_between(const Pose& from, const Pose& to) {
  return coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation));
}

}  // namespace

double travel_between_m(const Problem& problem, const Pose& from, const Pose& to) {
  return glm::length(to.position_m - from.position_m) +
         problem.part.header().bounding_radius_m * glm::length(turn_between(from, to));
}

Pose pose_between(const Pose& from, const Pose& to, double fraction) {
  return {
      from.position_m + (to.position_m - from.position_m) * fraction,
      glm::normalize(coupling::rotation_by(turn_between(from, to) * fraction) * from.orientation)};
}

PathRow row_of(double time_s, const Pose& pose) {
  const auto& p = pose.position_m;
  const auto& q = pose.orientation;
  return {time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

std::vector<Pose> with_more_poses(const Problem& problem, const std::vector<Pose>& path,
                                  double step_m) {
  std::vector<Pose> fine{path.front()};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double steps = std::ceil(travel_between_m(problem, path[i - 1], path[i]) / step_m);
    for (double n = 1; n < steps; ++n) {
      fine.push_back(pose_between(path[i - 1], path[i], n / steps));
    }
    fine.push_back(path[i]);
  }
  return fine;
}

std::vector<Pose> up_to_first(const std::vector<Pose>& path, const Problem& problem,
                              const std::function<bool(const Pose&)>& ends) {
  const std::vector<Pose> fine = with_more_poses(problem, path, problem.scene.voxel_size_m());
  std::vector<Pose> first{path.front()};
  for (std::size_t i = 1, corner = 1; i < fine.size(); ++i) {
    const bool is_end = ends(fine[i]);
    const bool is_corner = travel_between_m(problem, fine[i], path[corner]) == 0;
    if (is_corner) ++corner;
    if (is_end || is_corner) first.push_back(fine[i]);
    if (is_end) break;
  }
  return first;
}

}  // namespace forcelayer::voxplan
