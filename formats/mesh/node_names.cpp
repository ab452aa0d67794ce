#include "formats/mesh/node_names.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <string_view>

namespace forcelayer::mesh {
namespace {

[[noreturn]] void fail_ambiguous(const SourceFile& file, const std::string& where,
                                 const std::vector<NodeName>& nodes,
                                 const std::vector<std::size_t>& found) {
  constexpr std::size_t kListed = 8;
  const std::size_t choices = found.empty() ? nodes.size() : found.size();
  std::string list;
  for (std::size_t i = 0; i < std::min(choices, kListed); ++i) {
    list += (i == 0 ? "" : ", ") + nodes[found.empty() ? i : found[i]].path;
  }
  if (choices > kListed) list += ", ...";
  fail_read(file, ErrorCode::kSceneInvalid, where,
            found.empty() ? "no node of this name" : "several nodes of this name",
            "use one of: " + list);
}

// The node of this path, else all nodes of this label.
std::vector<std::size_t> nodes_of(const std::string& name, const std::vector<NodeName>& nodes) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].path == name) return {i};
    if (nodes[i].label == name) found.push_back(i);
  }
  return found;
}

// The node behind the last of those below `first`.
std::size_t end_of_sub_tree(std::size_t first, const std::vector<NodeName>& nodes) {
  std::size_t last = first + 1;
  while (last < nodes.size() && nodes[last].depth > nodes[first].depth) ++last;
  return last;
}

// How many letters must be put in, taken out or changed to make one of the other (Levenshtein).
std::size_t spelling_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

NodeName name_node(const std::string& name, const NodeName* parent, std::set<std::string>& used) {
  std::string label = name;
  for (int number = 2; !used.insert(label).second; ++number) {
    label = name + ":" + std::to_string(number);
  }
  if (parent == nullptr) return {label, label, 0};
  return {label, parent->path + "/" + label, parent->depth + 1};
}

std::pair<std::size_t, std::size_t> find_sub_tree(const SourceFile& file,
                                                  const std::vector<NodeName>& nodes) {
  if (file.node.empty()) return {0, nodes.size()};
  const std::vector<std::size_t> found = nodes_of(file.node, nodes);
  if (found.size() != 1) fail_ambiguous(file, "#" + file.node, nodes, found);
  return {found[0], end_of_sub_tree(found[0], nodes)};
}

LeftOutNodes find_left_out(const SourceFile& file, const std::vector<NodeName>& nodes) {
  LeftOutNodes left_out{std::vector<bool>(nodes.size()), {}, {}};
  for (const std::string& name : file.options.without) {
    const std::vector<std::size_t> found = nodes_of(name, nodes);
    if (found.size() > 1) fail_ambiguous(file, "--without " + name, nodes, found);
    (found.empty() ? left_out.unknown : left_out.names).push_back(name);
    if (found.empty()) continue;
    const std::size_t last = end_of_sub_tree(found[0], nodes);
    for (std::size_t i = found[0]; i < last; ++i) left_out.is_out[i] = true;
  }
  return left_out;
}

std::string nearest_names_text(const std::string& name, const std::vector<std::string>& paths) {
  constexpr std::size_t kListed = 5;
  std::set<std::pair<std::size_t, std::string>> nearest;
  for (std::string path : paths) {
    while (!path.empty()) {  // the node, then those above it
      const auto slash = path.rfind('/');
      const std::string label = slash == std::string::npos ? path : path.substr(slash + 1);
      nearest.emplace(std::min(spelling_distance(name, path), spelling_distance(name, label)),
                      path);
      if (nearest.size() > kListed) nearest.erase(std::prev(nearest.end()));
      path.resize(slash == std::string::npos ? 0 : slash);
    }
  }
  std::string text;
  for (const auto& [distance, path] : nearest) {
    text += (text.empty() ? "the nearest are: " : ", ") + path;
  }
  return text;
}

}  // namespace forcelayer::mesh
