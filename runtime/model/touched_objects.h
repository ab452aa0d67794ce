// The objects that the part pushes against, and how hard: for the report of a frame.
#pragma once

#include <span>

#include "forcelayer/step.h"
#include "runtime/model/contact_force.h"

namespace forcelayer::model {

// At most so many contacts are asked for their object. Of more, runs of neighbors in the shell's
// order share the object of their deepest one.
inline constexpr std::uint32_t kAskedContacts = 256;

// An object that the guard keeps the part out of, though it may have no contact with depth, and the
// force with which the hand pulls the part.
struct StoppedBy {
  std::uint32_t object = 0;  // 0: none
  glm::dvec3 pull_n{0};
};

// Sets StepReport::touched and seat_contacts from the contacts of `set` at the pose
// `report.world_from_center`: `totals` are those of the law that begins at the zero-force surface,
// and the forces of all `laws` add up. What the contacts leave of the pull, the object that stops
// the part bears.
void report_touched(const field::ContactSet& set, const ContactTotals& totals,
                    std::span<const ContactLaw> laws, const field::ContactProbe& probe,
                    const StoppedBy& stop, StepReport& report) noexcept;

}  // namespace forcelayer::model
