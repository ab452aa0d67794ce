#include "formats/mesh/writers/glb.h"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "formats/command/command.h"
#include "formats/file/atomic_file.h"

namespace forcelayer::mesh {
namespace {

using Json = nlohmann::ordered_json;

// Numbers that glTF defines.
constexpr int kFloat = 5126, kUint8 = 5121, kUint16 = 5123, kUint32 = 5125;
constexpr int kVertices = 34962, kIndices = 34963;  // targets of buffer views
constexpr std::uint32_t kMagic = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBin = 0x004E4942;
constexpr std::size_t kLargest16 = 65534;  // 65535 is not an index

class Document {
 public:
  Document(Up up, const std::string& extras) {
    json_["asset"] = {{"version", "2.0"},
                      {"generator", std::string("Forcelayer ") + command::kVersion}};
    if (!extras.empty()) json_["asset"]["extras"] = Json::parse(extras);
    json_["scene"] = 0;
    json_["scenes"] = Json::array({Json::object({{"nodes", Json::array({0})}})});
    Json world{{"name", "world"}};
    constexpr double kHalf = 0.70710678118654752;
    if (up == Up::kZ) world["rotation"] = {-kHalf, 0, 0, kHalf};
    world["children"] = Json::array();
    json_["nodes"] = Json::array({world});
    for (const char* list : {"meshes", "materials", "animations", "accessors", "bufferViews"}) {
      json_[list] = Json::array();
    }
  }

  void add(const GlbNode& node) {
    const std::size_t n = json_["meshes"].size();
    std::array<float, 3> low = node.vertices_m.front(), high = low;
    for (const auto& vertex : node.vertices_m) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], vertex[axis]);
        high[axis] = std::max(high[axis], vertex[axis]);
      }
    }
    const std::size_t positions =
        add_accessor(add_view(std::as_bytes(std::span(node.vertices_m)), kVertices), kFloat,
                     node.vertices_m.size(), "VEC3");
    json_["accessors"][positions]["min"] = low;
    json_["accessors"][positions]["max"] = high;
    json_["materials"].push_back(
        Json::object({{"pbrMetallicRoughness",
                       {{"baseColorFactor", {node.color[0], node.color[1], node.color[2], 1}},
                        {"metallicFactor", 0},
                        {"roughnessFactor", 0.7}}},
                      {"doubleSided", true}}));
    Json primitive{{"attributes", {{"POSITION", positions}}}};
    if (!node.clearance_m.empty()) {
      primitive["attributes"]["_CLEARANCE_M"] =
          add_accessor(add_view(std::as_bytes(std::span(node.clearance_m)), kVertices), kFloat,
                       node.clearance_m.size(), "SCALAR");
    }
    if (!node.colors.empty()) {
      const std::size_t colors =
          add_accessor(add_view(std::as_bytes(std::span(node.colors)), kVertices), kUint8,
                       node.colors.size(), "VEC4");
      json_["accessors"][colors]["normalized"] = true;
      primitive["attributes"]["COLOR_0"] = colors;
    }
    primitive["indices"] = add_indices(node);
    primitive["material"] = n;
    json_["meshes"].push_back(Json::object({{"primitives", Json::array({primitive})}}));
    json_["nodes"].push_back(Json::object({{"name", node.name}, {"mesh", n}}));
    json_["nodes"][0]["children"].push_back(n + 1);
  }

  void add(const GlbMotion& motion) {
    const std::size_t count = motion.times_s.size();
    const std::size_t times = add_accessor(add_view(std::as_bytes(std::span(motion.times_s)), 0),
                                           kFloat, count, "SCALAR");
    json_["accessors"][times]["min"] = {motion.times_s.front()};
    json_["accessors"][times]["max"] = {motion.times_s.back()};
    const std::size_t positions = add_accessor(
        add_view(std::as_bytes(std::span(motion.positions_m)), 0), kFloat, count, "VEC3");
    const std::size_t rotations = add_accessor(
        add_view(std::as_bytes(std::span(motion.rotations_xyzw)), 0), kFloat, count, "VEC4");
    Json animation{{"name", motion.name}, {"channels", Json::array()}, {"samplers", Json::array()}};
    for (const auto& [output, path] :
         {std::pair(positions, "translation"), std::pair(rotations, "rotation")}) {
      const Json target{{"node", motion.node + 1}, {"path", path}};
      animation["channels"].push_back(
          Json::object({{"sampler", animation["samplers"].size()}, {"target", target}}));
      animation["samplers"].push_back(
          Json::object({{"input", times}, {"output", output}, {"interpolation", "LINEAR"}}));
    }
    json_["animations"].push_back(animation);
  }

  // Places a node that was added at the first pose of its motion.
  void place(const GlbMotion& motion) {
    Json& node = json_["nodes"][motion.node + 1];
    node["translation"] = motion.positions_m.front();
    node["rotation"] = motion.rotations_xyzw.front();
  }

  Status write(const std::string& path) {
    if (json_["animations"].empty()) json_.erase("animations");  // glTF has no empty lists
    json_["buffers"] = Json::array({Json::object({{"byteLength", bytes_.size()}})});
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::uint64_t whole = 12 + 8 + text.size() + 8 + bytes_.size();
    if (whole > UINT32_MAX) {
      return Error{ErrorCode::kWriteFailed, path, "", "a GLB file cannot be larger than 4 GiB", ""};
    }
    const auto size = [](std::size_t bytes) { return static_cast<std::uint32_t>(bytes); };
    const std::uint32_t head[] = {kMagic, kVersion, size(whole), size(text.size()), kJson};
    const std::uint32_t chunk[] = {size(bytes_.size()), kBin};
    auto file = AtomicFile::create(path);
    if (!file) return file.error();
    const std::span<const std::byte> parts[] = {std::as_bytes(std::span(head)),
                                                std::as_bytes(std::span(text)),
                                                std::as_bytes(std::span(chunk)), bytes_};
    for (const auto& part : parts) {
      if (Status written = file->write(part); !written) return written;
    }
    return file->commit();
  }

 private:
  std::size_t add_view(std::span<const std::byte> bytes, int target) {
    Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}};
    if (target != 0) view["target"] = target;
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    json_["bufferViews"].push_back(view);
    return json_["bufferViews"].size() - 1;
  }

  std::size_t add_accessor(std::size_t view, int type, std::size_t count, const char* shape) {
    json_["accessors"].push_back(Json::object(
        {{"bufferView", view}, {"componentType", type}, {"count", count}, {"type", shape}}));
    return json_["accessors"].size() - 1;
  }

  std::size_t add_indices(const GlbNode& node) {
    const std::size_t count = 3 * node.triangles.size();
    if (node.vertices_m.size() > kLargest16 + 1) {
      return add_accessor(add_view(std::as_bytes(std::span(node.triangles)), kIndices), kUint32,
                          count, "SCALAR");
    }
    std::vector<std::uint16_t> indices;
    for (const Triangle& triangle : node.triangles) {
      for (const std::uint32_t vertex : triangle) {
        indices.push_back(static_cast<std::uint16_t>(vertex));
      }
    }
    return add_accessor(add_view(std::as_bytes(std::span(indices)), kIndices), kUint16, count,
                        "SCALAR");
  }

  Json json_;
  std::vector<std::byte> bytes_;
};

}  // namespace

Status write_glb(const std::string& path, std::span<const GlbNode> nodes, const GlbMotion* motion,
                 Up up, const std::string& extras) {
  Document document(up, extras);
  if (motion != nullptr) document.add(*motion);
  for (const GlbNode& node : nodes) document.add(node);
  if (motion != nullptr) document.place(*motion);
  return document.write(path);
}

}  // namespace forcelayer::mesh
