// What voxrun commands at rest, beside what the bench sums: the step itself is run until a pressed
// part holds still, and the wrench on the hand is compared with the shared force at that pose.
#pragma once

#include <cstddef>

#include "tests/bench/wrench_bench_pairs.h"

namespace forcelayer::bench {

class Commanded {
 public:
  // Presses the part along the line of the contact. A part that slips off is not compared. Throws
  // std::runtime_error where the two differ by more than the step's own rest leaves.
  void see(const PairContact& contact, const PairPart& part);

  std::size_t compared() const { return compared_; }
  double most() const { return most_; }  // difference over the force; torque over it and the radius

 private:
  std::size_t compared_ = 0;
  double most_ = 0;
};

}  // namespace forcelayer::bench
