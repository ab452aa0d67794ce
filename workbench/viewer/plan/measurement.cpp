#include "workbench/viewer/plan/measurement.h"

#include <glm/geometric.hpp>
#include <utility>

#include "formats/result.h"
#include "workbench/viewer/run/moment.h"

namespace forcelayer::viewer {
namespace {

// The last name of an object's path.
std::string last_name(const std::string& path) { return escaped(path.substr(path.rfind('/') + 1)); }

}  // namespace

void Measurement::pick(PickedPlace place) {
  if (places_.size() == 2) places_.clear();
  places_.push_back(std::move(place));
}

std::vector<glm::dvec3> Measurement::places_m(const Pose& world_from_part) const {
  std::vector<glm::dvec3> places;
  for (const PickedPlace& place : places_) {
    places.push_back(place.of_part
                         ? world_from_part.orientation * place.place_m + world_from_part.position_m
                         : place.place_m);
  }
  return places;
}

std::string Measurement::words(const Pose& world_from_part) const {
  if (empty()) return "";
  const auto at_mm = [](const glm::dvec3& v) {
    return text_of("x %.3f, y %.3f, z %.3f mm", 1e3 * v.x, 1e3 * v.y, 1e3 * v.z);
  };
  const std::vector<glm::dvec3> places = places_m(world_from_part);
  const std::string first = last_name(places_[0].name);
  if (places.size() == 1) {
    return "first point: " + first + " at " + at_mm(places[0]) +
           "    key m: second point, at the pointer";
  }
  const glm::dvec3 offset_m = places[1] - places[0];
  return text_of("measured: %.3f mm", 1e3 * glm::length(offset_m)) + " from " + first + " to " +
         last_name(places_[1].name) + "    " + at_mm(offset_m);
}

}  // namespace forcelayer::viewer
