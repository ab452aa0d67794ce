#include "workbench/disassembly/blocking_graph.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <utility>

namespace forcelayer::disassembly {
namespace {

// Tarjan's strongly connected components, without recursion: an assembly may have thousands of
// parts in a row.
class Components {
 public:
  explicit Components(const std::vector<Parts>& edges)
      : edges_(edges), index_(edges.size(), kNew), low_(edges.size()), of_(edges.size(), kNew) {
    for (std::size_t node = 0; node < edges.size(); ++node) {
      if (index_[node] == kNew) visit(node);
    }
  }

  std::size_t count() const { return count_; }
  std::size_t of(std::size_t node) const { return of_[node]; }

 private:
  static constexpr std::size_t kNew = std::numeric_limits<std::size_t>::max();

  void open(std::size_t node) {
    index_[node] = low_[node] = next_++;
    stack_.push_back(node);
    calls_.push_back({node, 0});
  }

  void visit(std::size_t root) {
    open(root);
    while (!calls_.empty()) {
      auto& [node, edge] = calls_.back();
      if (edge < edges_[node].size()) {
        const std::size_t to = edges_[node][edge++];
        if (index_[to] == kNew) {
          open(to);
        } else if (of_[to] == kNew) {
          low_[node] = std::min(low_[node], index_[to]);
        }
        continue;
      }
      close(node);
    }
  }

  void close(std::size_t node) {
    if (low_[node] == index_[node]) {
      std::size_t member;
      do {
        member = stack_.back();
        stack_.pop_back();
        of_[member] = count_;
      } while (member != node);
      ++count_;
    }
    const std::size_t low = low_[node];
    calls_.pop_back();
    if (!calls_.empty()) low_[calls_.back().first] = std::min(low_[calls_.back().first], low);
  }

  const std::vector<Parts>& edges_;
  std::vector<std::size_t> index_, low_, of_, stack_;
  std::vector<std::pair<std::size_t, std::size_t>> calls_;  // node, next edge
  std::size_t next_ = 0, count_ = 0;
};

constexpr double kNever = std::numeric_limits<double>::infinity();

class RemovalPlan {
 public:
  RemovalPlan(std::size_t parts, std::size_t target,
              const std::function<std::vector<BlockedMotion>(std::size_t)>& motions_of)
      : parts_(parts), target_(target), motions_of_(motions_of) {}

  std::optional<std::vector<Removal>> find() {
    while (true) {
      find_costs();
      if (cost_[target_] == kNever) return std::nullopt;
      Parts chosen = chosen_parts(), unknown;
      std::copy_if(chosen.begin(), chosen.end(), std::back_inserter(unknown),
                   [&](std::size_t part) { return !motions_.contains(part); });
      if (unknown.empty()) return reduced(std::move(chosen));
      for (const std::size_t part : unknown) motions_.emplace(part, motions_of_(part));
    }
  }

 private:
  // The cost of a part is one more than that of all its blockers, along its cheapest direction. A
  // part whose motions are not known costs as little as it can, so that it is asked for where that
  // may be of use.
  void find_costs() {
    cost_.assign(parts_, 1);
    for (const auto& [part, motions] : motions_) cost_[part] = kNever;
    if (!motions_.contains(target_)) return;
    for (bool changes = true; changes;) {
      changes = false;
      for (const auto& [part, motions] : motions_) {
        for (const BlockedMotion& motion : motions) {
          double cost = 1;
          for (const std::size_t blocker : motion.blockers) cost += cost_[blocker];
          if (cost >= cost_[part]) continue;
          cost_[part] = cost;
          best_[part] = &motion;
          changes = true;
        }
      }
    }
  }

  Parts chosen_parts() const {
    Parts chosen{target_}, open{target_};
    while (!open.empty()) {
      const std::size_t part = open.back();
      open.pop_back();
      const auto known = best_.find(part);
      if (known == best_.end() || !motions_.contains(part)) continue;
      for (const std::size_t blocker : known->second->blockers) {
        if (contains(chosen, blocker)) continue;
        chosen.insert(std::lower_bound(chosen.begin(), chosen.end(), blocker), blocker);
        open.push_back(blocker);
      }
    }
    return chosen;
  }

  // An order of some parts in which each is free, up to the target; none where there is none.
  std::optional<std::vector<Removal>> order_of(const Parts& chosen) const {
    std::vector<Removal> order;
    Parts open = chosen, gone;
    while (contains(open, target_)) {
      std::vector<Removal> now;
      for (const std::size_t part : open) {
        for (const BlockedMotion& motion : motions_.at(part)) {
          if (!std::includes(gone.begin(), gone.end(), motion.blockers.begin(),
                             motion.blockers.end())) {
            continue;
          }
          now.push_back({part, motion.direction});
          break;
        }
      }
      if (now.empty()) return std::nullopt;
      // The target leaves as soon as it can, and nothing behind it.
      const auto own =
          std::find_if(now.begin(), now.end(), [&](const Removal& r) { return r.part == target_; });
      if (own != now.end()) now = {*own};
      for (const Removal& removal : now) {
        order.push_back(removal);
        gone.insert(std::lower_bound(gone.begin(), gone.end(), removal.part), removal.part);
        std::erase(open, removal.part);
      }
    }
    return order;
  }

  std::optional<std::vector<Removal>> reduced(Parts chosen) const {
    auto order = order_of(chosen);
    for (std::size_t n = 0; order && n < chosen.size();) {
      Parts fewer = chosen;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(n));
      const auto other = chosen[n] == target_ ? std::nullopt : order_of(fewer);
      if (!other) {
        ++n;
        continue;
      }
      chosen = std::move(fewer);
      order = other;
    }
    return order;
  }

  std::size_t parts_, target_;
  const std::function<std::vector<BlockedMotion>(std::size_t)>& motions_of_;
  std::map<std::size_t, std::vector<BlockedMotion>> motions_;
  std::map<std::size_t, const BlockedMotion*> best_;
  std::vector<double> cost_;  // [parts]
};

}  // namespace

Parts without(const Parts& parts, const Parts& removed) {
  Parts left;
  std::set_difference(parts.begin(), parts.end(), removed.begin(), removed.end(),
                      std::back_inserter(left));
  return left;
}

bool contains(const Parts& parts, std::size_t part) {
  return std::binary_search(parts.begin(), parts.end(), part);
}

std::vector<Parts> closed_groups(const std::vector<Parts>& blockers) {
  const Components components(blockers);
  std::vector<bool> is_closed(components.count(), true);
  std::map<std::size_t, Parts> members;
  std::vector<std::size_t> order;
  for (std::size_t node = 0; node < blockers.size(); ++node) {
    const std::size_t own = components.of(node);
    if (members[own].empty()) order.push_back(own);
    members[own].push_back(node);
    for (const std::size_t to : blockers[node]) {
      if (components.of(to) != own) is_closed[own] = false;
    }
  }
  std::vector<Parts> groups;
  for (const std::size_t component : order) {
    if (is_closed[component]) groups.push_back(members[component]);
  }
  return groups;
}

std::optional<std::vector<Removal>> fewest_removals(
    std::size_t parts, std::size_t target,
    const std::function<std::vector<BlockedMotion>(std::size_t part)>& motions_of) {
  return RemovalPlan(parts, target, motions_of).find();
}

}  // namespace forcelayer::disassembly
