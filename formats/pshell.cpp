#include "formats/pshell.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "formats/bulk_checks.h"
#include "formats/field_check.h"
#include "formats/pshell_sections.h"
#include "formats/voxmap_format.h"

namespace forcelayer {
namespace {

// The error for an element of a section that breaks its rule.
Error entry_error(std::string_view name, const std::string& section, std::size_t index,
                  std::string_view what) {
  return {ErrorCode::kEntryInvalid, name, section + " entry " + std::to_string(index), what,
          "bake or copy it again"};
}

std::uint64_t ceil_div(std::uint64_t a, std::uint64_t b) { return a / b + (a % b != 0); }

void check_block_fields(const PshellHeader& h, FieldChecks& checks) {
  checks.require(h.point_count > 0 && h.point_count <= kMaxShellPoints,
                 offsetof(PshellHeader, point_count), "point_count", "is not between 1 and 2^31");
  checks.require(h.block_points > 0 && h.block_points <= kMaxBlockPoints &&
                     h.block_points % kBlockPointsMultiple == 0,
                 offsetof(PshellHeader, block_points), "block_points",
                 "is not a multiple of 16 between 16 and 4096");
  checks.require(h.super_block_blocks > 0 && h.super_block_blocks <= kMaxSuperBlockBlocks,
                 offsetof(PshellHeader, super_block_blocks), "super_block_blocks",
                 "is not between 1 and 4096");
  if (!checks.status()) return;
  checks.require(h.block_count == ceil_div(h.point_count, h.block_points),
                 offsetof(PshellHeader, block_count), "block_count",
                 "does not agree with point_count and block_points");
  checks.require(h.super_block_count == ceil_div(h.block_count, h.super_block_blocks),
                 offsetof(PshellHeader, super_block_count), "super_block_count",
                 "does not agree with block_count and super_block_blocks");
}

void check_mass_fields(const PshellHeader& h, FieldChecks& checks) {
  checks.require(h.mass_source <= static_cast<std::uint32_t>(MassSource::kArea),
                 offsetof(PshellHeader, mass_source), "mass_source", "is not a known mass source");
  checks.require(is_finite_not_negative(h.area_m2), offsetof(PshellHeader, area_m2), "area_m2",
                 "must be finite and not negative");
  const bool from_volume = h.mass_source == static_cast<std::uint32_t>(MassSource::kVolume);
  checks.require(std::isfinite(h.volume_m3) && (from_volume ? h.volume_m3 > 0 : h.volume_m3 == 0),
                 offsetof(PshellHeader, volume_m3), "volume_m3",
                 from_volume ? "is not a positive, finite volume"
                             : "must be zero, because the mass is computed from the area");
  for (std::size_t i = 0; i < h.inertia_m2.size(); ++i) {
    const double moment = h.inertia_m2[i];
    checks.require(i < 3 ? is_finite_not_negative(moment) : std::isfinite(moment),
                   offsetof(PshellHeader, inertia_m2) + 8 * i, "inertia_m2",
                   "must be finite, and not negative on the diagonal");
  }
}

Status check_header_fields(const PshellHeader& h, std::string_view name) {
  FieldChecks checks(name);
  check_block_fields(h, checks);
  checks.require(h.voxel_size_m >= kMinVoxelSizeM && h.voxel_size_m <= kMaxVoxelSizeM,
                 offsetof(PshellHeader, voxel_size_m), "voxel_size_m",
                 "is not between 1e-9 and 1e6 meters");
  checks.require(is_finite_not_negative(h.covering_radius_m),
                 offsetof(PshellHeader, covering_radius_m), "covering_radius_m",
                 "is not a finite length");
  checks.require(is_finite_not_negative(h.bounding_radius_m) &&
                     h.bounding_radius_m <= kMaxRadiusVoxels * h.voxel_size_m,
                 offsetof(PshellHeader, bounding_radius_m), "bounding_radius_m",
                 "is not a finite length, or is above 2^20 voxels");
  checks.require(is_finite_not_negative(h.part_deviation_m),
                 offsetof(PshellHeader, part_deviation_m), "part_deviation_m",
                 "is not a finite length");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    checks.require(std::isfinite(h.center_m[axis]), offsetof(PshellHeader, center_m) + 8 * axis,
                   "center_m", "is not finite");
  }
  check_mass_fields(h, checks);
  checks.require(h.method <= static_cast<std::uint32_t>(ShellMethod::kSurface),
                 offsetof(PshellHeader, method), "method", "is not a known method");
  checks.require(is_finite_not_negative(h.convex_radius_m), offsetof(PshellHeader, convex_radius_m),
                 "convex_radius_m", "is not a finite length");
  checks.require(is_finite_not_negative(h.convex_gap_m), offsetof(PshellHeader, convex_gap_m),
                 "convex_gap_m", "is not a finite length");
  if (!is_newer_minor(h.file, kPshellHeaderRule)) {
    checks.require(std::all_of(h.reserved.begin(), h.reserved.end(), [](auto b) { return b == 0; }),
                   offsetof(PshellHeader, reserved), "reserved", "is not zero");
  }
  return checks.status();
}

Status check_section_sizes(const PshellHeader& h, std::span<const std::span<const std::byte>> all,
                           std::span<const SectionRule> rules, std::string_view name) {
  const std::uint64_t stored = h.block_count * h.block_points;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const bool any_size = rules[i].id == static_cast<std::uint32_t>(PshellSection::kProvenance) ||
                          rules[i].id == static_cast<std::uint32_t>(PshellSection::kLosses);
    if (any_size || (!rules[i].required && all[i].empty())) continue;
    const bool blocks = rules[i].id == static_cast<std::uint32_t>(PshellSection::kBlocks);
    const bool super = rules[i].id == static_cast<std::uint32_t>(PshellSection::kSuperBlocks);
    const std::uint64_t wanted = blocks ? h.block_count : super ? h.super_block_count : stored;
    const std::uint64_t actual = all[i].size() / rules[i].element_bytes;
    if (actual == wanted) continue;
    return Error{ErrorCode::kSectionInvalid, name, rules[i].name,
                 "has " + std::to_string(actual) + " elements, but the header requires " +
                     std::to_string(wanted),
                 "bake or copy it again"};
  }
  return {};
}

bool is_finite_sphere(const BoundingSphere& s) {
  return std::isfinite(s.x) && std::isfinite(s.y) && std::isfinite(s.z) &&
         std::isfinite(s.radius) && s.radius >= 0;
}

Status check_spheres(const PshellView& v, std::span<const BoundingSphere> spheres,
                     std::uint64_t points_each, const std::string& section, std::string_view name) {
  const std::uint64_t stored = v.block_count * v.block_points;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    if (!is_finite_sphere(spheres[i])) {
      return entry_error(name, section, i, "the sphere is not finite, or its radius is negative");
    }
    const std::uint64_t begin = i * points_each;
    if (!holds_points(spheres[i], v, begin, std::min(stored, begin + points_each))) {
      return entry_error(name, section, i, "the sphere does not contain all of its points");
    }
  }
  return {};
}

Status check_points(const PshellView& v, double bounding_radius_m, std::string_view name) {
  const PointsChecked checked = check_points(v, bounding_radius_m);
  switch (checked.fault) {
    case PointFault::kPosition:
      return entry_error(name, "x, y, z", checked.bad,
                         "the point is not finite, or is beyond the bounding radius");
    case PointFault::kNormal:
      return entry_error(name, "normals", checked.bad, "the normal is not of unit length");
    case PointFault::kWeight:
      return entry_error(name, "weight", checked.bad, "the weight must be finite and not negative");
    case PointFault::kCone:
      return entry_error(name, "normal cones", checked.bad, "the cosine is not between -1 and 1");
    case PointFault::kSides:
      return entry_error(name, "two-sided points", checked.bad, "is neither 0 nor 1");
    case PointFault::kNone:
      break;
  }
  if (checked.area_m2 > 0) return {};
  return entry_error(name, "weight", 0, "every weight is zero, so no contact would have a force");
}

// Elements beyond point_count repeat the last point, bit for bit, with weight zero.
Status check_padding_points(const PshellView& v, std::string_view name) {
  const std::size_t last = v.point_count - 1;
  const float* const columns[] = {v.x, v.y, v.z, v.nx, v.ny, v.nz, v.cone_cos};
  const auto bits = [](float number) { return std::bit_cast<std::uint32_t>(number); };
  for (std::size_t i = v.point_count; i < v.block_count * v.block_points; ++i) {
    const bool repeats = std::all_of(std::begin(columns), std::end(columns), [&](const float* c) {
      return c == nullptr || bits(c[i]) == bits(c[last]);
    });
    const bool same_sides = !v.two_sided || v.two_sided[i] == v.two_sided[last];
    if (!repeats || !same_sides || bits(v.weight_m2[i]) != 0) {
      return entry_error(name, "point sections", i,
                         "the padding must repeat the last point, but with weight zero");
    }
  }
  return {};
}

// Entries ascend, and what is proven grows with the distance at least as fast as the distance.
Status check_losses(std::span<const DistanceLoss> losses, std::string_view name) {
  if (losses.size() > kMaxLosses) {
    return Error{ErrorCode::kSectionInvalid, name, "losses",
                 "has " + std::to_string(losses.size()) + " entries, but at most " +
                     std::to_string(kMaxLosses) + " are allowed",
                 "bake or copy it again"};
  }
  for (std::size_t i = 0; i < losses.size(); ++i) {
    const DistanceLoss& own = losses[i];
    if (!(std::isfinite(own.distance_m) && own.loss_m >= 0 && own.loss_m <= own.distance_m)) {
      return entry_error(
          name, "losses", i,
          "the distance must be finite, and the loss must be between zero and the distance");
    }
    if (i > 0 &&
        !(own.distance_m > losses[i - 1].distance_m && own.loss_m <= losses[i - 1].loss_m)) {
      return entry_error(name, "losses", i,
                         "the distance must be above the previous distance, and the loss must not "
                         "be above the previous loss");
    }
  }
  return {};
}

Status check_elements(const PshellView& v, const PshellHeader& h, std::string_view name) {
  if (Status s = check_points(v, h.bounding_radius_m, name); !s) return s;
  if (Status s = check_padding_points(v, name); !s) return s;
  const std::uint64_t block_points = v.block_points;
  if (Status s = check_spheres(v, {v.blocks, v.block_count}, block_points, "blocks", name); !s) {
    return s;
  }
  return check_spheres(v, {v.super_blocks, v.super_block_count},
                       block_points * v.super_block_blocks, "super-blocks", name);
}

}  // namespace

SurfaceDistanceTerms Pshell::surface_distance_terms() const {
  return {header_->covering_radius_m, header_->convex_radius_m, header_->convex_gap_m, losses_};
}

Result<Pshell> Pshell::open(const std::filesystem::path& path, Verify verify) {
  auto file = FileBytes::read(path);
  if (!file) return file.error();
  return from_file(std::move(*file), path.string(), verify);
}

Result<Pshell> Pshell::from_file(FileBytes file, std::string_view name, Verify verify) {
  auto shell = from_bytes(file.bytes(), name, verify);
  if (shell) shell->file_ = std::move(file);
  return shell;
}

Result<Pshell> Pshell::from_bytes(std::span<const std::byte> bytes, std::string_view name,
                                  Verify verify) {
  if (Status s = check_file_header(bytes, name, kPshellHeaderRule); !s) return s.error();
  Pshell shell;
  shell.bytes_ = bytes;
  shell.header_ = reinterpret_cast<const PshellHeader*>(bytes.data());
  const PshellHeader& h = *shell.header_;
  if (Status s = check_header_fields(h, name); !s) return s.error();

  const auto rules = pshell_section_rules();
  const auto sections = check_sections(bytes, name, kPshellHeaderRule, rules);
  if (!sections) return sections.error();
  if (verify == Verify::kStructureAndChecksums) {
    if (Status s = check_section_checksums(bytes, name, rules); !s) return s.error();
  }
  const auto& all = *sections;
  if (Status s = check_section_sizes(h, all, rules, name); !s) return s.error();
  const auto column = [&](std::size_t i) { return elements_of<float>(all[i]).data(); };
  shell.view_ = {
      .point_count = h.point_count,
      .block_points = h.block_points,
      .super_block_blocks = h.super_block_blocks,
      .block_count = h.block_count,
      .super_block_count = h.super_block_count,
      .x = column(0),
      .y = column(1),
      .z = column(2),
      .nx = column(3),
      .ny = column(4),
      .nz = column(5),
      .weight_m2 = column(6),
      .blocks = elements_of<BoundingSphere>(all[7]).data(),
      .super_blocks = elements_of<BoundingSphere>(all[8]).data(),
      .cone_cos = all[9].empty() ? nullptr : column(9),
      .two_sided = all[12].empty() ? nullptr : elements_of<std::uint8_t>(all[12]).data()};
  shell.provenance_ = {reinterpret_cast<const char*>(all[11].data()), all[11].size()};
  shell.losses_ = elements_of<DistanceLoss>(all[10]);
  if (Status s = check_losses(shell.losses_, name); !s) return s.error();
  if (Status s = check_elements(shell.view_, h, name); !s) return s.error();
  return shell;
}

}  // namespace forcelayer
