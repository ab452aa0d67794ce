// glTF 2.0, .glb and .gltf: the node tree, with a mesh for each glTF mesh. The primitives of a mesh
// are one object (they differ in material only) and become one triangle mesh.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "formats/mesh/checks/grouped_warnings.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/readers/draco_stream.h"
#include "formats/mesh/readers/gltf/gltf_document.h"
#include "formats/mesh/readers/gltf/gltf_nodes.h"

namespace forcelayer::mesh {
namespace {

enum PrimitiveMode : std::uint64_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

// A morph target that takes part in the default shape.
struct MorphTarget {
  std::uint64_t positions;  // accessor of what it adds
  double weight;
  friend auto operator<=>(const MorphTarget&, const MorphTarget&) = default;
};

std::string morph_warning(const std::vector<double>& weights) {
  constexpr std::size_t kListed = 8;
  if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0; })) {
    return "morph targets are left out: their default weights are zero";
  }
  std::ostringstream text;
  text << "morph targets are applied with their default weights ";
  for (std::size_t n = 0; n < std::min(weights.size(), kListed); ++n) {
    text << (n == 0 ? "" : ", ") << weights[n];
  }
  if (weights.size() > kListed) text << ", ...";
  return text.str();
}

// The triangles of one glTF mesh, with these weights of its morph targets.
class MeshReader {
 public:
  MeshReader(const GltfDocument& document, std::uint64_t index, const std::vector<double>& weights)
      : document_(document), weights_(weights), where_("meshes[" + std::to_string(index) + "]") {
    const nlohmann::json& primitives = document.element("meshes", index).at("primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      primitive_where_ = where_ + ".primitives[" + std::to_string(i) + "]";
      read_primitive(primitives[i]);
    }
    check_finite(document.file(), mesh_, where_);
  }

  Mesh take() { return std::move(mesh_); }
  std::uint64_t lines_and_points() const { return lines_and_points_; }
  bool has_morph_targets() const { return has_morph_targets_; }
  bool has_integer_positions() const { return has_integer_positions_; }
  const std::optional<DracoQuantization>& quantization() const { return quantization_; }

 private:
  void read_primitive(const nlohmann::json& primitive) {
    const std::uint64_t mode = document_.index_or(primitive, "mode", kTriangles);
    if (mode < kTriangles) {
      ++lines_and_points_;
      return;
    }
    if (mode > kTriangleFan) {
      document_.fail(ErrorCode::kMeshUnreadable, primitive_where_, "has an unknown mode");
    }
    has_morph_targets_ = has_morph_targets_ || primitive.contains("targets");
    const auto extensions = primitive.find("extensions");
    if (extensions != primitive.end() && extensions->contains("KHR_draco_mesh_compression")) {
      return read_draco(primitive, extensions->at("KHR_draco_mesh_compression"), mode);
    }
    const std::uint64_t positions = position_accessor(primitive);
    const std::uint32_t first = read_positions(positions, targets_of(primitive));
    const std::uint64_t vertex_count =
        document_.index(document_.element("accessors", positions), "count");
    add_triangles(corners_of(primitive, vertex_count), mode, first);
  }

  std::uint64_t position_accessor(const nlohmann::json& primitive) const {
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->contains("POSITION")) {
      document_.fail(ErrorCode::kMeshUnreadable, primitive_where_, "has no POSITION");
    }
    return document_.index(*attributes, "POSITION");
  }

  std::vector<MorphTarget> targets_of(const nlohmann::json& primitive) const {
    std::vector<MorphTarget> targets;
    const auto all = primitive.find("targets");
    if (all == primitive.end()) return targets;
    for (std::size_t n = 0; n < std::min(all->size(), weights_.size()); ++n) {
      const nlohmann::json& target = all->at(n);
      if (weights_[n] == 0 || !target.contains("POSITION")) continue;
      targets.push_back({document_.index(target, "POSITION"), weights_[n]});
    }
    return targets;
  }

  // Appends the accessor's vertices, moved by morph targets, once where primitives share them;
  // returns the first one's index.
  std::uint32_t read_positions(std::uint64_t accessor, const std::vector<MorphTarget>& targets) {
    const auto [place, is_new] = first_vertices_.try_emplace(
        {accessor, targets}, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (!is_new) return place->second;
    constexpr std::uint64_t kFloat = 5126;
    const nlohmann::json& json = document_.element("accessors", accessor);
    has_integer_positions_ =
        has_integer_positions_ || document_.index(json, "componentType") != kFloat;
    std::vector<double> numbers = document_.read_numbers(accessor, 3);
    for (const MorphTarget& target : targets) {
      const std::vector<double> added = document_.read_numbers(target.positions, 3);
      if (added.size() != numbers.size()) {
        document_.fail(ErrorCode::kMeshUnreadable, primitive_where_,
                       "has more or fewer vertices than its morph target");
      }
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] += target.weight * added[i];
    }
    check_count(document_.file(), mesh_.vertices.size() + numbers.size() / 3, "vertices");
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      mesh_.vertices.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    }
    return place->second;
  }

  std::vector<std::uint32_t> corners_of(const nlohmann::json& primitive,
                                        std::uint64_t vertex_count) const {
    std::vector<std::uint32_t> corners;
    if (!primitive.contains("indices")) {
      for (std::uint64_t i = 0; i < vertex_count; ++i) {
        corners.push_back(static_cast<std::uint32_t>(i));
      }
      return corners;
    }
    corners = document_.read_indices(document_.index(primitive, "indices"));
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (corners[i] < vertex_count) continue;
      document_.fail(ErrorCode::kMeshUnreadable, primitive_where_,
                     "index " + std::to_string(i) + " names vertex " + std::to_string(corners[i]) +
                         ", but there are only " + std::to_string(vertex_count) +
                         " vertices, counted from 0");
    }
    return corners;
  }

  void add_triangles(const std::vector<std::uint32_t>& corners, std::uint64_t mode,
                     std::uint32_t first) {
    const std::size_t count = corners.size();
    if (count == 0) return;
    if (mode == kTriangles ? count % 3 != 0 : count < 3) {
      document_.fail(ErrorCode::kMeshIncomplete, primitive_where_,
                     counted(count, "corner") + " do not make a whole number of triangles");
    }
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      mesh_.triangles.push_back({corners[a] + first, corners[b] + first, corners[c] + first});
    };
    if (mode == kTriangles) {
      for (std::size_t i = 0; i < count; i += 3) add(i, i + 1, i + 2);
      return;
    }
    for (std::size_t i = 0; i + 2 < count; ++i) {
      if (mode == kTriangleFan) {
        add(0, i + 1, i + 2);
      } else {  // every second triangle of a strip is turned over
        add(i, i + 1 + i % 2, i + 2 - i % 2);
      }
    }
  }

  void read_draco(const nlohmann::json& primitive, const nlohmann::json& extension,
                  std::uint64_t mode) {
    if (!targets_of(primitive).empty()) {
      document_.fail(ErrorCode::kMeshUnsupported, primitive_where_,
                     "has morph targets that move the vertices of a Draco stream",
                     "export the mesh without Draco compression");
    }
    const std::uint64_t view = document_.index(extension, "bufferView");
    const std::uint64_t id = document_.index(extension.at("attributes"), "POSITION");
    DracoSurface surface = decode_draco(document_.file(), document_.buffer_view(view),
                                        primitive_where_, static_cast<std::uint32_t>(id));
    check_draco_count(primitive, mode, surface.triangles.size());
    check_count(document_.file(), mesh_.vertices.size() + surface.vertices.size(), "vertices");
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    mesh_.vertices.insert(mesh_.vertices.end(), surface.vertices.begin(), surface.vertices.end());
    for (const auto& [a, b, c] : surface.triangles) {
      mesh_.triangles.push_back({a + first, b + first, c + first});
    }
    const bool coarser = surface.quantization &&
                         (!quantization_ || quantization_->step < surface.quantization->step);
    if (coarser) quantization_ = surface.quantization;
  }

  // The asset repeats the number of corners beside the stream.
  void check_draco_count(const nlohmann::json& primitive, std::uint64_t mode,
                         std::uint64_t triangles) const {
    if (mode != kTriangles || !primitive.contains("indices")) return;
    const std::uint64_t accessor = document_.index(primitive, "indices");
    const std::uint64_t announced =
        document_.index(document_.element("accessors", accessor), "count");
    if (announced == 3 * triangles) return;
    document_.fail(ErrorCode::kMeshIncomplete, primitive_where_,
                   "announces " + counted(announced, "corner") + ", but its Draco stream has " +
                       counted(triangles, "triangle"));
  }

  const GltfDocument& document_;
  const std::vector<double>& weights_;
  std::string where_;
  std::string primitive_where_;
  Mesh mesh_;
  std::map<std::pair<std::uint64_t, std::vector<MorphTarget>>, std::uint32_t> first_vertices_;
  std::uint64_t lines_and_points_ = 0;  // primitives
  bool has_morph_targets_ = false;
  bool has_integer_positions_ = false;
  std::optional<DracoQuantization> quantization_;  // the coarsest
};

class GltfReader {
 public:
  explicit GltfReader(const SourceFile& file) : document_(file), nodes_(document_) {}

  Assembly read() {
    assembly_.meters_per_unit = 1.0;
    for (const GltfPlacing& placing : nodes_.placings()) place(placing);
    assembly_.nodes = nodes_.tree();
    set_instances(nodes_of_instances_, assembly_.nodes);
    if (assembly_.instances.empty()) {
      document_.fail(ErrorCode::kMeshEmpty, "",
                     lines_and_points_ > 0 ? "no triangles in this file, only points or lines"
                     : !nodes_.left_out().empty()
                         ? "--without leaves out all nodes of this file that have a mesh"
                         : "no node with a mesh in this file",
                     nodes_.left_out().empty()
                         ? "export a surface mesh"
                         : "keep at least one node of this file, or leave out the whole file; "
                           "nothing can block the last part of an assembly");
    }
    add_warnings();
    assembly_.left_out = nodes_.left_out();
    return std::move(assembly_);
  }

 private:
  void place(const GltfPlacing& placing) {
    const auto [known, is_new] = meshes_.try_emplace({placing.mesh, placing.weights}, kNoTriangles);
    if (is_new) known->second = read_mesh(placing.mesh, placing.weights);
    if (known->second == kNoTriangles) return;
    if (morphing_meshes_.contains(placing.mesh)) {
      morph_warnings_.add(placing.path, morph_warning(placing.weights));
    }
    assembly_.instances.push_back({known->second, placing.path, placing.assembly_from_mesh});
    nodes_of_instances_.push_back(placing.node);
  }

  std::uint32_t read_mesh(std::uint64_t index, const std::vector<double>& weights) {
    MeshReader reader(document_, index, weights);
    lines_and_points_ += reader.lines_and_points();
    if (reader.has_morph_targets()) morphing_meshes_.insert(index);
    has_integer_positions_ = has_integer_positions_ || reader.has_integer_positions();
    if (reader.quantization() &&
        (!quantization_ || quantization_->step < reader.quantization()->step)) {
      quantization_ = reader.quantization();
    }
    Mesh mesh = reader.take();
    if (mesh.triangles.empty()) return kNoTriangles;
    assembly_.meshes.push_back(std::move(mesh));
    return static_cast<std::uint32_t>(assembly_.meshes.size() - 1);
  }

  void add_warnings() {
    std::vector<std::string>& warnings = assembly_.warnings;
    nodes_.add_warnings(warnings);
    if (lines_and_points_ > 0) {
      warnings.push_back(counted(lines_and_points_, "primitive") + " of points or lines " +
                         (lines_and_points_ == 1 ? "is" : "are") +
                         " left out, because points and lines have no surface");
    }
    for (std::string& line : morph_warnings_.lines()) warnings.push_back(std::move(line));
    if (has_integer_positions_) {
      warnings.push_back(
          "positions are stored as rounded integers (KHR_mesh_quantization); give the rounding "
          "error with --mesh-deviation");
    }
    if (quantization_) warnings.push_back(quantization_warning(*quantization_));
  }

  static constexpr std::uint32_t kNoTriangles = 0xffffffff;

  GltfDocument document_;
  GltfNodes nodes_;
  Assembly assembly_;
  std::vector<std::size_t> nodes_of_instances_;  // [instances]
  // A glTF mesh with its weights to Assembly::meshes.
  std::map<std::pair<std::uint64_t, std::vector<double>>, std::uint32_t> meshes_;
  std::uint64_t lines_and_points_ = 0;       // primitives
  std::set<std::uint64_t> morphing_meshes_;  // glTF meshes with morph targets
  GroupedWarnings morph_warnings_{"nodes"};
  bool has_integer_positions_ = false;
  std::optional<DracoQuantization> quantization_;  // the coarsest
};

}  // namespace

Assembly read_gltf(const SourceFile& file) {
  try {
    return GltfReader(file).read();
  } catch (const nlohmann::json::exception& error) {  // a field of another type than glTF has
    fail_read(file, ErrorCode::kMeshUnreadable, "JSON", error.what(), "export the mesh again");
  }
}

}  // namespace forcelayer::mesh
