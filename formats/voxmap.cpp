#include "formats/voxmap.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "formats/bulk_checks.h"
#include "formats/field_check.h"
#include "formats/voxmap_sections.h"

namespace forcelayer {
namespace {

constexpr double kRoundingVoxels = 1e-6;  // of two lengths in meters

bool is_voxel_index(std::int64_t index) {
  return index >= -kMaxVoxelIndex && index <= kMaxVoxelIndex;
}

// The metric, and the lengths that go with it.
void check_encoding_fields(const VoxmapHeader& h, FieldChecks& checks) {
  checks.require(h.metric <= static_cast<std::uint32_t>(Metric::kEuclidean),
                 offsetof(VoxmapHeader, metric), "metric",
                 "is not a metric of this format version");
  if (!checks.status()) return;
  const bool euclidean = h.metric == static_cast<std::uint32_t>(Metric::kEuclidean);
  const auto length = [&](double value, std::size_t offset, const char* field) {
    checks.require(euclidean ? std::isfinite(value) && value > 0 : value == 0, offset, field,
                   euclidean ? "is not a positive length" : "must be zero in the Chebyshev metric");
  };
  length(h.zero_force_m, offsetof(VoxmapHeader, zero_force_m), "zero_force_m");
  length(h.force_depth_m, offsetof(VoxmapHeader, force_depth_m), "force_depth_m");
  checks.require(h.force_depth_m <= h.zero_force_m, offsetof(VoxmapHeader, force_depth_m),
                 "force_depth_m", "is more than zero_force_m");
  checks.require(!has_standoff(h) || has_distances(h), offsetof(VoxmapHeader, offset_layers),
                 "offset_layers",
                 "must not be zero in the Euclidean metric if no distances are stored");
  checks.require(!has_standoff(h) ||
                     interior_radius_m(h) / h.voxel_size_m >= kMinInteriorVoxels - kRoundingVoxels,
                 offsetof(VoxmapHeader, zero_force_m), "zero_force_m",
                 "must be at least force_depth_m + 888/1024 voxel");
  checks.require(h.distance_quantum_m == 0 ||
                     (euclidean && h.distance_quantum_m > 0 &&
                      h.distance_quantum_m * kMaxDistanceCode <= kMaxVoxelSizeM * kMaxDistanceCode),
                 offsetof(VoxmapHeader, distance_quantum_m), "distance_quantum_m",
                 "is neither zero nor a valid step of Euclidean distances");
  constexpr auto kHighest = static_cast<std::int32_t>(kMaxDistanceCode);
  checks.require(
      has_distances(h) ? h.distance_zero_code > 0 && h.distance_zero_code < kHighest
                       : h.distance_zero_code == 0,
      offsetof(VoxmapHeader, distance_zero_code), "distance_zero_code",
      has_distances(h) ? "is not between 1 and 254" : "must be zero without stored distances");
  checks.require(h.object_count <= kMaxObjects, offsetof(VoxmapHeader, object_count),
                 "object_count", "is above 65535");
}

void check_directory_fields(const VoxmapHeader& h, FieldChecks& checks) {
  std::uint64_t entries = 1;
  bool any_zero = false, all_zero = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t origin = h.directory_origin[axis];
    checks.require(origin % kUpperNodeEdge == 0 && is_voxel_index(origin),
                   offsetof(VoxmapHeader, directory_origin) + 8 * axis, "directory_origin",
                   "is not a multiple of 512, or is beyond 2^52 voxels");
    const std::uint32_t dim = h.directory_dims[axis];
    checks.require(dim <= kMaxDirectoryDim, offsetof(VoxmapHeader, directory_dims) + 4 * axis,
                   "directory_dims", "is above 2^21 cells");
    if (!checks.status()) return;
    any_zero |= dim == 0;
    all_zero &= dim == 0;
    entries *= dim;  // below 2^63
  }
  checks.require(any_zero == all_zero, offsetof(VoxmapHeader, directory_dims), "directory_dims",
                 "are zero on some axes only");
  checks.require(entries <= kMaxDirectoryEntries, offsetof(VoxmapHeader, directory_dims),
                 "directory_dims", "make more than 2^28 entries");
}

// The tight box of non-free voxels; the directory has been checked.
void check_box_fields(const VoxmapHeader& h, FieldChecks& checks) {
  const auto& dims = h.dims_voxels;
  const bool empty = dims[0] == 0 && dims[1] == 0 && dims[2] == 0;
  for (std::size_t axis = 0; axis < 3 && checks.status(); ++axis) {
    const std::int64_t origin = h.origin_voxel[axis];
    const std::size_t origin_at = offsetof(VoxmapHeader, origin_voxel) + 8 * axis;
    const std::size_t dims_at = offsetof(VoxmapHeader, dims_voxels) + 8 * axis;
    if (empty) {
      checks.require(origin == 0, origin_at, "origin_voxel", "must be zero if all voxels are free");
      continue;
    }
    const std::int64_t low = h.directory_origin[axis];
    const std::int64_t extent = std::int64_t{h.directory_dims[axis]} * kUpperNodeEdge;
    checks.require(origin >= low && origin < low + extent, origin_at, "origin_voxel",
                   "is outside the nodes of the directory");
    checks.require(dims[axis] > 0, dims_at, "dims_voxels", "is zero on some axes only");
    if (!checks.status()) return;
    checks.require(dims[axis] <= static_cast<std::uint64_t>(low + extent - origin), dims_at,
                   "dims_voxels", "reaches outside the directory");
  }
}

// The box in which the bake is valid; the tight box has been checked.
void check_valid_box_fields(const VoxmapHeader& h, FieldChecks& checks) {
  const bool empty = h.dims_voxels[0] == 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = h.valid_min_voxel[axis], high = h.valid_max_voxel[axis];
    const std::size_t low_at = offsetof(VoxmapHeader, valid_min_voxel) + 8 * axis;
    const std::size_t high_at = offsetof(VoxmapHeader, valid_max_voxel) + 8 * axis;
    checks.require(is_voxel_index(low), low_at, "valid_min_voxel", "lies beyond 2^52 voxels");
    checks.require(is_voxel_index(high) && high >= low, high_at, "valid_max_voxel",
                   "lies beyond 2^52 voxels or below valid_min_voxel");
    if (empty || !checks.status()) continue;
    const std::int64_t end = h.origin_voxel[axis] + static_cast<std::int64_t>(h.dims_voxels[axis]);
    checks.require(low <= h.origin_voxel[axis], low_at, "valid_min_voxel",
                   "lies above the lowest non-free voxel");
    checks.require(high >= end, high_at, "valid_max_voxel",
                   "lies below the highest non-free voxel");
  }
  checks.require(h.cropped_sides < 64, offsetof(VoxmapHeader, cropped_sides), "cropped_sides",
                 "has unknown bits");
}

// Numbers of voxels by value; the tight box has been checked, and with the directory's limit its
// volume fits 64 bits.
void check_count_fields(const VoxmapHeader& h, FieldChecks& checks) {
  std::uint64_t left = h.dims_voxels[0] * h.dims_voxels[1] * h.dims_voxels[2];
  const auto take = [&](std::uint64_t count, std::size_t offset, const char* field) {
    checks.require(count <= left, offset, field, "is too large for the box of non-free voxels");
    if (checks.status()) left -= count;
  };
  take(h.interior_voxels, offsetof(VoxmapHeader, interior_voxels), "interior_voxels");
  take(h.surface_voxels, offsetof(VoxmapHeader, surface_voxels), "surface_voxels");
  take(h.proximity_voxels, offsetof(VoxmapHeader, proximity_voxels), "proximity_voxels");
  const bool any = (h.interior_voxels | h.surface_voxels | h.proximity_voxels) != 0;
  checks.require(any == (h.dims_voxels[0] != 0), offsetof(VoxmapHeader, interior_voxels),
                 "interior_voxels, surface_voxels, proximity_voxels",
                 "must be zero if and only if dims_voxels is zero");
}

Status check_header_fields(const VoxmapHeader& h, std::string_view name) {
  FieldChecks checks(name);
  checks.require(h.voxel_size_m >= kMinVoxelSizeM && h.voxel_size_m <= kMaxVoxelSizeM,
                 offsetof(VoxmapHeader, voxel_size_m), "voxel_size_m",
                 "is not between 1e-9 and 1e6 meters");
  check_encoding_fields(h, checks);
  check_directory_fields(h, checks);
  if (checks.status()) check_box_fields(h, checks);
  if (checks.status()) check_valid_box_fields(h, checks);
  if (checks.status()) check_count_fields(h, checks);
  checks.require(h.offset_layers <= kMaxOffsetLayers, offsetof(VoxmapHeader, offset_layers),
                 "offset_layers", "is above 65535");
  checks.require(is_finite_not_negative(h.static_deviation_m),
                 offsetof(VoxmapHeader, static_deviation_m), "static_deviation_m",
                 "is not a finite length");
  if (!is_newer_minor(h.file, kVoxmapHeaderRule)) {
    checks.require(h.reserved0 == 0, offsetof(VoxmapHeader, reserved0), "reserved", "is not zero");
    checks.require(h.reserved1 == 0, offsetof(VoxmapHeader, reserved1), "reserved", "is not zero");
    checks.require(std::all_of(h.reserved.begin(), h.reserved.end(), [](auto b) { return b == 0; }),
                   offsetof(VoxmapHeader, reserved), "reserved", "is not zero");
  }
  return checks.status();
}

std::string describe_bad_entry(std::uint32_t entry, const EntryRule& rule) {
  if (!is_uniform(entry)) {
    return "child index " + std::to_string(entry) + " is too large for " +
           std::to_string(rule.child_count) + " children";
  }
  const std::uint32_t value = entry & rule.value_mask;
  if (value > rule.max_value) {
    return "value " + std::to_string(value) + " is above " + std::to_string(rule.max_value);
  }
  return rule.clearance_mask != 0 && value != 0
             ? "reserved bits are set in an entry of voxels that are not free"
             : "reserved bits are not zero";
}

Status check_entries(std::span<const std::uint32_t> entries, const EntryRule& rule,
                     std::string_view name, const char* section) {
  const std::size_t index = first_bad_entry(entries, rule);
  if (index == entries.size()) return {};
  return Error{ErrorCode::kEntryInvalid, name,
               std::string(section) + " entry " + std::to_string(index),
               describe_bad_entry(entries[index], rule), "bake or copy it again"};
}

// The sections of one tree, as they stand in the file.
struct TreeSections {
  const char* directory;
  const char* upper_nodes;
  const char* lower_nodes;
  std::span<const std::span<const std::byte>> bytes;  // of the four
};

// Checks a tree of elements of `bits` bits.
Status check_tree(const VoxmapHeader& h, const TreeSections& sections, std::uint32_t bits,
                  EntryRule rule, std::string_view name, TreeCounts& counts) {
  const auto directory = elements_of<std::uint32_t>(sections.bytes[0]);
  const auto upper_nodes = elements_of<std::uint32_t>(sections.bytes[1]);
  const auto lower_nodes = elements_of<std::uint32_t>(sections.bytes[2]);
  const std::uint64_t bytes = sections.bytes[3].size(), largest = max_brick_bytes(bits);
  counts = {upper_nodes.size() / kNodeEntries, lower_nodes.size() / kNodeEntries,
            bytes < largest ? 0 : (bytes - largest) / brick_step_bytes(bits) + 1, bytes};
  const std::uint64_t wanted =
      std::uint64_t{h.directory_dims[0]} * h.directory_dims[1] * h.directory_dims[2];
  if (directory.size() != wanted) {
    return Error{ErrorCode::kSectionInvalid, name, sections.directory,
                 "has " + std::to_string(directory.size()) + " entries, but the header requires " +
                     std::to_string(wanted),
                 "bake or copy it again"};
  }
  rule.child_count = counts.upper_nodes;
  if (Status s = check_entries(directory, rule, name, sections.directory); !s) return s;
  rule.child_count = counts.lower_nodes;
  if (Status s = check_entries(upper_nodes, rule, name, sections.upper_nodes); !s) return s;
  rule.child_count = counts.bricks;
  return check_entries(lower_nodes, rule, name, sections.lower_nodes);
}

template <std::uint32_t kBits>
TreeView<kBits> view_of(const VoxmapHeader& h, const TreeSections& sections) {
  TreeView<kBits> view{elements_of<std::uint32_t>(sections.bytes[0]).data(),
                       elements_of<std::uint32_t>(sections.bytes[1]).data(),
                       elements_of<std::uint32_t>(sections.bytes[2]).data(),
                       elements_of<std::uint32_t>(sections.bytes[3]).data(),
                       h.directory_origin,
                       {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    view.directory_dims[axis] = static_cast<std::int32_t>(h.directory_dims[axis]);
  }
  return view;
}

// Sections of a tree that the header does not announce.
Status check_absent(const TreeSections& sections, const char* field, std::string_view name) {
  for (const std::span<const std::byte> bytes : sections.bytes) {
    if (bytes.empty()) continue;
    return Error{ErrorCode::kSectionInvalid, name, sections.directory,
                 std::string(field) + " is zero, so the file must not have this tree",
                 "bake or copy it again"};
  }
  return {};
}

Status check_compliance(const VoxmapHeader& h, std::span<const float> pressures,
                        std::string_view name) {
  if (pressures.empty()) return {};
  const auto wrong = [&](const char* what) {
    return Error{ErrorCode::kSectionInvalid, name, "compliance", what, "bake or copy it again"};
  };
  if (!has_distances(h)) return wrong("needs stored distances, but the file has none");
  const double deepest_m = h.zero_force_m + (h.distance_zero_code + 1.0) * h.distance_quantum_m;
  if (static_cast<double>(pressures.size() - 1) * h.distance_quantum_m > deepest_m) {
    return wrong("is deeper than the stored distances");
  }
  for (std::size_t i = 0; i < pressures.size(); ++i) {
    const float smallest = i == 0 ? 0.0f : pressures[i - 1];
    const float largest = i == 0 ? 0.0f : kMaxCompliancePa;
    const double steep_pa = kMaxCompliancePaPerM * h.distance_quantum_m;
    const bool steep = pressures[i] - smallest > steep_pa;
    if (pressures[i] >= smallest && pressures[i] <= largest && !steep) continue;
    return Error{ErrorCode::kEntryInvalid, name, "compliance entry " + std::to_string(i),
                 i == 0 ? "is not 0, but the pressure must begin at the zero-force surface"
                        : "is less than the pressure before it, is above 1e9 Pa, or rises by more "
                          "than 1e15 Pa/m",
                 "bake or copy it again"};
  }
  if (!(pressures.back() > 0)) return wrong("has no pressure at any depth");
  return {};
}

}  // namespace

Result<Voxmap> Voxmap::open(const std::filesystem::path& path, Verify verify) {
  auto file = FileBytes::read(path);
  if (!file) return file.error();
  return from_file(std::move(*file), path.string(), verify);
}

Result<Voxmap> Voxmap::from_file(FileBytes file, std::string_view name, Verify verify) {
  auto map = from_bytes(file.bytes(), name, verify);
  if (map) map->file_ = std::move(file);
  return map;
}

Result<Voxmap> Voxmap::from_bytes(std::span<const std::byte> bytes, std::string_view name,
                                  Verify verify) {
  if (Status s = check_file_header(bytes, name, kVoxmapHeaderRule); !s) return s.error();
  Voxmap map;
  map.bytes_ = bytes;
  map.header_ = reinterpret_cast<const VoxmapHeader*>(bytes.data());
  const VoxmapHeader& h = *map.header_;
  if (Status s = check_header_fields(h, name); !s) return s.error();

  const auto rules = voxmap_section_rules();
  const auto sections = check_sections(bytes, name, kVoxmapHeaderRule, rules);
  if (!sections) return sections.error();
  if (verify == Verify::kStructureAndChecksums) {
    if (Status s = check_section_checksums(bytes, name, rules); !s) return s.error();
  }
  if (Status s = map.read_trees(*sections, name); !s) return s.error();
  if (!(*sections)[4].empty()) {
    return Error{ErrorCode::kSectionInvalid, name, "compliance",
                 "states newtons for a shell point of any area, but this program reads pascals",
                 "bake the scene again with a pressure, such as --compliance 2mm:5kPa"};
  }
  map.compliance_ = elements_of<float>((*sections)[15]);
  map.provenance_ = {reinterpret_cast<const char*>((*sections)[5].data()), (*sections)[5].size()};
  if (Status s = check_compliance(h, map.compliance_, name); !s) return s.error();
  if (Status s = map.read_names((*sections)[14], name); !s) return s.error();
  return map;
}

Status Voxmap::read_trees(std::span<const std::span<const std::byte>> sections,
                          std::string_view name) {
  const VoxmapHeader& h = *header_;
  const TreeSections values{"directory", "upper nodes", "lower nodes", sections.subspan(0, 4)};
  const EntryRule value_rule{0, 0xff, 3, kMaxClearance << 8};
  if (Status s = check_tree(h, values, kValueBits, value_rule, name, value_counts_); !s) return s;
  view_ = view_of<kValueBits>(h, values);

  const TreeSections distances{"distance directory", "distance upper nodes", "distance lower nodes",
                               sections.subspan(6, 4)};
  if (!has_distances(h)) {
    if (Status s = check_absent(distances, "distance_quantum_m", name); !s) return s;
  } else {
    const EntryRule rule{0, 0xffff, kMaxDistanceCode, 0};
    if (Status s = check_tree(h, distances, kDistanceBits, rule, name, distance_counts_); !s) {
      return s;
    }
    distances_ = view_of<kDistanceBits>(h, distances);
  }
  const TreeSections objects{"object directory", "object upper nodes", "object lower nodes",
                             sections.subspan(10, 4)};
  if (h.object_count == 0) return check_absent(objects, "object_count", name);
  const EntryRule rule{0, 0xffff, h.object_count, 0};
  objects_ = view_of<kObjectBits>(h, objects);
  return check_tree(h, objects, kObjectBits, rule, name, object_counts_);
}

Status Voxmap::read_names(std::span<const std::byte> names, std::string_view name) {
  const std::string_view text(reinterpret_cast<const char*>(names.data()), names.size());
  const auto wrong = [&](std::string_view what) {
    return Error{ErrorCode::kSectionInvalid, name, "object names", what, "bake or copy it again"};
  };
  if (!text.empty() && text.back() != '\0') return wrong("the last name has no end mark");
  const auto count = static_cast<std::uint64_t>(std::count(text.begin(), text.end(), '\0'));
  if (count != header_->object_count) {
    return wrong("has " + std::to_string(count) + " names, but the header requires " +
                 std::to_string(header_->object_count));
  }
  object_names_.reserve(count);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\0', begin);
    object_names_.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return {};
}

std::string_view Voxmap::object_name(std::uint32_t object) const {
  return object >= 1 && object <= object_names_.size() ? object_names_[object - 1]
                                                       : std::string_view();
}

std::optional<std::array<std::int32_t, 3>> Voxmap::in_directory(std::int64_t i, std::int64_t j,
                                                                std::int64_t k) const {
  const std::array<std::int64_t, 3> world{i, j, k};
  std::array<std::int32_t, 3> relative{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t origin = header_->directory_origin[axis];
    const std::int64_t extent = std::int64_t{header_->directory_dims[axis]} * kUpperNodeEdge;
    if (world[axis] < origin || world[axis] >= origin + extent) return std::nullopt;
    relative[axis] = static_cast<std::int32_t>(world[axis] - origin);
  }
  return relative;
}

VoxelValue Voxmap::value(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const auto at = in_directory(i, j, k);
  if (!at) return VoxelValue::kFree;
  return static_cast<VoxelValue>(view_.lookup((*at)[0], (*at)[1], (*at)[2]).code);
}

std::uint32_t Voxmap::nearest_object(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const auto at = in_directory(i, j, k);
  if (!at || objects() == nullptr) return 0;
  return objects_.lookup((*at)[0], (*at)[1], (*at)[2]).code;
}

std::uint32_t Voxmap::distance_code(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const auto at = in_directory(i, j, k);
  return at ? distances_.lookup((*at)[0], (*at)[1], (*at)[2]).code : kMaxDistanceCode;
}

double Voxmap::min_distance_m(std::int64_t i, std::int64_t j, std::int64_t k) const {
  if (distances() == nullptr) return -std::numeric_limits<double>::infinity();
  return forcelayer::min_distance_m(*header_, distance_code(i, j, k));
}

double Voxmap::max_distance_m(std::int64_t i, std::int64_t j, std::int64_t k) const {
  if (distances() == nullptr) return std::numeric_limits<double>::infinity();
  return forcelayer::max_distance_m(*header_, distance_code(i, j, k));
}

double steepest_pa_per_m(const Voxmap& map) {
  const std::span<const float> pressures = map.compliance();
  double steepest_pa = 0;
  for (std::size_t i = 1; i < pressures.size(); ++i) {
    steepest_pa = std::max(steepest_pa, double{pressures[i]} - double{pressures[i - 1]});
  }
  return steepest_pa / map.header().distance_quantum_m;
}

}  // namespace forcelayer
