// The worth of shells: points, proof, normals, time and memory of both methods.
//
//   shell_bench [--mesh NAME]... [--voxels N]... [--models FOLDER] [--json FILE]
//
// By mesh and voxels across: the `pointshell` command as a user runs it (full and fast effort, and
// voxel centers), its shell proven again by `pointshell verify`, and the facts of the file.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "formats/pshell.h"
#include "pointshell/part/part_files.h"
#include "pointshell/part/triangle_tree.h"
#include "pointshell/report.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/process_run.h"
#include "tests/support/places.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Model {
  const char* name;
  const char* file;  // in the models folder; the project's own in its sample_data
  const char* units;
};
constexpr Model kModels[] = {{"bunny", "scan/stanford-bunny.obj", "m"},
                             {"dragon", "scan/dragon-100k.obj", "m"},
                             {"counter", "cad/counter.unitsmm.stl", "mm"},
                             {"block", "cad/large_block.stl", "mm"},
                             {"part", nullptr, "mm"}};

struct Method {
  const char* name;
  std::vector<std::string> options;
};
const std::vector<Method>& methods() {
  static const std::vector<Method> all = {
      {"surface", {}}, {"fast", {"--method", "fast"}}, {"centers", {"--method", "voxel-centers"}}};
  return all;
}

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

double angle_deg(const part::Vec3& a, const part::Vec3& b) {
  return std::atan2(part::length(part::cross(a, b)), part::dot(a, b)) * 180 / std::numbers::pi;
}

double longest_side(const part::Part& part) {
  part::Box box;
  for (const part::Vec3& v : part.vertices) box.grow(v);
  const part::Vec3 size = box.high - box.low;
  return std::max({size.x, size.y, size.z});
}

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

// The normal that the mesh itself has at the place nearest to a point: the mean of the faces that
// meet there, weighted by their angles. Slow and plain; nothing of the shell's own smoothing.
std::optional<part::Vec3> mesh_normal(const part::TriangleTree& tree, const part::Vec3& place,
                                      double same_place) {
  const part::Part& part = tree.part();
  const part::Vec3 foot = tree.nearest(place).point.position;
  part::Vec3 sum;
  tree.visit_near(foot, same_place, [&](std::uint32_t t) {
    const mesh::Triangle& c = part.triangles[t];
    const part::Vec3 corners[3] = {part.vertices[c[0]], part.vertices[c[1]], part.vertices[c[2]]};
    const part::Vec3 nearest = part::nearest_on_triangle(foot, corners[0], corners[1], corners[2]);
    const part::Vec3 normal = part::normalized(part::doubled_area_normal(part, t));
    if (part::length(nearest - foot) > same_place || part::length_squared(normal) == 0) return;
    double angle = std::numbers::pi;
    for (int n = 0; n < 3; ++n) {
      if (part::length(corners[n] - foot) > same_place) continue;
      angle = angle_deg(corners[(n + 1) % 3] - corners[n], corners[(n + 2) % 3] - corners[n]) *
              std::numbers::pi / 180;
    }
    sum += angle * normal;
  });
  if (part::length(sum) < 1e-3) return std::nullopt;  // faces back to back
  return part::normalized(sum);
}

// Facts of a shell's file.
struct ShellFacts {
  double weight_sum_m2 = 0;
  double mean_block_radius_m = 0;
  std::vector<double> normal_error_deg;  // against the mesh where each point stands
};

ShellFacts facts_of(const PshellView& view, const part::Vec3& center,
                    const part::TriangleTree& tree, double radius) {
  ShellFacts facts;
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    facts.weight_sum_m2 += view.weight_m2[n];
    const part::Vec3 place = center + part::Vec3{view.x[n], view.y[n], view.z[n]};
    const auto normal = mesh_normal(tree, place, 1e-4 * radius);
    const part::Vec3 outward{-view.nx[n], -view.ny[n], -view.nz[n]};
    if (normal) facts.normal_error_deg.push_back(angle_deg(outward, *normal));
  }
  for (std::uint64_t b = 0; b < view.block_count; ++b) {
    facts.mean_block_radius_m += view.blocks[b].radius / static_cast<double>(view.block_count);
  }
  return facts;
}

// One mesh at one resolution.
class MeshCase {
 public:
  MeshCase(const Model& model, const fs::path& models, const fs::path& folder, int voxels)
      : model_(model),
        mesh_(model.file ? (models / model.file).string()
                         : test::source_path("sample_data/part.obj")),
        shell_((folder / "part.pshell").string()),
        voxels_(voxels),
        part_(value_of(part::read_part({mesh_}, std::string_view(model.units) == "mm" ? 1e-3 : 1))
                  .part),
        voxel_size_m_(longest_side(part_) / voxels) {
    normals::orient_outwards(part_, voxel_size_m_);
  }

  void run(Json& rows) const {
    std::vector<Json> of_mesh;
    for (const Method& method : methods()) of_mesh.push_back(run(method));
    const double centers = of_mesh.back()["points"];
    for (Json& row : of_mesh) {
      row["fraction_of_voxel_centers"] = row["points"].get<double>() / centers;
      print(row);
      rows.push_back(std::move(row));
    }
  }

  static void print_header() {
    std::printf("%-8s %6s %-8s | %8s %6s %6s %6s | %7s %7s %7s | %8s %7s | %7s %7s %6s %7s\n",
                "mesh", "voxels", "method", "points", "rho/s", "bound", "share", "n50 deg", "n99",
                "max", "weights", "block/s", "wall s", "cpu s", "MB", "proof s");
  }

 private:
  Json run(const Method& method) const {
    std::vector<std::string> command = {test::command_path("pointshell"),
                                        mesh_,
                                        "--units",
                                        model_.units,
                                        "-o",
                                        shell_,
                                        "--quiet",
                                        "--voxel-size",
                                        number(voxel_size_m_) + "m"};
    command.insert(command.end(), method.options.begin(), method.options.end());
    const ProcessRun bake = run_process(command);
    const ProcessRun proof = run_process({test::command_path("pointshell"), "verify", shell_, mesh_,
                                          "--units", model_.units, "--quiet"});
    const Pshell shell = value_of(Pshell::open(shell_));
    const PshellHeader& header = shell.header();
    const part::TriangleTree tree(part_);
    const part::Vec3 center{header.center_m[0], header.center_m[1], header.center_m[2]};
    const ShellFacts facts = facts_of(shell.view(), center, tree, header.covering_radius_m);
    const Percentiles normals = percentiles(facts.normal_error_deg);
    Json row{{"mesh", model_.name},
             {"voxels", voxels_},
             {"method", method.name},
             {"points", header.point_count},
             {"radius_voxels", header.covering_radius_m / header.voxel_size_m},
             {"points_over_bound", pointshell::points_over_bound(header, header.area_m2)},
             {"fraction_of_voxel_centers", nullptr},
             {"normal_p50_deg", normals.p50},
             {"normal_p99_deg", normals.p99},
             {"normal_max_deg", normals.max},
             {"weights_over_area", facts.weight_sum_m2 / header.area_m2},
             {"block_voxels", facts.mean_block_radius_m / header.voxel_size_m},
             {"wall_s", bake.wall_s},
             {"cpu_s", bake.cpu_s},
             {"peak_bytes", bake.peak_rss_bytes},
             {"proof_s", proof.wall_s},
             {"file_bytes", fs::file_size(shell_)}};
    return row;
  }

  static void print(const Json& row) {
    const auto get = [&](const char* key) { return row[key].get<double>(); };
    std::printf(
        "%-8s %6d %-8s | %8.0f %6.4f %6.3f %5.1f%% | %7.2f %7.2f %7.2f | %8.5f %7.2f | %7.2f "
        "%7.2f %6.0f %7.2f\n",
        row["mesh"].get<std::string>().c_str(), row["voxels"].get<int>(),
        row["method"].get<std::string>().c_str(), get("points"), get("radius_voxels"),
        get("points_over_bound"), 100 * get("fraction_of_voxel_centers"), get("normal_p50_deg"),
        get("normal_p99_deg"), get("normal_max_deg"), get("weight_sum_over_area"),
        get("block_voxels"), get("wall_s"), get("cpu_s"), get("peak_bytes") / 1e6, get("proof_s"));
    std::fflush(stdout);
  }

  const Model& model_;
  const std::string mesh_, shell_;
  const int voxels_;
  part::Part part_;
  const double voxel_size_m_;
};

int run(int argc, char** argv) {
  CLI::App app{"Points, proof, normals, time and memory of point shells", "shell_bench"};
  std::vector<std::string> meshes;
  std::vector<int> voxels = {128, 256};
  std::string models = test::source_path("../shared/models"), json;
  app.add_option("--mesh", meshes, "bunny, dragon, counter, block, part (default: all)");
  app.add_option("--voxels", voxels, "voxels across the longest side (default 128 256)");
  app.add_option("--models", models, "folder of the models");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  const fs::path folder = fs::temp_directory_path() / ("shell_bench_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  Json rows = Json::array();
  MeshCase::print_header();
  for (const Model& model : kModels) {
    if (!meshes.empty() && std::find(meshes.begin(), meshes.end(), model.name) == meshes.end()) {
      continue;
    }
    if (model.file && !fs::exists(fs::path(models) / model.file)) {
      std::printf("%-8s left out: no %s in %s\n", model.name, model.file, models.c_str());
      continue;
    }
    for (const int n : voxels) MeshCase(model, models, folder, n).run(rows);
  }
  fs::remove_all(folder);
  write_report("shell", argc, argv, rows, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("shell_bench", forcelayer::bench::run, argc, argv);
}
