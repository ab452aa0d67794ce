#include "workbench/disassembly/part_shapes.h"

#include <algorithm>
#include <cmath>

#include "workbench/exact/mesh_distance.h"

namespace forcelayer::disassembly {

PartShapes::PartShapes(const pairs::AssemblyParts& assembly, double required_m,
                       std::span<const pairs::Rule> rules)
    : assembly_(assembly),
      rules_(rules),
      names_(assembly.names()),
      table_(rules_, names_),
      required_m_(required_m),
      max_required_m_(required_m),
      all_m_(mesh::empty_box()) {
  for (const pairs::Rule& rule : rules) {
    max_required_m_ = std::max(max_required_m_, rule.requirement.clearance_m);
  }
  for (const pairs::AssemblyPart& part : assembly.parts) {
    mesh::extend(all_m_, part.box_m);
    own_.emplace_back();
  }
  // The largest coordinate in any computation, at the end of a path that leads past all parts too.
  double largest_m = 0, size_m = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    largest_m = std::max({largest_m, std::abs(all_m_.low[axis]), std::abs(all_m_.high[axis])});
    size_m = std::max(size_m, all_m_.high[axis] - all_m_.low[axis]);
  }
  rounding_m_ = exact::kRounding * (largest_m + 2 * size_m + max_required_m_);
}

const pairs::Shape& PartShapes::in_world(std::size_t part) const {
  Own& own = own_[part];
  std::call_once(own.world_once, [&] {
    const pairs::AssemblyPart& p = assembly_.parts[part];
    own.world =
        std::make_unique<const pairs::Shape>(pairs::surface_of(assembly_.scene, p), p.box_m);
  });
  return *own.world;
}

const PartShapes::Centered& PartShapes::centered(std::size_t part) const {
  Own& own = own_[part];
  std::call_once(own.centered_once, [&] {
    const pairs::AssemblyPart& p = assembly_.parts[part];
    exact::Surface surface = pairs::surface_of(assembly_.scene, p);
    mesh::Box box_m = p.box_m;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double middle_m = (box_m.low[axis] + box_m.high[axis]) / 2;
      own.centered.center_m[static_cast<int>(axis)] = middle_m;
      box_m.low[axis] -= middle_m, box_m.high[axis] -= middle_m;
    }
    for (glm::dvec3& vertex : surface.vertices_m) vertex -= own.centered.center_m;
    own.centered.shape = std::make_unique<const pairs::Shape>(std::move(surface), box_m);
  });
  return own.centered;
}

PairRule PartShapes::rule(std::size_t part, std::size_t object) const {
  PairRule rule{required_m_, rounding_m_,
                assembly_.parts[part].deviation_m + assembly_.parts[object].deviation_m};
  const std::size_t row = table_.first_rule(part, object);
  if (row == rules_.size()) return rule;
  rule.required_m = rules_[row].requirement.clearance_m;
  rule.is_ignored = rules_[row].requirement.kind == pairs::Requirement::Kind::kIgnore;
  return rule;
}

double PartShapes::max_end_gap_m() const {
  double deviation_m = 0;
  for (const pairs::AssemblyPart& part : assembly_.parts) {
    deviation_m = std::max(deviation_m, part.deviation_m);
  }
  return end_gap_m({max_required_m_, rounding_m_, 2 * deviation_m});
}

const Installed& PartShapes::installed(std::size_t part, std::size_t object) const {
  const std::pair key = std::minmax(part, object);
  {
    const std::lock_guard lock(installed_lock_);
    if (const auto known = installed_.find(key); known != installed_.end()) return known->second;
  }
  const Installed measured =
      measure_installed(in_world(key.first), in_world(key.second), rule(part, object));
  const std::lock_guard lock(installed_lock_);
  return installed_.try_emplace(key, measured).first->second;
}

}  // namespace forcelayer::disassembly
