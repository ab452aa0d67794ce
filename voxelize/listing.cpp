#include "voxelize/listing.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>

#include "formats/mesh/mesh_facts.h"
#include "formats/mesh/node_names.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/scene.h"
#include "formats/mesh/units.h"
#include "formats/mesh/up_axis.h"
#include "voxelize/forecast.h"
#include "voxelize/size_text.h"

namespace forcelayer::voxelize {
namespace {

// Adds up what stands below a node.
class NodeSum {
 public:
  explicit NodeSum(const mesh::Assembly& assembly) : assembly_(assembly) {
    for (const mesh::Mesh& mesh : assembly.meshes) {
      closed_.push_back(mesh::mesh_facts(mesh).closed);
    }
  }

  ListedNode of(const std::string& path, std::uint32_t first, std::uint32_t count) const {
    ListedNode node;
    node.path = path;
    node.box = mesh::empty_box();
    node.closed = true;
    for (std::uint32_t i = first; i < first + count; ++i) {
      const mesh::MeshInstance& instance = assembly_.instances[i];
      ++node.instances;
      node.triangles += assembly_.meshes[instance.mesh].triangles.size();
      mesh::extend(node.box, instance.box);
      node.closed = node.closed && closed_[instance.mesh];
    }
    for (const mesh::MissingFace& face : assembly_.missing_faces) {
      if (path.empty() || face.node == path || face.node.starts_with(path + "/")) {
        ++node.missing_faces;
      }
    }
    node.closed = node.closed && node.missing_faces == 0;
    return node;
  }

 private:
  const mesh::Assembly& assembly_;
  std::vector<bool> closed_;  // [meshes]
};

Result<ListedFile> list_file(const NamedFile& named, const mesh::Assembly& assembly) {
  ListedFile file;
  file.path = named.path;
  const NodeSum sum(assembly);
  file.whole = sum.of("", 0, static_cast<std::uint32_t>(assembly.instances.size()));
  const auto is_chosen = mesh::choose_nodes(named.nodes, assembly.nodes);
  if (!is_chosen) return is_chosen.error();
  const std::vector<std::string> names = mesh::numbered_paths(assembly.nodes);
  for (std::size_t i = 0; i < assembly.nodes.size(); ++i) {
    const mesh::AssemblyNode& node = assembly.nodes[i];
    if (!(*is_chosen)[i]) continue;
    ListedNode listed = sum.of(node.path, node.first_instance, node.instance_count);
    listed.name = names[i];
    if (listed.instances > 0 || listed.missing_faces > 0) file.nodes.push_back(std::move(listed));
  }
  return file;
}

// The parts of a manifest, where it places them.
Result<ListedFile> list_manifest(const NamedFile& named, const mesh::ReadOptions& options,
                                 const mesh::AssemblyReader& read,
                                 std::vector<std::string>& warnings) {
  const auto scene = mesh::read_manifest(named, options, read);
  if (!scene) return scene.error();
  for (const std::string& warning : scene->warnings) {
    warnings.push_back(named.path + ": " + warning);
  }
  ListedFile file;
  file.path = named.path;
  file.meters_per_unit = 1;
  const auto sum = [&](const std::string& path) {
    ListedNode node;
    node.path = node.name = path;
    node.box = mesh::empty_box();
    node.closed = true;
    const auto is_in = [&](const std::string& name) {
      return path.empty() || name == path || name.starts_with(path + "/");
    };
    for (const mesh::MeshObject& object : scene->objects) {
      if (!is_in(object.name)) continue;
      ++node.instances;
      node.triangles += scene->mesh_of(object).triangles.size();
      mesh::extend(node.box, object.box_m);
      node.closed = node.closed && mesh::mesh_facts(scene->mesh_of(object)).closed;
    }
    for (const mesh::MissingFace& face : scene->missing_faces) {
      node.missing_faces += is_in(face.node) ? 1 : 0;
    }
    node.closed = node.closed && node.missing_faces == 0;
    return node;
  };
  file.whole = sum("");
  for (const mesh::MeshObject& object : scene->objects) {
    // A part of several bodies has a row of its own before theirs.
    const std::string part = object.name.substr(0, object.name.find('/'));
    const bool is_new = file.nodes.empty() || (file.nodes.back().path != part &&
                                               !file.nodes.back().path.starts_with(part + "/"));
    if (is_new && part != object.name) file.nodes.push_back(sum(part));
    file.nodes.push_back(sum(object.name));
  }
  return file;
}

// As a bake asks it.
std::optional<std::string> question_of(const mesh::Assembly& assembly, mesh::Box box,
                                       double meters_per_unit) {
  for (mesh::Vec3d* const corner : {&box.low, &box.high}) {
    for (double& coordinate : *corner) coordinate *= meters_per_unit;
  }
  double largest_unit_m = 0;
  for (const mesh::MeshInstance& instance : assembly.instances) {
    const double stretch = mesh::largest_stretch(instance.assembly_from_mesh);
    largest_unit_m = std::max(largest_unit_m, stretch * meters_per_unit);
  }
  return unit_question("the model", box, largest_unit_m);
}

Error not_listed(const std::string& path, const char* what) {
  return {ErrorCode::kUsage, path, "--list", what, "name the mesh files"};
}

std::string surface_text(const ListedNode& node) {
  if (node.missing_faces > 0) return mesh::counted(node.missing_faces, "face") + " missing";
  return node.closed ? "closed" : "open";
}

std::string size_of(const ListedFile& file, const ListedNode& node) {
  if (node.instances == 0) return "-";
  if (!file.meters_per_unit) return size_text(node.box, 1, "units");
  return size_text_m(node.box, *file.meters_per_unit);
}

std::string heading_of(const ListedFile& file) {
  char unit[80];
  const char* const axes = !file.up                   ? ""
                           : *file.up == mesh::Up::kZ ? ", turned from y-up to z-up"
                                                      : ", y-up as in the file";
  if (file.meters_per_unit) {
    std::snprintf(unit, sizeof unit, "unit %.6g m", *file.meters_per_unit);
  } else {
    std::snprintf(unit, sizeof unit, "no unit in this format: add --units");
  }
  return escaped(file.path) + ": " + mesh::counted(file.whole.instances, "instance") + ", " +
         mesh::counted(file.whole.triangles, "triangle") + ", " + size_of(file, file.whole) + ", " +
         surface_text(file.whole) + "; " + unit + axes + "\n";
}

nlohmann::ordered_json json_of(const ListedNode& node, const std::optional<double>& unit) {
  nlohmann::ordered_json json;
  if (!node.path.empty()) json["node"] = node.path;
  json["instances"] = node.instances;
  json["triangles"] = node.triangles;
  json["closed"] = node.closed;
  json["missing_faces"] = node.missing_faces;
  if (node.instances == 0) return json;
  mesh::Vec3d low = node.box.low, high = node.box.high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] *= unit.value_or(1);
    high[axis] *= unit.value_or(1);
  }
  json[unit ? "low_m" : "low_units"] = low;
  json[unit ? "high_m" : "high_units"] = high;
  return json;
}

}  // namespace

Result<Listing> list_files(std::span<const std::string> inputs,
                           std::optional<double> meters_per_unit, mesh::ReadOptions options,
                           const mesh::AssemblyReader& read) {
  Listing listing;
  options.missing_faces = std::numeric_limits<std::uint64_t>::max();
  std::vector<mesh::Assembly> assemblies;
  for (const NamedFile& named : mesh::unite_by_file(inputs)) {
    std::error_code ignored;
    if (mesh::is_manifest(named.path)) {
      auto file = list_manifest(named, options, read, listing.warnings);
      if (!file) return file.error();
      listing.files.push_back(std::move(*file));
      continue;
    }
    if (std::filesystem::is_directory(named.path, ignored)) {
      return not_listed(named.path, "is not possible for a folder");
    }
    options.nodes = named.nodes;
    auto assembly = read(named.path, options);
    if (!assembly) return assembly.error();
    auto file = list_file(named, *assembly);
    if (!file) return file.error();
    if (const auto unit =
            mesh::meters_per_unit(*assembly, named.path, meters_per_unit, assembly->warnings)) {
      file->meters_per_unit = *unit;
    }
    file->up = assembly->up;
    if (!meters_per_unit && file->meters_per_unit) {
      if (auto question = question_of(*assembly, file->whole.box, *file->meters_per_unit)) {
        assembly->warnings.push_back(std::move(*question));
      }
    }
    for (const std::string& warning : assembly->warnings) {
      listing.warnings.push_back(named.path + ": " + warning);
    }
    listing.files.push_back(std::move(*file));
    assembly->meshes.clear();
    assemblies.push_back(std::move(*assembly));
  }
  const bool any_manifest = std::any_of(inputs.begin(), inputs.end(), mesh::is_manifest);
  if (any_manifest) return listing;  // read_scene() has checked the names
  if (Status named = mesh::check_left_out(options.without, assemblies); !named)
    return named.error();
  return listing;
}

std::string table_of(const Listing& listing) {
  std::string table;
  for (const ListedFile& file : listing.files) {
    table += heading_of(file);
    if (file.nodes.empty()) continue;
    std::size_t size_width = 4;
    for (const ListedNode& node : file.nodes) {
      size_width = std::max(size_width, size_of(file, node).size());
    }
    const auto row = [&](const std::string& instances, const std::string& triangles,
                         const std::string& size, const std::string& surface,
                         const std::string& node) {
      char line[200];
      std::snprintf(line, sizeof line, "%9s %10s  %-*s  %-7s  ", instances.c_str(),
                    triangles.c_str(), static_cast<int>(std::min<std::size_t>(size_width, 80)),
                    size.c_str(), surface.c_str());
      table += line + node + "\n";
    };
    row("instances", "triangles", "size", "surface", "node");
    for (const ListedNode& node : file.nodes) {
      row(std::to_string(node.instances), std::to_string(node.triangles), size_of(file, node),
          surface_text(node), escaped(node.name));
    }
  }
  return table;
}

nlohmann::ordered_json report_of(const Listing& listing) {
  using Json = nlohmann::ordered_json;
  Json files = Json::array();
  for (const ListedFile& file : listing.files) {
    Json nodes = Json::array();
    for (const ListedNode& node : file.nodes) nodes.push_back(json_of(node, file.meters_per_unit));
    Json unit = nullptr;
    if (file.meters_per_unit) unit = *file.meters_per_unit;
    files.push_back({{"file", file.path},
                     {"meters_per_unit", unit},
                     {"up", file.up ? Json(mesh::name_of(*file.up)) : Json(nullptr)},
                     {"whole", json_of(file.whole, file.meters_per_unit)},
                     {"nodes", nodes}});
  }
  return {{"files", files}, {"warnings", listing.warnings}};
}

}  // namespace forcelayer::voxelize
