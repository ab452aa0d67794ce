// The distance between two places that were picked.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "forcelayer/pose.h"

namespace forcelayer::viewer {

// A place on what is drawn. One of the part goes with it.
struct PickedPlace {
  std::string name;             // of the object
  glm::dvec3 place_m{0, 0, 0};  // in the part's frame where it is of the part, else in the world
  bool of_part = false;
};

class Measurement {
 public:
  bool empty() const { return places_.empty(); }
  void pick(PickedPlace place);  // the first or the second; a third is the first of another
  void clear() { places_.clear(); }

  // The places in the world, none to two, for a pose of the part.
  std::vector<glm::dvec3> places_m(const Pose& world_from_part) const;
  // A line for the window; empty where nothing is picked.
  std::string words(const Pose& world_from_part) const;

 private:
  std::vector<PickedPlace> places_;
};

}  // namespace forcelayer::viewer
