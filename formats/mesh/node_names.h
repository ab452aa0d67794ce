// Names in the node trees of assembly formats: labels, paths, and how a user names nodes.
//
// A name is a path, or the end of one where no other path ends alike: "Cover", "Housing/Cover". `*`
// stands for any letters but "/", `?` for one; a name with either may fit several nodes.
// "{Cover,Bolt*}" is a list of names. A node that bears such letters itself is found by its own
// name first. The second sibling of a name is "Bolt[2]"; the first one is "Bolt", and may be named
// "Bolt[1]".
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/result.h"

namespace forcelayer::mesh {

// Bounds the tree of a file's nodes. A small file can hold an assembly many times in one that it
// holds many times, and a long name in the paths of all nodes below it.
class NodeTreeLimit {
 public:
  static constexpr std::size_t kDeepestNode = 1000;
  // Bytes that a tree may take: always, and for each byte of its files; and those of a node without
  // its path.
  static constexpr std::uint64_t kAlways = 64'000'000, kPerByte = 32, kOfNode = 200;

  static constexpr const char* kTooMuch =
      "has too large a tree of nodes for a file of this size: nested assemblies are repeated too "
      "often, or names are too long";

  // Whether so many nodes can be in a file of this size.
  static bool takes(double nodes, std::uint64_t file_bytes) {
    return kOfNode * nodes <= static_cast<double>(kAlways + kPerByte * file_bytes);
  }

  void allow_for(std::uint64_t file_bytes) { left_ += kPerByte * file_bytes; }

  // Takes a node in. What is wrong with the tree with it; empty where nothing is.
  std::string add(const AssemblyNode& node);

 private:
  std::uint64_t left_ = kAlways;
};

// The labels of siblings. With each the highest number that a node called so has, for its label.
using UsedLabels = std::map<std::string, std::uint64_t>;

// The name of a node called `name` under `parent` (null for roots), whose earlier children bear the
// labels `used`: "name", else "name[2]", "name[3]".
AssemblyNode name_node(const std::string& name, const AssemblyNode* parent, UsedLabels& used);

// [nodes] Their paths for a listing: the first of siblings that are called alike is "Bolt[1]", so
// that each path can be typed. In `nodes` each stands before its children.
std::vector<std::string> numbered_paths(std::span<const AssemblyNode> nodes);

// Whether a node of this path is called `name`, as it stands.
bool bears_name(const std::string& path, const std::string& name);

// Whether a node of this path is meant by `name`, which is no list.
bool fits_name(const std::string& path, const std::string& name);

// [nodes] Whether each of `nodes` is meant by one of `names`, or is below such a one. All are where
// there are no names. In `nodes` each stands before its children. kSceneInvalid where a name fits
// no node, with the nearest names, or several and has no wildcard.
Result<std::vector<bool>> choose_nodes(std::span<const std::string> names,
                                       std::span<const AssemblyNode> nodes);

// The nodes of a file that its options ask for.
struct NodesToRead {
  std::vector<bool> is_read;          // [nodes]
  std::vector<bool> is_left_out;      // [nodes] by ReadOptions::without
  std::vector<std::string> left_out;  // names of ReadOptions::without that name a node
  std::vector<std::string> unknown;   // and the others
};

// Obeys ReadOptions::nodes and ::without. Throws ReadFailure as choose_nodes() fails, and where a
// name means "Bolt" and nothing says what becomes of "Bolt[2]": the user may know both by one name.
// A name of ::without that fits no node is no failure here.
NodesToRead nodes_to_read(const SourceFile& file, std::span<const AssemblyNode> nodes);

// Sets the instances of `nodes`. [instances] `nodes_of_instances`: the node of each, ascending.
void set_instances(std::span<const std::size_t> nodes_of_instances, std::span<AssemblyNode> nodes);

// An error where a name of `without` is neither in the list `left_out` of an assembly nor one of
// the `parts` of a manifest that are left out. It names the nearest, of `other_parts` too.
Status check_left_out(std::span<const std::string> without, std::span<const Assembly> assemblies,
                      const std::set<std::string>& parts = {},
                      std::span<const std::string> other_parts = {});

// The names of "{A,B}", else `name` alone; that too where something bears the list as its name.
std::vector<std::string> names_in(const std::string& name, bool is_borne = false);

}  // namespace forcelayer::mesh
