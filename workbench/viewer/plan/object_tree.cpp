#include "workbench/viewer/plan/object_tree.h"

#include <algorithm>

namespace forcelayer::viewer {

ObjectTree::ObjectTree(const std::vector<std::string>& names)
    : names_(names), shown_(names.size(), 1) {
  for (std::size_t object = 0; object < names.size(); ++object) {
    std::string_view rest = names[object];
    for (std::size_t node = kNone;;) {
      const std::size_t slash = rest.find('/');
      node = child_of(node, rest.substr(0, slash));
      nodes_[node].objects.push_back(object);
      if (slash == std::string_view::npos) {
        leaves_.push_back(node);
        break;
      }
      rest.remove_prefix(slash + 1);
    }
  }
}

std::size_t ObjectTree::child_of(std::size_t parent, std::string_view label) {
  const auto& siblings = parent == kNone ? roots_ : nodes_[parent].children;
  for (const std::size_t node : siblings) {
    if (nodes_[node].label == label) return node;
  }
  const std::size_t node = nodes_.size();
  nodes_.push_back(
      {std::string(label), parent, parent == kNone ? 0 : nodes_[parent].depth + 1, {}, {}});
  (parent == kNone ? roots_ : nodes_[parent].children).push_back(node);
  return node;
}

std::vector<std::string> ObjectTree::hidden() const {
  std::vector<std::string> names;
  for (std::size_t n = 0; n < shown_.size(); ++n) {
    if (shown_[n] == 0) names.push_back(names_[n]);
  }
  return names;
}

ObjectTree::Shown ObjectTree::shown_of(const Node& node) const {
  const auto count = static_cast<std::size_t>(
      std::count_if(node.objects.begin(), node.objects.end(),
                    [&](std::size_t object) { return shown_[object] != 0; }));
  return count == 0 ? Shown::kNone : count == node.objects.size() ? Shown::kAll : Shown::kSome;
}

void ObjectTree::add_rows(const std::vector<std::size_t>& nodes, std::vector<Row>& rows) const {
  for (const std::size_t n : nodes) {
    const Node& node = nodes_[n];
    rows.push_back({n, node.label, node.depth, !node.children.empty(), node.is_open, shown_of(node),
                    node.objects.size(), node.objects.front()});
    if (node.is_open) add_rows(node.children, rows);
  }
}

std::vector<ObjectTree::Row> ObjectTree::rows() const {
  std::vector<Row> rows;
  add_rows(roots_, rows);
  return rows;
}

void ObjectTree::select(std::size_t node) {
  if (node < nodes_.size()) selected_ = node;
}

void ObjectTree::select_object(std::string_view name) {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return;
  selected_ = leaves_[static_cast<std::size_t>(found - names_.begin())];
  for (std::size_t n = nodes_[selected_].parent; n != kNone; n = nodes_[n].parent) {
    nodes_[n].is_open = true;
  }
}

void ObjectTree::step(int by) {
  const std::vector<Row> all = rows();
  if (all.empty()) return;
  const auto at =
      std::find_if(all.begin(), all.end(), [&](const Row& row) { return row.node == selected_; });
  const auto row = static_cast<int>(at == all.end() ? 0 : at - all.begin()) + by;
  selected_ =
      all[static_cast<std::size_t>(std::clamp(row, 0, static_cast<int>(all.size()) - 1))].node;
}

void ObjectTree::fold() {
  if (!nodes_.empty()) nodes_[selected_].is_open = !nodes_[selected_].is_open;
}

void ObjectTree::toggle() {
  if (nodes_.empty()) return;
  const char shown = shown_of(nodes_[selected_]) == Shown::kAll ? 0 : 1;
  for (const std::size_t object : nodes_[selected_].objects) shown_[object] = shown;
}

void ObjectTree::isolate() {
  if (nodes_.empty()) return;
  std::vector<char> alone(shown_.size(), 0);
  for (const std::size_t object : nodes_[selected_].objects) alone[object] = 1;
  if (alone == shown_) alone.assign(shown_.size(), 1);
  shown_ = std::move(alone);
}

void ObjectTree::hide(const std::vector<std::string>& names) {
  for (std::size_t n = 0; n < shown_.size(); ++n) {
    shown_[n] = std::find(names.begin(), names.end(), names_[n]) == names.end() ? 1 : 0;
  }
}

void ObjectTree::show_all() { shown_.assign(shown_.size(), 1); }

}  // namespace forcelayer::viewer
