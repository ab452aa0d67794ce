#include "pointshell/report.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "formats/mesh/missing_faces.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/up_axis.h"

namespace forcelayer::pointshell {
namespace {

nlohmann::ordered_json json_of(const std::vector<normals::Sheet>& sheets) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const normals::Sheet& sheet : sheets) {
    rows.push_back({{"body", sheet.body},
                    {"triangles", sheet.triangles},
                    {"area_m2", sheet.area_m2},
                    {"center_m", {sheet.middle.x, sheet.middle.y, sheet.middle.z}},
                    {"size_m", sheet.size_m}});
  }
  return rows;
}

// "2.5 minutes", "1 minute", "40 s"
std::string duration_text(double seconds) {
  char text[40];
  if (seconds < 60) {
    std::snprintf(text, sizeof text, "%.0f s", seconds);
    return text;
  }
  std::snprintf(text, sizeof text, "%.2g", seconds / 60);
  return std::string(text) + (std::string_view(text) == "1" ? " minute" : " minutes");
}

}  // namespace

std::string part_hash(const part::Part& part) {
  XXH64_hash_t hash = XXH3_64bits(part.vertices.data(), part.vertices.size() * sizeof(part::Vec3));
  hash = XXH3_64bits_withSeed(part.triangles.data(), part.triangles.size() * sizeof(mesh::Triangle),
                              hash);
  hash = XXH3_64bits_withSeed(part.body.data(), part.body.size() * sizeof(std::uint32_t), hash);
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

const char* method_name(ShellMethod method) {
  return method == ShellMethod::kSurface ? "surface" : "voxel-centers";
}

const char* effort_name(sample::Effort effort) {
  return effort == sample::Effort::kFast ? "fast" : "full";
}

std::string provenance(const part::Part& part, const ShellOptions& options) {
  nlohmann::ordered_json json{{"tool", "pointshell"},
                              {"part_xxh3", part_hash(part)},
                              {"method", method_name(options.method)},
                              {"voxel_size_m", options.voxel_size_m},
                              {"covering_radius_m", requested_covering_radius(options)},
                              {"mesh_deviation_m", options.mesh_deviation_m}};
  if (options.method == ShellMethod::kSurface) json["effort"] = effort_name(options.effort);
  if (!part.missing_faces.empty()) json["missing_faces"] = mesh::json_of(part.missing_faces);
  if (part.up) json["up"] = mesh::name_of(*part.up);
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string cost_warning(const BakeCost& cost, const ShellOptions& options,
                         const part::Part& part) {
  constexpr double kMinute = 60, kGigabyte = 1e9;
  if (cost.seconds <= kMinute && cost.bytes <= kGigabyte) return "";
  char text[240];
  std::snprintf(text, sizeof text,
                "%.2g points for %s take about %s and %.2g GB; a larger voxel size%s%s takes less",
                cost.points, mesh::counted(part.triangles.size(), "triangle").c_str(),
                duration_text(cost.seconds).c_str(), cost.bytes / kGigabyte,
                options.effort == sample::Effort::kFast ? "" : ", --method fast",
                " or a coarser mesh");
  return text;
}

std::string sheet_warning(const BakedShell& shell) {
  constexpr std::size_t kListed = 4;
  const std::vector<normals::Sheet>& sheets = shell.orientation.sheets;
  if (sheets.empty()) {
    if (shell.header.mass_source == static_cast<std::uint32_t>(MassSource::kVolume)) return "";
    const std::uint64_t edges = shell.orientation.boundary_edges;
    const std::string where = edges == 0 ? "" : ", with " + mesh::counted(edges, "open edge");
    return "the surface is not a closed solid" + where + ": the mass is computed from the area";
  }
  std::string text = mesh::counted(sheets.size(), "open sheet") + ": ";
  for (std::size_t n = 0; n < std::min(sheets.size(), kListed); ++n) {
    const normals::Sheet& sheet = sheets[n];
    char place[160];
    std::snprintf(place, sizeof place, ", %.3g mm across, about x %.6g, y %.6g, z %.6g mm",
                  1e3 * sheet.size_m, 1e3 * sheet.middle.x, 1e3 * sheet.middle.y,
                  1e3 * sheet.middle.z);
    text += (n == 0 ? "" : "; ") + sheet.body + ", " + mesh::counted(sheet.triangles, "triangle") +
            place;
  }
  if (sheets.size() > kListed) text += "; ...";
  return text +
         ". Points of open sheets are two-sided: they need a scene with stored distances (baked "
         "without --kind), and voxrun --model default. The mass is computed from the area";
}

double points_over_bound(const PshellHeader& header, double area_m2) {
  return static_cast<double>(header.point_count) / planar_bound(area_m2, header.covering_radius_m);
}

nlohmann::ordered_json bake_report(const BakedShell& shell, const ShellOptions& options,
                                   const part::Part& part) {
  const PshellHeader& header = shell.header;
  nlohmann::ordered_json seconds;
  double total = 0;
  for (const auto& [stage, spent] : shell.stage_seconds) {
    seconds[stage] = spent;
    total += spent;
  }
  seconds["total"] = total;
  nlohmann::ordered_json losses = nlohmann::ordered_json::array();
  for (const DistanceLoss& entry : shell.losses) {
    losses.push_back({{"distance_m", entry.distance_m}, {"loss_m", entry.loss_m}});
  }
  nlohmann::ordered_json report{
      {"points", header.point_count},
      {"method", method_name(options.method)},
      {"covering_radius_m", header.covering_radius_m},
      {"convex_radius_m", header.convex_radius_m},
      {"convex_gap_m", header.convex_gap_m},
      {"losses", losses},
      {"corner_points", shell.corner_points},
      {"area_m2", header.area_m2},
      {"voxel_size_m", header.voxel_size_m},
      {"points_over_planar_bound", points_over_bound(header, shell.covered_area_m2)},
      {"hidden_points", shell.hidden_points},
      {"up", mesh::name_of(part.up.value_or(mesh::Up::kZ))},
      {"covered_area_m2", shell.covered_area_m2},
      {"triangles", header.triangles},
      {"bodies", part.body_names.size()},
      {"duplicate_triangles", part.duplicate_triangles},
      {"degenerate_triangles", part.degenerate_triangles},
      {"orientation",
       {{"patches", shell.orientation.patches},
        {"flipped_triangles", shell.orientation.flipped_triangles},
        {"hidden_triangles", shell.orientation.hidden_triangles},
        {"undecided_triangles", shell.orientation.undecided_triangles},
        {"loose_triangles", shell.loose_triangles},
        {"boundary_edges", shell.orientation.boundary_edges},
        {"nonmanifold_edges", shell.orientation.nonmanifold_edges}}},
      {"sheets", json_of(shell.orientation.sheets)},
      {"two_sided_points", std::count(shell.two_sided.begin(), shell.two_sided.end(), 1)},
      {"mass_source", header.mass_source == 0 ? "volume" : "area"},
      {"volume_m3", header.volume_m3},
      {"center_m", header.center_m},
      {"inertia_m2", header.inertia_m2},
      {"bounding_radius_m", header.bounding_radius_m},
      {"part_deviation_m", header.part_deviation_m},
      {"missing_faces", mesh::json_of(part.missing_faces)},
      {"mean_block_radius_voxels", shell.mean_block_radius_m / header.voxel_size_m},
      {"certificate_pieces", shell.certificate_pieces},
      {"loss_pieces", shell.loss_pieces}};
  if (options.method == ShellMethod::kSurface) report["effort"] = effort_name(options.effort);
  report["seconds"] = seconds;
  return report;
}

}  // namespace forcelayer::pointshell
