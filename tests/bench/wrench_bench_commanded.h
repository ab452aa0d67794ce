// The wrench that voxrun commands at rest, beside the bench's sum: the step is run until a pressed
// part holds still, and the wrench on the hand is compared with the shared force at that pose.
#pragma once

#include <cstddef>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::bench {

class Commanded {
 public:
  // A hand presses the part, from world_from_center `above` on along `in`. A part that slips off,
  // or is not at rest after three seconds, is not compared.
  void see(const Voxmap& voxmap, const Pshell& shell, const Pose& above, const glm::dvec3& in);

  // For each one compared: the difference over the force, or that of the torques over force and
  // radius, where it is larger. While the hand rests, a motion that hardly lowers the energy is not
  // made (DefaultModel::affordable), so the part stays a little beside where forces balance.
  const std::vector<double>& off() const { return off_; }
  std::size_t many() const { return many_; }  // of these, with more than ten contacts

 private:
  std::vector<double> off_;
  std::size_t many_ = 0;
};

}  // namespace forcelayer::bench
