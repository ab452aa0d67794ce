#include "formats/mesh/node_names.h"

#include <algorithm>

namespace forcelayer::mesh {
namespace {

[[noreturn]] void fail_ambiguous(const SourceFile& file, const std::vector<NodeName>& nodes,
                                 const std::vector<std::size_t>& found) {
  constexpr std::size_t kListed = 8;
  const std::size_t choices = found.empty() ? nodes.size() : found.size();
  std::string list;
  for (std::size_t i = 0; i < std::min(choices, kListed); ++i) {
    list += (i == 0 ? "" : ", ") + nodes[found.empty() ? i : found[i]].path;
  }
  if (choices > kListed) list += ", ...";
  fail_read(file, ErrorCode::kSceneInvalid, "#" + file.node,
            found.empty() ? "no node of this name" : "several nodes of this name",
            "use one of: " + list);
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
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].path == file.node) {
      found = {i};
      break;
    }
    if (nodes[i].label == file.node) found.push_back(i);
  }
  if (found.size() != 1) fail_ambiguous(file, nodes, found);
  std::size_t last = found[0] + 1;
  while (last < nodes.size() && nodes[last].depth > nodes[found[0]].depth) ++last;
  return {found[0], last};
}

}  // namespace forcelayer::mesh
