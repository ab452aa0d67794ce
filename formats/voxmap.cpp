#include "formats/voxmap.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "formats/field_check.h"
#include "formats/voxmap_sections.h"

namespace forcelayer {
namespace {

bool is_voxel_index(std::int64_t index) {
  return index >= -kMaxVoxelIndex && index <= kMaxVoxelIndex;
}

void check_encoding_fields(const VoxmapHeader& h, FieldChecks& checks) {
  checks.require(h.metric <= static_cast<std::uint32_t>(Metric::kEuclidean),
                 offsetof(VoxmapHeader, metric), "metric", "is not a metric that this version has");
  checks.require(h.bits_per_voxel == 2 || h.bits_per_voxel == 4 || h.bits_per_voxel == 8,
                 offsetof(VoxmapHeader, bits_per_voxel), "bits_per_voxel", "is not 2, 4 or 8");
  if (!checks.status()) return;
  if (h.bits_per_voxel == 2) {
    checks.require(h.range_m == 0, offsetof(VoxmapHeader, range_m), "range_m",
                   "is not zero at 2 bits");
    checks.require(h.quantum_m == 0, offsetof(VoxmapHeader, quantum_m), "quantum_m",
                   "is not zero at 2 bits");
    checks.require((h.zero_code | h.surface_code | h.proximity_code | h.free_code) == 0,
                   offsetof(VoxmapHeader, zero_code), "zero_code and thresholds",
                   "are not zero at 2 bits");
    return;
  }
  const std::uint32_t max_code = (1u << h.bits_per_voxel) - 1;
  checks.require(std::isfinite(h.range_m) && h.range_m > 0, offsetof(VoxmapHeader, range_m),
                 "range_m", "is not a positive length");
  checks.require(std::isfinite(h.quantum_m) && h.quantum_m > 0 && h.quantum_m <= h.range_m,
                 offsetof(VoxmapHeader, quantum_m), "quantum_m",
                 "is not a positive length within the range");
  checks.require(h.zero_code <= max_code, offsetof(VoxmapHeader, zero_code), "zero_code",
                 "is above the highest code");
  checks.require(h.surface_code > 0, offsetof(VoxmapHeader, surface_code), "surface_code",
                 "leaves no code to the interior");
  checks.require(h.proximity_code > h.surface_code, offsetof(VoxmapHeader, proximity_code),
                 "proximity_code", "is not above surface_code");
  checks.require(h.free_code > h.proximity_code && h.free_code <= max_code,
                 offsetof(VoxmapHeader, free_code), "free_code",
                 "is not above proximity_code or above the highest code");
}

void check_directory_fields(const VoxmapHeader& h, FieldChecks& checks) {
  std::uint64_t entries = 1;
  bool any_zero = false, all_zero = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t origin = h.directory_origin[axis];
    checks.require(origin % kUpperNodeEdge == 0 && is_voxel_index(origin),
                   offsetof(VoxmapHeader, directory_origin) + 8 * axis, "directory_origin",
                   "is not a multiple of 512 or beyond 2^52 voxels");
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
      checks.require(origin == 0, origin_at, "origin_voxel", "is not zero where all is free");
      continue;
    }
    const std::int64_t low = h.directory_origin[axis];
    const std::int64_t extent = std::int64_t{h.directory_dims[axis]} * kUpperNodeEdge;
    checks.require(origin >= low && origin < low + extent, origin_at, "origin_voxel",
                   "lies outside the directory");
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
    checks.require(count <= left, offset, field, "is more than the box of non-free voxels holds");
    if (checks.status()) left -= count;
  };
  take(h.interior_voxels, offsetof(VoxmapHeader, interior_voxels), "interior_voxels");
  take(h.surface_voxels, offsetof(VoxmapHeader, surface_voxels), "surface_voxels");
  take(h.proximity_voxels, offsetof(VoxmapHeader, proximity_voxels), "proximity_voxels");
  const bool any = (h.interior_voxels | h.surface_voxels | h.proximity_voxels) != 0;
  checks.require(any == (h.dims_voxels[0] != 0), offsetof(VoxmapHeader, interior_voxels),
                 "interior_voxels, surface_voxels, proximity_voxels",
                 "do not agree with dims_voxels on whether all is free");
}

// Compiled for size: it runs once a file, between loops over the whole file.
[[gnu::cold]] Status check_header_fields(const VoxmapHeader& h, std::string_view name) {
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
  if (!is_newer_minor(h.file)) {
    checks.require(h.reserved0 == 0, offsetof(VoxmapHeader, reserved0), "reserved", "is not zero");
    checks.require(std::all_of(h.reserved.begin(), h.reserved.end(), [](auto b) { return b == 0; }),
                   offsetof(VoxmapHeader, reserved), "reserved", "is not zero");
  }
  return checks.status();
}

// The entries that a level of the tree may have.
struct EntryRule {
  std::uint64_t child_count;   // elements of the next level's section
  std::uint32_t max_code;      // 2^bits_per_voxel - 1
  std::uint32_t lowest_free;   // of the codes that mean free: 0 at 2 bits, else free_code
  std::uint32_t highest_free;  // 0 at 2 bits, else max_code
};

// Whether an entry breaks the rule. Without branches, so that the loop below is vectorized.
bool is_bad_entry(std::uint32_t entry, const EntryRule& rule) {
  const std::uint32_t value = uniform_value(entry);
  const bool free = (value >= rule.lowest_free) & (value <= rule.highest_free);
  const bool bad_value = (value > rule.max_code) | (!free & (uniform_clearance(entry) != 0));
  const bool bad_child = entry >= rule.child_count;
  return is_uniform(entry) ? bad_value : bad_child;
}

[[gnu::cold]] std::string describe_bad_entry(std::uint32_t entry, const EntryRule& rule) {
  if (!is_uniform(entry)) {
    return "child index " + std::to_string(entry) + " of " + std::to_string(rule.child_count) +
           " children";
  }
  if (uniform_value(entry) > rule.max_code) {
    return "value " + std::to_string(uniform_value(entry)) + " is above " +
           std::to_string(rule.max_code);
  }
  return "reserved bits of a value that is not free are not zero";
}

Status check_entries(std::span<const std::uint32_t> entries, const EntryRule& rule,
                     std::string_view name, const char* section) {
  constexpr std::size_t kChunk = 4096;
  for (std::size_t begin = 0; begin < entries.size(); begin += kChunk) {
    const auto chunk = entries.subspan(begin, std::min(kChunk, entries.size() - begin));
    unsigned bad = 0;
    for (const std::uint32_t entry : chunk) bad |= is_bad_entry(entry, rule);
    if (bad == 0) continue;
    const auto found = std::find_if(chunk.begin(), chunk.end(),
                                    [&](std::uint32_t entry) { return is_bad_entry(entry, rule); });
    const std::size_t index = begin + static_cast<std::size_t>(found - chunk.begin());
    const std::string where = std::string(section) + " entry " + std::to_string(index);
    return Error{ErrorCode::kEntryInvalid, std::string(name), where,
                 describe_bad_entry(*found, rule), "bake or copy it again"};
  }
  return {};
}

Status check_directory_size(const VoxmapHeader& h, std::size_t entries, std::string_view name) {
  const std::uint64_t wanted =
      std::uint64_t{h.directory_dims[0]} * h.directory_dims[1] * h.directory_dims[2];
  if (entries == wanted) return {};
  return Error{ErrorCode::kSectionInvalid, std::string(name), "directory",
               std::to_string(entries) + " entries where the header says " + std::to_string(wanted),
               "bake or copy it again"};
}

Status check_compliance(const VoxmapHeader& h, std::span<const float> forces,
                        std::string_view name) {
  if (forces.empty()) return {};
  const auto wrong = [&](const char* what) {
    return Error{ErrorCode::kSectionInvalid, std::string(name), "compliance", what,
                 "bake or copy it again"};
  };
  if (h.bits_per_voxel == 2) return wrong("stands in a file of 2 bits, which has no depths");
  if (forces.size() > std::size_t{h.zero_code} + 1)
    return wrong("has more entries than the codes have depths");
  for (std::size_t i = 0; i < forces.size(); ++i) {
    const float least = i == 0 ? 0.0f : forces[i - 1];
    const float most = i == 0 ? 0.0f : kMostComplianceN;
    const double steep_n = kMostComplianceNPerM * h.quantum_m;
    if (forces[i] >= least && forces[i] <= most && forces[i] - least <= steep_n) continue;
    return Error{ErrorCode::kEntryInvalid, std::string(name),
                 "compliance entry " + std::to_string(i),
                 i == 0 ? "is not 0: the force begins at the zero-force surface"
                        : "is below the entry before it, above 1e6 N, or steeper than 1e12 N/m",
                 "bake or copy it again"};
  }
  if (!(forces.back() > 0)) return wrong("has no force at any depth");
  return {};
}

}  // namespace

Result<Voxmap> Voxmap::open(const std::filesystem::path& path, Verify verify) {
  auto file = MappedFile::open_for_long(path);
  if (!file) return file.error();
  return from_file(std::move(*file), path.string(), verify);
}

Result<Voxmap> Voxmap::from_file(MappedFile file, std::string_view name, Verify verify) {
  auto map = read(file.bytes(), name, verify, &file);
  if (map) map->file_ = std::move(file);
  return map;
}

Result<Voxmap> Voxmap::from_bytes(std::span<const std::byte> bytes, std::string_view name,
                                  Verify verify) {
  return read(bytes, name, verify, nullptr);
}

Result<Voxmap> Voxmap::read(std::span<const std::byte> bytes, std::string_view name, Verify verify,
                            const MappedFile* file) {
  if (Status s = check_file_header(bytes, name, kVoxmapHeaderRule); !s) return s.error();
  Voxmap map;
  map.bytes_ = bytes;
  map.header_ = reinterpret_cast<const VoxmapHeader*>(bytes.data());
  const VoxmapHeader& h = *map.header_;
  if (Status s = check_header_fields(h, name); !s) return s.error();

  const auto rules = voxmap_section_rules(h.bits_per_voxel);
  const auto sections = check_sections(bytes, name, rules);
  if (!sections) return sections.error();
  if (verify == Verify::kStructureAndChecksums) {
    if (Status s = check_section_checksums(bytes, name, rules, file); !s) return s.error();
  }
  const auto directory = elements_of<std::uint32_t>((*sections)[0]);
  const auto upper_nodes = elements_of<std::uint32_t>((*sections)[1]);
  const auto lower_nodes = elements_of<std::uint32_t>((*sections)[2]);
  map.upper_node_count_ = upper_nodes.size() / kNodeEntries;
  map.lower_node_count_ = lower_nodes.size() / kNodeEntries;
  map.brick_count_ = (*sections)[3].size() / brick_bytes(h.bits_per_voxel);
  map.compliance_ = elements_of<float>((*sections)[4]);
  map.provenance_ = {reinterpret_cast<const char*>((*sections)[5].data()), (*sections)[5].size()};
  if (Status s = map.check_tree(directory, upper_nodes, lower_nodes, name); !s) return s.error();
  if (Status s = check_compliance(h, map.compliance_, name); !s) return s.error();
  map.view_ = {directory.data(),   upper_nodes.data(),
               lower_nodes.data(), elements_of<std::uint32_t>((*sections)[3]).data(),
               h.directory_origin, {},
               h.bits_per_voxel};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    map.view_.directory_dims[axis] = static_cast<std::int32_t>(h.directory_dims[axis]);
  }
  return map;
}

Status Voxmap::check_tree(std::span<const std::uint32_t> directory,
                          std::span<const std::uint32_t> upper_nodes,
                          std::span<const std::uint32_t> lower_nodes, std::string_view name) const {
  if (Status s = check_directory_size(*header_, directory.size(), name); !s) return s;
  const std::uint32_t max_code = (1u << header_->bits_per_voxel) - 1;
  const std::uint32_t lowest_free = lowest_free_code(*header_);
  EntryRule rule{upper_node_count_, max_code, lowest_free, lowest_free == 0 ? 0 : max_code};
  if (Status s = check_entries(directory, rule, name, "directory"); !s) return s;
  rule.child_count = lower_node_count_;
  if (Status s = check_entries(upper_nodes, rule, name, "upper nodes"); !s) return s;
  rule.child_count = brick_count_;
  return check_entries(lower_nodes, rule, name, "lower nodes");
}

VoxelValue Voxmap::value(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const std::array<std::int64_t, 3> world{i, j, k};
  std::array<std::int32_t, 3> relative{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t origin = header_->directory_origin[axis];
    const std::int64_t extent = std::int64_t{header_->directory_dims[axis]} * kUpperNodeEdge;
    if (world[axis] < origin || world[axis] >= origin + extent) return VoxelValue::kFree;
    relative[axis] = static_cast<std::int32_t>(world[axis] - origin);
  }
  return voxel_value(*header_, view_.lookup(relative[0], relative[1], relative[2]).code);
}

double steepest_n_per_m(const Voxmap& map) {
  const std::span<const float> forces = map.compliance();
  double steepest_n = 0;
  for (std::size_t i = 1; i < forces.size(); ++i) {
    steepest_n = std::max(steepest_n, double{forces[i]} - double{forces[i - 1]});
  }
  return steepest_n / map.header().quantum_m;
}

}  // namespace forcelayer
