#include "runtime/model/touched_objects.h"

#include <algorithm>
#include <array>

namespace forcelayer::model {
namespace {

constexpr double kNoticedN = 0.01;  // less is rounding, and the damper of a part that comes to rest

// The forces of the objects that were found, as vectors.
class ObjectForces {
 public:
  // Objects found after the table is full are left out.
  void add(std::uint32_t object, const glm::dvec3& force_n) noexcept {
    std::size_t at = 0;
    while (at < size_ && objects_[at] != object) ++at;
    if (at == objects_.size()) return;
    if (at == size_) {
      objects_[size_] = object;
      forces_n_[size_++] = {};
    }
    forces_n_[at] += force_n;
  }

  void strongest(StepReport& report) const noexcept {
    for (std::size_t i = 0; i < size_; ++i) {
      TouchedObject found{objects_[i], static_cast<float>(glm::length(forces_n_[i]))};
      for (TouchedObject& kept : report.touched) {
        if (kept.object == 0 || found.force_n > kept.force_n) std::swap(kept, found);
      }
    }
  }

 private:
  std::array<std::uint32_t, 32> objects_;
  std::array<glm::dvec3, 32> forces_n_;
  std::size_t size_ = 0;
};

}  // namespace

void report_touched(const field::ContactSet& set, const ContactTotals& totals,
                    std::span<const ContactLaw> laws, const field::ContactProbe& probe,
                    const StoppedBy& stop, StepReport& report) noexcept {
  const std::uint32_t run = (totals.count + kAskedContacts - 1) / kAskedContacts;
  ObjectForces forces;
  glm::dvec3 force_n{0};  // of the run
  glm::dvec3 left_n = stop.pull_n;
  std::uint32_t in_run = 0, deepest = 0, seen = 0;
  for (std::uint32_t i = 0; i < set.count && seen < totals.count; ++i) {
    if (!(set.depth_m[i] > 0)) continue;
    const field::Contact contact = set[i];
    for (const ContactLaw& law : laws) {
      force_n += law.stiffness_n_per_m * law.areas_of(contact) *
                 std::max(0.0, law.force_m(contact)) * glm::dvec3(contact.direction);
    }
    if (set.seat_open && set.of_seat[i] != 0) ++report.seat_contacts;
    if (in_run == 0 || set.depth_m[i] > set.depth_m[deepest]) deepest = i;
    ++seen, ++in_run;
    if (in_run < run && seen < totals.count) continue;
    const std::uint32_t object =
        probe.object_near(report.world_from_center.position_m + glm::dvec3(set[deepest].arm_m));
    if (object != 0) forces.add(object, force_n);
    left_n += force_n;
    force_n = {};
    in_run = 0;
  }
  if (stop.object != 0 && glm::length(left_n) > kNoticedN) forces.add(stop.object, -left_n);
  forces.strongest(report);
}

}  // namespace forcelayer::model
