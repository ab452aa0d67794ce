#include "formats/voxinfo/facts.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <limits>

#include "formats/command/provenance.h"
#include "formats/digest/file_digest.h"
#include "formats/guard.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxinfo {
namespace {

using nlohmann::ordered_json;

constexpr const char* kSideNames[] = {"min_x", "max_x", "min_y", "max_y", "min_z", "max_z"};
constexpr const char* kMetricNames[] = {"chebyshev", "euclidean"};
constexpr const char* kMethodNames[] = {"voxel-centers", "surface"};
constexpr const char* kMassSourceNames[] = {"volume", "area"};

std::string version_of(const FileHeader& header) {
  return std::to_string(header.major) + "." + std::to_string(header.minor);
}

bool is_nested_within(const nlohmann::json& json, int levels) {
  if (!json.is_structured()) return true;
  return levels > 0 && std::all_of(json.begin(), json.end(), [&](const nlohmann::json& element) {
           return is_nested_within(element, levels - 1);
         });
}

// Provenance as JSON where it parses and is not nested too deep, else as text. The reader of the
// file does not check it. Parsed without a callback and with its keys in order: with them a parser
// takes the square of the time.
ordered_json parsed_provenance(std::string_view text) {
  constexpr int kMaxDepth = 32;
  if (text.empty()) return nullptr;
  const nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
  if (parsed.is_discarded() || !is_nested_within(parsed, kMaxDepth)) return std::string(text);
  return parsed;
}

ordered_json cropped_side_names(std::uint32_t sides) {
  ordered_json names = ordered_json::array();
  for (std::uint32_t bit = 0; bit < 6; ++bit) {
    if (sides & (1u << bit)) names.push_back(kSideNames[bit]);
  }
  return names;
}

std::array<double, 3> origin_m(const VoxmapHeader& h) {
  std::array<double, 3> meters{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    meters[axis] = static_cast<double>(h.origin_voxel[axis]) * h.voxel_size_m;
  }
  return meters;
}

// The depth at which a compliance table ends.
double compliance_depth_m(const Voxmap& map) {
  return static_cast<double>(map.compliance().size() - 1) * map.header().distance_quantum_m;
}

// Null for none.
ordered_json length_or_null(double length_m) {
  return length_m > 0 ? ordered_json(length_m) : ordered_json(nullptr);
}

ordered_json report_of_voxmap(const Voxmap& map) {
  const VoxmapHeader& h = map.header();
  ordered_json report;
  report["format"] = "vox";
  report["version"] = version_of(h.file);
  report["voxel_size_m"] = h.voxel_size_m;
  report["origin_voxel"] = h.origin_voxel;
  report["origin_m"] = origin_m(h);
  report["dims"] = h.dims_voxels;
  report["layers"] = h.offset_layers;
  report["metric"] = kMetricNames[h.metric];
  if (h.zero_force_m > 0) {
    if (has_standoff(h)) report["standoff_m"] = h.zero_force_m;
    report["zero_force_m"] = h.zero_force_m;
    report["force_depth_m"] = h.force_depth_m;
  }
  if (has_distances(h)) {
    report["distances"] = {{"quantum_m", h.distance_quantum_m},
                           {"deepest_m", min_distance_m(h, 1)},
                           {"farthest_m", min_distance_m(h, kMaxDistanceCode)},
                           {"upper_nodes", map.distance_counts().upper_nodes},
                           {"lower_nodes", map.distance_counts().lower_nodes},
                           {"brick_bytes", map.distance_counts().brick_bytes}};
  }
  report["passed_gap_m"] = passed_gap_m(h);
  report["guaranteed_separation_m"] = length_or_null(usual_separation_m(h));
  report["object_count"] = h.object_count;
  report["counts"] = {{"interior", h.interior_voxels},
                      {"surface", h.surface_voxels},
                      {"proximity", h.proximity_voxels}};
  report["triangles"] = h.triangles;
  report["static_deviation_m"] = h.static_deviation_m;
  report["valid_min_voxel"] = h.valid_min_voxel;
  report["valid_max_voxel"] = h.valid_max_voxel;
  report["cropped_sides"] = cropped_side_names(h.cropped_sides);
  report["directory_origin_voxel"] = h.directory_origin;
  report["directory_dims"] = h.directory_dims;
  report["upper_nodes"] = map.upper_node_count();
  report["lower_nodes"] = map.lower_node_count();
  report["bricks"] = map.brick_count();
  report["compliance_entries"] = map.compliance().size();
  if (!map.compliance().empty()) {
    report["compliance"] = {{"depth_m", compliance_depth_m(map)},
                            {"pressure_pa", map.compliance().back()},
                            {"steepest_pa_per_m", steepest_pa_per_m(map)}};
  }
  report["file_bytes"] = h.file.file_bytes;
  report["sha256"] = digest::sha256_of(map.bytes());
  report["provenance"] = parsed_provenance(map.provenance());
  return report;
}

// Points of open sheets.
std::uint64_t two_sided_points(const Pshell& shell) {
  const PshellView& view = shell.view();
  if (view.two_sided == nullptr) return 0;
  return static_cast<std::uint64_t>(
      std::count(view.two_sided, view.two_sided + view.point_count, 1));
}

ordered_json report_of_pshell(const Pshell& shell) {
  const PshellHeader& h = shell.header();
  ordered_json report;
  report["format"] = "pshell";
  report["version"] = version_of(h.file);
  report["points"] = h.point_count;
  report["method"] = kMethodNames[h.method];
  report["covering_radius_m"] = h.covering_radius_m;
  report["convex_radius_m"] = h.convex_radius_m;
  report["convex_gap_m"] = h.convex_gap_m;
  report["losses"] = ordered_json::array();
  for (const DistanceLoss& entry : shell.surface_distance_terms().losses) {
    report["losses"].push_back({{"distance_m", entry.distance_m}, {"loss_m", entry.loss_m}});
  }
  report["area_m2"] = h.area_m2;
  report["voxel_size_m"] = h.voxel_size_m;
  report["part_deviation_m"] = h.part_deviation_m;
  report["center_m"] = h.center_m;
  report["bounding_radius_m"] = h.bounding_radius_m;
  report["volume_m3"] = h.volume_m3;
  report["mass_source"] = kMassSourceNames[h.mass_source];
  report["inertia_m2"] = h.inertia_m2;
  report["triangles"] = h.triangles;
  report["block_points"] = h.block_points;
  report["blocks"] = h.block_count;
  report["super_block_blocks"] = h.super_block_blocks;
  report["super_blocks"] = h.super_block_count;
  report["normal_cones"] = shell.view().cone_cos != nullptr;
  report["two_sided_points"] = two_sided_points(shell);
  report["file_bytes"] = h.file.file_bytes;
  report["sha256"] = digest::sha256_of(shell.bytes());
  report["provenance"] = parsed_provenance(shell.provenance());
  return report;
}

__attribute__((format(printf, 2, 3))) void add_line(std::string& text, const char* format, ...) {
  char line[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  text += line;
  text += '\n';
}

void add_missing_faces(std::string& text, std::string_view provenance) {
  const std::string missing = command::missing_faces_text(provenance);
  if (!missing.empty()) add_line(text, "  missing faces     %s", missing.c_str());
}

std::string cropped_text(std::uint32_t sides) {
  if (sides == 0) return "everywhere";
  std::string text = "not beyond the cropped sides";
  for (const auto& name : cropped_side_names(sides)) text += " " + name.get<std::string>();
  return text;
}

// Rounded down: what is proven must not be quoted larger than it is.
std::string millimeters(double length_m) {
  if (!(length_m > 0)) return "0 mm";
  const double unit = std::pow(10, std::floor(std::log10(1e3 * length_m)) - 2);
  char text[40];
  std::snprintf(text, sizeof text, "%.4g mm", std::floor(1e3 * length_m / unit) * unit);
  return text;
}

std::string summary_of_voxmap(const Voxmap& map, const std::string& path) {
  const VoxmapHeader& h = map.header();
  const auto low = origin_m(h);
  const double s = h.voxel_size_m;
  const auto extent = [&](std::size_t axis) {
    return static_cast<double>(h.dims_voxels[axis]) * s;
  };
  std::string text = escaped(path) + ": scene, .vox " + version_of(h.file) + "\n";
  add_line(text, "  voxel size        %.9g m, %s metric", s, kMetricNames[h.metric]);
  add_line(text,
           "  box               %" PRIu64 " x %" PRIu64 " x %" PRIu64
           " voxels, %.6g x %.6g x %.6g m",
           h.dims_voxels[0], h.dims_voxels[1], h.dims_voxels[2], extent(0), extent(1), extent(2));
  add_line(text, "  lowest voxel      %" PRId64 " %" PRId64 " %" PRId64 ", at %.9g %.9g %.9g m",
           h.origin_voxel[0], h.origin_voxel[1], h.origin_voxel[2], low[0], low[1], low[2]);
  if (has_standoff(h)) {
    add_line(text, "  standoff          %.4g mm; the guard uses stored distances, not voxel values",
             1e3 * h.zero_force_m);
  } else {
    add_line(text, "  offset layers     %u", h.offset_layers);
  }
  if (h.zero_force_m > 0) {
    add_line(text, "  force             begins %.4g mm off the mesh, in a layer %.4g mm deep",
             1e3 * h.zero_force_m, 1e3 * h.force_depth_m);
  }
  add_line(text,
           "  passable gap      at least %.4g mm wider than a part that is 2 voxels thick or more",
           1e3 * passed_gap_m(h));
  const double separation_m = usual_separation_m(h);
  add_line(
      text,
      "  proven distance   %s from scene to part in the narrowest passable gap, if the covering "
      "radius is %.4g mm (the default)",
      millimeters(separation_m).c_str(), 1e3 * std::sqrt(3.0) / 2 * s);
  if (has_distances(h)) {
    add_line(text,
             "  distances         from %.4g to %.4g mm in steps of %.3g mm, %" PRIu64 " bytes",
             1e3 * min_distance_m(h, 1), 1e3 * min_distance_m(h, kMaxDistanceCode),
             1e3 * h.distance_quantum_m, map.distance_counts().brick_bytes);
  } else {
    add_line(text, "  distances         none");
  }
  if (h.object_count > 0) {
    add_line(text, "  objects           %u; the nearest objects are stored in %" PRIu64 " bytes",
             h.object_count, map.object_counts().brick_bytes);
  }
  if (!map.compliance().empty()) {
    add_line(text, "  compliance        %.4g kPa at a depth of %.4g mm; at most %.4g kPa/mm",
             1e-3 * static_cast<double>(map.compliance().back()), 1e3 * compliance_depth_m(map),
             1e-6 * steepest_pa_per_m(map));
  }
  add_line(text,
           "  voxels            %" PRIu64 " interior, %" PRIu64 " surface, %" PRIu64 " proximity",
           h.interior_voxels, h.surface_voxels, h.proximity_voxels);
  add_line(text, "  triangles         %" PRIu64, h.triangles);
  add_line(text, "  static deviation  %.6g m", h.static_deviation_m);
  add_missing_faces(text, map.provenance());
  add_line(text, "  valid             %s", cropped_text(h.cropped_sides).c_str());
  add_line(text,
           "  tree              %u x %u x %u cells, %" PRIu64 " upper nodes, %" PRIu64
           " lower nodes, %" PRIu64 " bricks",
           h.directory_dims[0], h.directory_dims[1], h.directory_dims[2], map.upper_node_count(),
           map.lower_node_count(), map.brick_count());
  add_line(text, "  file              %" PRIu64 " bytes", h.file.file_bytes);
  add_line(text, "  SHA-256           %s", digest::sha256_of(map.bytes()).c_str());
  return text;
}

std::string summary_of_pshell(const Pshell& shell, const std::string& path) {
  const PshellHeader& h = shell.header();
  std::string text = escaped(path) + ": part, .pshell " + version_of(h.file) + "\n";
  add_line(text, "  points            %" PRIu64 ", %s, in %" PRIu64 " blocks of %u", h.point_count,
           kMethodNames[h.method], h.block_count, h.block_points);
  if (const std::uint64_t sheets = two_sided_points(shell); sheets > 0) {
    add_line(text, "  open sheets       %" PRIu64 " of the points have the outside on both sides",
             sheets);
  }
  add_line(text, "  covering radius   %.9g m", h.covering_radius_m);
  add_line(text, "  convex radius     %.9g m, with a gap of %.9g m", h.convex_radius_m,
           h.convex_gap_m);
  const double two_voxels_m = 2 * h.voxel_size_m;
  add_line(
      text,
      "  proven distance   %.6g m from the scene to the part, if all shell points are %.6g m or "
      "more from the scene",
      surface_distance_bound_m(shell.surface_distance_terms(), two_voxels_m), two_voxels_m);
  add_line(text, "  made for voxels   of %.9g m", h.voxel_size_m);
  add_line(text, "  part deviation    %.6g m", h.part_deviation_m);
  add_missing_faces(text, shell.provenance());
  add_line(text, "  area              %.6g m2", h.area_m2);
  add_line(text, "  volume            %.6g m3; the mass is computed from the %s", h.volume_m3,
           kMassSourceNames[h.mass_source]);
  add_line(text, "  centroid          %.9g %.9g %.9g m", h.center_m[0], h.center_m[1],
           h.center_m[2]);
  add_line(text, "  bounding radius   %.9g m", h.bounding_radius_m);
  add_line(text, "  triangles         %" PRIu64, h.triangles);
  add_line(text, "  file              %" PRIu64 " bytes", h.file.file_bytes);
  add_line(text, "  SHA-256           %s", digest::sha256_of(shell.bytes()).c_str());
  return text;
}

// Counts the voxels of each object, in the trees of objects and of distances at once. Where the map
// stores distances, a number beside a code that was not measured is a hint and does not count.
class ObjectCount {
 public:
  ObjectCount(const Voxmap& map, std::vector<ObjectFacts>& objects)
      : numbers_(*map.objects()), objects_(objects) {
    if (map.distances() != nullptr) codes_ = *map.distances();
  }

  // Where bricks repeat without end, this is found before any is unpacked.
  Status run(const std::string& path) {
    is_rehearsal_ = true;
    count_all();
    if (Status s = check_walk(steps_, path); !s) return s;
    is_rehearsal_ = false;
    steps_ = 0;
    count_all();
    return {};
  }

 private:
  void count_all() {
    const auto& dims = numbers_.directory_dims;
    const std::int64_t cells = std::int64_t{dims[0]} * dims[1] * dims[2];
    for (std::int64_t n = 0; n < cells; ++n) {
      const std::uint32_t codes = codes_.directory == nullptr ? kMeasured : codes_.directory[n];
      count(kUpperNodeEdge, numbers_.directory[n], codes);
    }
  }

  static constexpr std::uint32_t kMeasured = uniform_entry(1);

  static bool is_measured(std::uint32_t code) { return code > 0 && code < kMaxDistanceCode; }

  // Child n of an entry whose cube has this edge; a uniform entry is its own child.
  template <std::uint32_t kBits>
  static std::uint32_t child(const TreeView<kBits>& tree, std::uint32_t edge, std::uint32_t entry,
                             std::uint32_t n) {
    if (is_uniform(entry)) return entry;
    const std::uint32_t* nodes = edge == kUpperNodeEdge ? tree.upper_nodes : tree.lower_nodes;
    return nodes[std::uint64_t{entry} * kNodeEntries + n];
  }
  void count(std::uint32_t edge, std::uint32_t numbers, std::uint32_t codes) {
    if (is_uniform(numbers) && uniform_wide_value(numbers) == 0) return;
    if (is_uniform(codes) && !is_measured(uniform_wide_value(codes))) return;
    if (is_uniform(numbers) && is_uniform(codes)) {
      add(uniform_wide_value(numbers), std::uint64_t{edge} * edge * edge);
      return;
    }
    steps_ += kNodeEntries;
    if (steps_ > kMaxWalkSteps) return;
    if (edge == kBrickEdge) return count_brick(numbers, codes);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      count(edge / 8, child(numbers_, edge, numbers, n), child(codes_, edge, codes, n));
    }
  }
  void count_brick(std::uint32_t numbers, std::uint32_t codes) {
    if (is_rehearsal_) return;
    const auto of_voxel = numbers_.brick_codes(numbers);
    const auto code_of_voxel = codes_.brick_codes(codes);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      if (is_measured(code_of_voxel[n])) add(of_voxel[n], 1);
    }
  }

  void add(std::uint32_t object, std::uint64_t voxels) {
    if (is_rehearsal_) return;
    if (object >= 1 && object <= objects_.size()) objects_[object - 1].voxels += voxels;
  }

  const ObjectView& numbers_;
  DistanceView codes_;  // without a directory where the map stores no distances
  std::vector<ObjectFacts>& objects_;
  double steps_ = 0;
  bool is_rehearsal_ = false;
};

}  // namespace

Result<std::vector<ObjectFacts>> objects_of(const Voxmap& map, const std::string& path) {
  if (map.objects() == nullptr) return std::vector<ObjectFacts>{};
  std::vector<ObjectFacts> objects(map.header().object_count);
  for (std::uint32_t n = 0; n < objects.size(); ++n) objects[n].name = map.object_name(n + 1);
  if (Status s = ObjectCount(map, objects).run(path); !s) return s.error();
  return objects;
}

ordered_json report_of(const BakedFile& file) {
  const Voxmap* map = std::get_if<Voxmap>(&file);
  return map ? report_of_voxmap(*map) : report_of_pshell(std::get<Pshell>(file));
}

std::string summary_of(const BakedFile& file, const std::string& path) {
  const Voxmap* map = std::get_if<Voxmap>(&file);
  return map ? summary_of_voxmap(*map, path) : summary_of_pshell(std::get<Pshell>(file), path);
}

}  // namespace forcelayer::voxinfo
