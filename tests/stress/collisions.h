// Collisions of the same spirit as those behind the paper's Table 2 (section 6).
#pragma once

#include <cstdint>

#include "tests/stress/trial.h"

namespace forcelayer::stress {

// The paper moved a teapot of 75 mm through an aircraft's beams, tubes and wires at 5 mm, with a
// device limited to 15 N and 0.1 N m, trapped it in congested places and staged high-speed
// collisions. Here the sample pump (75 mm) in the sample bay: a simulated hand on a simulated
// device strikes whatever is in a random direction, at a peak speed of 0.05 to 0.5 m/s (even in
// logarithm), 0 to 20 mm beyond the touch, turning by up to 0.2 rad; slides on by up to 40 mm; and
// goes back. Twenty seconds a trial; equal seeds give equal hands.
Trial collision_trial(std::uint64_t seed);

}  // namespace forcelayer::stress
