// The wrench that a hand feels through the coupling, beside the truth of rigid contact: the step is
// run while a hand presses a part, holds it, and slides it along.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::bench {

// A part above a scene.
struct HandCase {
  std::string name;  // of the contact
  const Voxmap& voxmap;
  const Pshell& shell;
  const mesh::Mesh& scene;  // the exact surface, world, m
  const mesh::Mesh& part;   // the exact surface, about the shell's center, m
  Pose above;               // world_from_part
  glm::dvec3 in, along;     // unit: how the hand presses, and how it slides then
};

// E_hand is the norm of the felt wrench less the true one, torques over the part's radius, over the
// coupling's force limit. The true one is the coupling's in the nearest pose of least energy that
// keeps the exact distance of the meshes at the zero-force distance.
class Hand {
 public:
  static constexpr std::size_t kMotions = 3;
  static constexpr std::array<const char*, kMotions> kNames{"at rest", "5 mm/s", "50 mm/s"};

  // A hand presses with a fifth to four fifths of the limit, turned by up to 0.02 rad, both at
  // random of the seed. It holds for up to three seconds and slides for a fifth of a second at each
  // speed.
  void see(const HandCase& contact, std::uint64_t seed);

  const std::vector<double>& errors(std::size_t motion) const { return errors_[motion]; }

  // The causes of the error at rest. From the true wrench to the felt one there are three steps.
  // Each error is the difference of two wrenches, as E_hand is that of the first and the last:
  //   points   rigid contact of the shell's points in place of the part's surface
  //   field    the same with the stored distances at these points in place of exact ones
  //   law      the force of the contacts and a part at rest in place of rigid contact
  // A case is left out where one of the two wrenches between was not found.
  static constexpr std::size_t kCauses = 3;
  static constexpr std::array<const char*, kCauses> kCauseNames{"points", "field", "law"};
  const std::vector<double>& cause(std::size_t i) const { return causes_[i]; }

  // The errors of one case: the median over the poses of each motion, and the causes; NaN without
  // poses.
  struct Each {
    std::string contact;
    std::array<double, kMotions> median;
    std::array<double, kCauses> causes{NAN, NAN, NAN};
  };
  const std::vector<Each>& each() const { return each_; }

  std::size_t seen() const { return seen_; }          // cases
  std::size_t passed() const { return passed_; }      // cases that touch nothing in the end
  std::size_t restless() const { return restless_; }  // cases that touch and do not rest
  std::size_t unsolved() const { return unsolved_; }  // poses whose truth was not found
  std::size_t outside() const { return outside_; }    // poses beyond the map's sides

  // For each case at rest: the felt force's difference from the sum of the contacts' forces at that
  // pose, over it, or that of the torques, over force and radius, where it is larger. While the
  // hand rests, a motion that hardly lowers the energy is not made (DefaultModel::affordable), and
  // depths are rounded to floats, so the part stays a little beside where forces balance.
  const std::vector<double>& off() const { return off_; }
  std::size_t flush() const { return flush_; }  // of these, with three contacts or more

  double step_us() const;  // median of the steps while sliding; NaN without steps

 private:
  void press(const HandCase& contact, std::uint64_t seed, Each& each);

  std::array<std::vector<double>, kMotions> errors_;
  std::array<std::vector<double>, kCauses> causes_;
  std::vector<Each> each_;
  std::vector<double> off_, step_us_;
  std::size_t flush_ = 0, seen_ = 0, passed_ = 0, restless_ = 0, unsolved_ = 0, outside_ = 0;
};

}  // namespace forcelayer::bench
