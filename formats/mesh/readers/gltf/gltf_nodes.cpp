#include "formats/mesh/readers/gltf/gltf_nodes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "formats/mesh/checks/grouped_warnings.h"

namespace forcelayer::mesh {
namespace {

std::string in_nodes(std::uint64_t index) { return "nodes[" + std::to_string(index) + "]"; }

// A list of exactly `values.size()` numbers under `key`; leaves `values` where there is none.
template <std::size_t kCount>
void read_numbers(const GltfDocument& document, const nlohmann::json& node, std::uint64_t index,
                  const char* key, std::array<double, kCount>& values) {
  const auto found = node.find(key);
  if (found == node.end()) return;
  if (found->size() != kCount) {
    document.fail(ErrorCode::kMeshUnreadable, in_nodes(index),
                  std::string(key) + " does not have " + std::to_string(kCount) + " numbers");
  }
  for (std::size_t i = 0; i < kCount; ++i) values[i] = found->at(i).get<double>();
}

Affine from_matrix(const std::array<double, 16>& m) {  // column-major
  return {{m[0], m[4], m[8], m[1], m[5], m[9], m[2], m[6], m[10]}, {m[12], m[13], m[14]}};
}

// Translation * rotation (x, y, z, w; normalized here) * scale.
Affine from_parts(const Vec3d& translation, const std::array<double, 4>& rotation_xyzw,
                  const Vec3d& scale) {
  auto [x, y, z, w] = rotation_xyzw;
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  x /= length, y /= length, z /= length, w /= length;
  Affine affine{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
                 2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
                 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
                translation};
  for (std::size_t i = 0; i < 9; ++i) affine.linear[i] *= scale[i % 3];
  return affine;
}

// Whether both are equal but for the rounding of matrices of 32-bit floats; `largest` is that of
// the sums in the translations.
bool is_near(const Affine& a, const Affine& b, double largest) {
  constexpr double kRounding = 4e-6;
  double longest = 0, off = 0, moved = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    longest = std::max(longest, std::abs(a.linear[i]));
    off = std::max(off, std::abs(a.linear[i] - b.linear[i]));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    moved = std::max(moved, std::abs(a.translation[i] - b.translation[i]));
  }
  return off <= kRounding * longest && moved <= kRounding * largest;
}

bool is_finite(const Affine& affine) {
  const auto finite = [](double number) { return std::isfinite(number); };
  return std::all_of(affine.linear.begin(), affine.linear.end(), finite) &&
         std::all_of(affine.translation.begin(), affine.translation.end(), finite);
}

// A transform of a node, which is finite.
Affine checked(const GltfDocument& document, std::uint64_t index, const Affine& affine) {
  if (!is_finite(affine)) {
    document.fail(ErrorCode::kMeshUnreadable, in_nodes(index),
                  "has a transform that is not finite");
  }
  return affine;
}

Affine parent_from_node(const GltfDocument& document, std::uint64_t index) {
  const nlohmann::json& node = document.element("nodes", index);
  std::array<double, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  Vec3d translation{0, 0, 0}, scale{1, 1, 1};
  std::array<double, 4> rotation{0, 0, 0, 1};
  read_numbers(document, node, index, "matrix", matrix);
  read_numbers(document, node, index, "translation", translation);
  read_numbers(document, node, index, "rotation", rotation);
  read_numbers(document, node, index, "scale", scale);
  if (matrix[3] != 0 || matrix[7] != 0 || matrix[11] != 0 || matrix[15] != 1) {
    document.fail(ErrorCode::kMeshUnreadable, in_nodes(index), "has a matrix that is not affine");
  }
  return checked(
      document, index,
      node.contains("matrix") ? from_matrix(matrix) : from_parts(translation, rotation, scale));
}

}  // namespace

GltfNodes::GltfNodes(const GltfDocument& document) : document_(document) {
  limit_.allow_for(document_.file().bytes.size());
  walk();
  choose();
}

std::vector<std::uint64_t> GltfNodes::indices(const nlohmann::json& object, const char* key) const {
  std::vector<std::uint64_t> found;
  const auto list = object.find(key);
  if (list == object.end()) return found;
  for (const auto& entry : *list) {
    found.push_back(document_.whole_number(entry, key));
    document_.element("nodes", found.back());
  }
  return found;
}

// Whether each node is the child of another. Throws where a node has two parents, so that a walk
// from the roots ends.
std::vector<bool> GltfNodes::find_children() const {
  std::vector<bool> is_child(document_.count("nodes"), false);
  for (std::uint64_t i = 0; i < is_child.size(); ++i) {
    for (const std::uint64_t child : indices(document_.element("nodes", i), "children")) {
      if (is_child[child]) {
        document_.fail(ErrorCode::kMeshUnreadable, in_nodes(child), "has two parents");
      }
      is_child[child] = true;
    }
  }
  return is_child;
}

std::vector<std::uint64_t> GltfNodes::roots() const {
  const std::vector<bool> is_child = find_children();
  std::vector<std::uint64_t> found;
  if (document_.count("scenes") == 0) {
    for (std::uint64_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) found.push_back(i);
    }
    return found;
  }
  const std::uint64_t scene = document_.index_or(document_.json(), "scene", 0);
  found = indices(document_.element("scenes", scene), "nodes");
  const std::set<std::uint64_t> distinct(found.begin(), found.end());
  for (const std::uint64_t root : found) {
    if (is_child[root] || distinct.size() != found.size()) {
      document_.fail(ErrorCode::kMeshUnreadable, "scenes[" + std::to_string(scene) + "]",
                     "names a node twice, or names a node that has a parent");
    }
  }
  return found;
}

std::string GltfNodes::name_of(std::uint64_t index) const {
  const nlohmann::json& node = document_.element("nodes", index);
  std::string name = node.value("name", "");
  if (name.empty() && node.contains("mesh")) {
    name = document_.element("meshes", document_.index(node, "mesh")).value("name", "");
  }
  return name.empty() ? "node" + std::to_string(index) : name;
}

// The nodes of one level, under labels of their own. `parent` is null for the roots.
std::vector<GltfNodes::Node> GltfNodes::siblings(const std::vector<std::uint64_t>& indices,
                                                 const Node* parent) {
  std::vector<Node> level;
  UsedLabels used;
  for (const std::uint64_t index : indices) {
    const Affine from_node = parent_from_node(document_, index);
    level.push_back(
        {index, name_node(name_of(index), parent == nullptr ? nullptr : &parent->name, used),
         parent == nullptr
             ? from_node
             : checked(document_, index, compose(parent->assembly_from_node, from_node))});
    if (const std::string wrong = limit_.add(level.back().name); !wrong.empty()) {
      document_.fail(ErrorCode::kMeshUnsupported, in_nodes(index), wrong);
    }
  }
  return level;
}

void GltfNodes::walk() {
  std::vector<Node> stack = siblings(roots(), nullptr);
  std::reverse(stack.begin(), stack.end());
  while (!stack.empty()) {
    nodes_.push_back(std::move(stack.back()));
    stack.pop_back();
    const Node& node = nodes_.back();
    std::vector<Node> children =
        siblings(indices(document_.element("nodes", node.index), "children"), &node);
    for (auto child = children.rbegin(); child != children.rend(); ++child) {
      stack.push_back(std::move(*child));
    }
  }
}

void GltfNodes::choose() {
  NodesToRead to_read = nodes_to_read(document_.file(), tree());
  is_read_ = std::move(to_read.is_read);
  left_out_ = std::move(to_read.left_out);
}

std::vector<AssemblyNode> GltfNodes::tree() const {
  std::vector<AssemblyNode> names;
  for (const Node& node : nodes_) names.push_back(node.name);
  return names;
}

// node_from_instance of EXT_mesh_gpu_instancing; the identity where the node has no such extension.
std::vector<Affine> GltfNodes::instancing_of(const nlohmann::json& node) const {
  constexpr const char* kExtension = "EXT_mesh_gpu_instancing";
  const auto extensions = node.find("extensions");
  if (extensions == node.end() || !extensions->contains(kExtension)) return {Affine{}};
  const nlohmann::json& attributes = extensions->at(kExtension).at("attributes");
  const auto read = [&](const char* key, std::uint64_t components) {
    if (!attributes.contains(key)) return std::vector<double>{};
    return document_.read_numbers(document_.index(attributes, key), components);
  };
  // Attributes of any name count the instances, also where none of them moves one.
  std::optional<std::uint64_t> count;
  for (const auto& [key, accessor] : attributes.items()) {
    const std::uint64_t own = document_.index(
        document_.element("accessors", document_.whole_number(accessor, kExtension)), "count");
    if (count.value_or(own) != own) {
      document_.fail(ErrorCode::kMeshUnreadable, kExtension,
                     "has attributes with different numbers of instances");
    }
    count = own;
  }
  if (!count) {
    document_.fail(ErrorCode::kMeshUnreadable, kExtension,
                   "has no attributes, so the number of instances is not known");
  }
  if (*count > document_.max_unfolded()) {
    document_.fail(ErrorCode::kMeshUnsupported, kExtension,
                   "has more than " + std::to_string(document_.max_unfolded()) + " instances");
  }
  const auto translations = read("TRANSLATION", 3), rotations = read("ROTATION", 4),
             scales = read("SCALE", 3);
  std::vector<Affine> instances;
  for (std::size_t i = 0; i < *count; ++i) {
    Vec3d translation{0, 0, 0}, scale{1, 1, 1};
    std::array<double, 4> rotation{0, 0, 0, 1};
    if (!translations.empty()) std::copy_n(&translations.at(3 * i), 3, translation.begin());
    if (!rotations.empty()) std::copy_n(&rotations.at(4 * i), 4, rotation.begin());
    if (!scales.empty()) std::copy_n(&scales.at(3 * i), 3, scale.begin());
    instances.push_back(from_parts(translation, rotation, scale));
    if (!is_finite(instances.back())) {
      document_.fail(ErrorCode::kMeshUnreadable, kExtension, "has a transform that is not finite");
    }
  }
  return instances;
}

// The weights of morph targets before any animation: the node's, else its mesh's.
std::vector<double> GltfNodes::weights_of(const nlohmann::json& node) const {
  const nlohmann::json& mesh = document_.element("meshes", document_.index(node, "mesh"));
  for (const nlohmann::json* const object : {&node, &mesh}) {
    const auto found = object->find("weights");
    if (found != object->end()) return found->get<std::vector<double>>();
  }
  return {};
}

// Where the joints of a skin put its mesh: the node's own transform counts for nothing (glTF 2.0,
// 3.7.3.3). At rest, as the mesh was bound, all joints put it to the same place. Another pose is
// refused.
Affine GltfNodes::placing_of_skin(std::uint64_t index,
                                  const std::map<std::uint64_t, std::size_t>& node_of) const {
  const std::string where = "skins[" + std::to_string(index) + "]";
  const nlohmann::json& skin = document_.element("skins", index);
  const std::vector<std::uint64_t> joints = indices(skin, "joints");
  std::vector<double> inverses;
  if (skin.contains("inverseBindMatrices")) {
    inverses = document_.read_numbers(document_.index(skin, "inverseBindMatrices"), 16);
  }
  if (joints.empty() || (!inverses.empty() && inverses.size() < 16 * joints.size())) {
    document_.fail(ErrorCode::kMeshUnreadable, where,
                   "has no joints, or fewer matrices than joints");
  }
  Affine placing;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const auto found = node_of.find(joints[j]);
    if (found == node_of.end()) {
      document_.fail(ErrorCode::kMeshUnsupported, where,
                     "has a joint that is not in the default scene");
    }
    std::array<double, 16> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    if (!inverses.empty()) std::copy_n(&inverses[16 * j], 16, matrix.begin());
    const Affine& joint = nodes_[found->second].assembly_from_node;
    const Affine from_mesh = compose(joint, from_matrix(matrix));
    if (j == 0) placing = from_mesh;
    if (!is_near(placing, from_mesh, largest_sum(joint, from_matrix(matrix).translation))) {
      document_.fail(ErrorCode::kMeshUnsupported, where,
                     "is posed: its joints are not where they were when the mesh was bound to them",
                     "apply the pose to the mesh, and export it without the skin");
    }
  }
  return placing;
}

std::vector<GltfPlacing> GltfNodes::placings() const {
  std::vector<GltfPlacing> placings;
  std::map<std::uint64_t, std::size_t> node_of;  // by glTF's index
  for (std::size_t n = 0; n < nodes_.size(); ++n) node_of[nodes_[n].index] = n;
  std::map<std::uint64_t, Affine> of_skin;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (!is_read_[n]) continue;
    const Node& node = nodes_[n];
    const nlohmann::json& json = document_.element("nodes", node.index);
    if (!json.contains("mesh")) continue;
    const std::uint64_t mesh = document_.index(json, "mesh");
    const std::vector<double> weights = weights_of(json);
    const std::vector<Affine> instances = instancing_of(json);
    if (placings.size() + instances.size() > document_.max_unfolded()) {
      document_.fail(ErrorCode::kMeshUnsupported, in_nodes(node.index),
                     "raises the number of the file's instances above " +
                         std::to_string(document_.max_unfolded()));
    }
    Affine from_mesh = node.assembly_from_node;
    if (json.contains("skin")) {
      const std::uint64_t skin = document_.index(json, "skin");
      auto known = of_skin.find(skin);
      if (known == of_skin.end()) {
        known = of_skin.emplace(skin, placing_of_skin(skin, node_of)).first;
      }
      from_mesh = known->second;
    }
    for (std::size_t i = 0; i < instances.size(); ++i) {
      const std::string path =
          instances.size() == 1 ? node.name.path : node.name.path + "/" + std::to_string(i);
      const Affine placing = compose(from_mesh, instances[i]);
      placings.push_back({mesh, path, n, checked(document_, node.index, placing), weights});
    }
  }
  return placings;
}

// Nodes with meshes that are read and that KHR_node_visibility hides, with all below them.
std::uint64_t GltfNodes::count_hidden() const {
  constexpr const char* kExtension = "KHR_node_visibility";
  std::uint64_t count = 0;
  std::size_t hidden_above = std::numeric_limits<std::size_t>::max();  // depth of that node
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const nlohmann::json& json = document_.element("nodes", nodes_[n].index);
    const std::size_t depth = nodes_[n].name.depth;
    if (depth <= hidden_above) {
      const auto extensions = json.find("extensions");
      const bool is_hidden = extensions != json.end() && extensions->contains(kExtension) &&
                             !extensions->at(kExtension).value("visible", true);
      hidden_above = is_hidden ? depth : std::numeric_limits<std::size_t>::max();
    }
    if (depth >= hidden_above && is_read_[n] && json.contains("mesh")) ++count;
  }
  return count;
}

void GltfNodes::add_warnings(std::vector<std::string>& warnings) const {
  GroupedWarnings odd("nodes");
  std::set<std::uint64_t> placed;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    if (!is_read_[n]) continue;
    const nlohmann::json& json = document_.element("nodes", nodes_[n].index);
    if (!json.contains("mesh")) continue;
    if (json.contains("skin")) {
      odd.add(nodes_[n].name.path,
              "the skin places the mesh in the bind pose, and the node's own transform is ignored");
    }
    const std::vector<Affine> instances = instancing_of(json);
    if (is_flat(nodes_[n].assembly_from_node) ||
        std::any_of(instances.begin(), instances.end(), is_flat)) {
      odd.add(nodes_[n].name.path,
              "a scale of 0 makes the mesh flat or a point; to leave the mesh out, use --without");
    }
    placed.insert(document_.index(json, "mesh"));
  }
  for (std::string& line : odd.lines()) warnings.push_back(std::move(line));
  if (const std::uint64_t hidden = count_hidden(); hidden > 0) {
    warnings.push_back(std::string("the file hides the ") + (hidden == 1 ? "mesh" : "meshes") +
                       " of " + counted(hidden, "node") + ", but hidden meshes are read, too");
  }
  const std::uint64_t left_out = document_.count("meshes") - placed.size();
  if (left_out > 0 && document_.file().options.nodes.empty() && left_out_.empty()) {
    warnings.push_back(std::to_string(left_out) + " of " +
                       std::to_string(document_.count("meshes")) +
                       " meshes are left out: no node of the default scene uses them");
  }
  std::uint64_t elsewhere = 0;
  for (std::uint64_t i = 0; i < document_.count("nodes"); ++i) {
    if (document_.element("nodes", i).contains("mesh")) ++elsewhere;
  }
  for (const auto& node : nodes_) {
    if (document_.element("nodes", node.index).contains("mesh")) --elsewhere;
  }
  if (elsewhere > 0 && left_out == 0) {
    warnings.push_back(
        counted(elsewhere, "node") + " with a mesh " + (elsewhere == 1 ? "is" : "are") +
        " left out: the default scene does not contain " + (elsewhere == 1 ? "it" : "them"));
  }
}

}  // namespace forcelayer::mesh
