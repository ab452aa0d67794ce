// The shapes of an assembly's parts, each made at its first use, and how pairs of them are
// installed, each measured once. For many threads at a time.
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "workbench/disassembly/pair_proof.h"
#include "workbench/pairs/assembly_parts.h"

namespace forcelayer::disassembly {

class PartShapes {
 public:
  // `assembly` and `rules` outlive this. `required_m`: the clearance of pairs that no rule names.
  PartShapes(const pairs::AssemblyParts& assembly, double required_m,
             std::span<const pairs::Rule> rules = {});

  std::size_t size() const { return assembly_.parts.size(); }
  const mesh::Box& box_m(std::size_t part) const { return assembly_.parts[part].box_m; }
  const mesh::Box& box_of_all_m() const { return all_m_; }

  exact::Surface surface(std::size_t part) const {  // in the world
    return pairs::surface_of(assembly_.scene, assembly_.parts[part]);
  }

  // In the world. Its center frame is the world's: for motions that do not turn.
  const pairs::Shape& in_world(std::size_t part) const;
  // About the middle of its box, for motions that turn.
  struct Centered {
    std::unique_ptr<const pairs::Shape> shape;
    glm::dvec3 center_m{0};  // world
  };
  const Centered& centered(std::size_t part) const;

  PairRule rule(std::size_t part, std::size_t object) const;
  // end_gap_m() of the rule that asks for most.
  double max_end_gap_m() const;
  const Installed& installed(std::size_t part, std::size_t object) const;

 private:
  struct Own {
    std::once_flag world_once, centered_once;
    std::unique_ptr<const pairs::Shape> world;
    Centered centered;
  };

  const pairs::AssemblyParts& assembly_;
  std::span<const pairs::Rule> rules_;
  std::vector<pairs::PartName> names_;
  pairs::RuleTable table_;
  double required_m_, max_required_m_, rounding_m_ = 0;
  mesh::Box all_m_;
  mutable std::deque<Own> own_;  // [parts]
  mutable std::mutex installed_lock_;
  mutable std::map<std::pair<std::size_t, std::size_t>, Installed> installed_;  // the lower first
};

}  // namespace forcelayer::disassembly
