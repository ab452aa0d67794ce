// Names in the node trees of assembly formats: labels, paths, and the sub-tree behind "#NODE".
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

struct NodeName {
  std::string label;  // unique among its siblings
  std::string path;   // labels from the root on, "/" between
  std::size_t depth;  // 0 for roots
};

// A deeper tree is damage; the memory of its paths would grow with the square of the depth.
inline constexpr std::size_t kDeepestNode = 1000;

// The name of a node called `name` under `parent` (null for roots), whose earlier children bear the
// labels `used`: "name", else "name:2", "name:3".
NodeName name_node(const std::string& name, const NodeName* parent, std::set<std::string>& used);

// First and last (exclusive) node of the sub-tree that `file.node` names: by its path, or by its
// label where only one node has that label. All nodes where `file.node` is empty. In `nodes` each
// stands before its children. Throws kSceneInvalid, with a list of nodes, where none or several
// fit.
std::pair<std::size_t, std::size_t> find_sub_tree(const SourceFile& file,
                                                  const std::vector<NodeName>& nodes);

// What `file.options.without` leaves out of a tree.
struct LeftOutNodes {
  std::vector<bool> is_out;        // [nodes]
  std::vector<std::string> names;  // those that name a node
  std::vector<std::string> unknown;
};

// The nodes that `file.options.without` names, as find_sub_tree() does, with all below them. Throws
// kSceneInvalid where several nodes fit; a name that fits none is listed as unknown.
LeftOutNodes find_left_out(const SourceFile& file, const std::vector<NodeName>& nodes);

// "the nearest are: a/b, a/c": the names of `paths`, and of the nodes above them, that are spelled
// most like `name`. Empty where there are none.
std::string nearest_names_text(const std::string& name, const std::vector<std::string>& paths);

}  // namespace forcelayer::mesh
