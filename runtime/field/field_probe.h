// The default model's view of a baked scene: contact query and force field in one look-up.
#pragma once

#include <vector>

#include "runtime/field/contact_set.h"
#include "runtime/field/force_field.h"
#include "runtime/query/contact_query.h"

namespace forcelayer {

class FieldProbe final : public ContactProbe {
 public:
  // All must outlive the probe; `points` and `samples` have room for every shell point.
  FieldProbe(ContactQuery& query, const ForceField& field, CollectedPoints& points,
             FieldSamples& samples);

  void look_up(const Pose& world_from_center, ContactSet& out) noexcept override;
  // The half of it after the query: depth and direction of the points that it collected.
  void read(ContactSet& out) noexcept;

 private:
  ContactQuery& query_;
  const ForceField& field_;
  CollectedPoints& points_;
  FieldSamples& samples_;
  std::vector<float> weight_;  // of every shell point, as Contact has it
};

}  // namespace forcelayer
