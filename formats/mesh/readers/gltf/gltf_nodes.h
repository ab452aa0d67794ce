// The node tree of a glTF asset: which mesh stands where, under which name.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/mesh/node_names.h"
#include "formats/mesh/readers/gltf/gltf_document.h"

namespace forcelayer::mesh {

// One placing of a glTF mesh.
struct GltfPlacing {
  std::uint64_t mesh;  // glTF index
  std::string path;    // of node labels, "/" between
  std::size_t node;    // index into GltfNodes::tree()
  Affine assembly_from_mesh;
  std::vector<double> weights;  // of the mesh's morph targets; those that are missing are 0
};

// Walks the default scene of `document`. A label is the node's name, else its mesh's, else "node7".
// Sub-trees keep their place in the assembly. ReadOptions::nodes and ::without are obeyed.
class GltfNodes {
 public:
  explicit GltfNodes(const GltfDocument& document);  // throws ReadFailure

  std::vector<GltfPlacing> placings() const;
  std::vector<AssemblyNode> tree() const;  // all nodes; no instances yet
  const std::vector<std::string>& left_out() const { return left_out_; }  // Assembly::left_out
  void add_warnings(std::vector<std::string>& warnings) const;

 private:
  struct Node {
    std::uint64_t index;  // glTF's
    AssemblyNode name;
    Affine assembly_from_node;
  };

  std::vector<bool> find_children() const;
  std::vector<std::uint64_t> roots() const;
  std::vector<std::uint64_t> indices(const nlohmann::json& object, const char* key) const;
  void walk();
  std::vector<Node> siblings(const std::vector<std::uint64_t>& indices, const Node* parent);
  std::string name_of(std::uint64_t index) const;
  void choose();
  std::uint64_t count_hidden() const;
  std::vector<Affine> instancing_of(const nlohmann::json& node) const;
  std::vector<double> weights_of(const nlohmann::json& node) const;
  Affine placing_of_skin(std::uint64_t index,
                         const std::map<std::uint64_t, std::size_t>& node_of) const;

  const GltfDocument& document_;
  NodeTreeLimit limit_;
  std::vector<Node> nodes_;    // each before its children
  std::vector<bool> is_read_;  // [nodes]
  std::vector<std::string> left_out_;
};

}  // namespace forcelayer::mesh
