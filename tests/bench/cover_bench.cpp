// Cost and gain of a denser shell: points, time of a frame and error of the contact wrench, by
// covering radius and by the way of making the shell.
//
//   cover_bench [--orientations N] [--radius VOXELS]... [--contact NAME]... [--json FILE]
//
// Shells are pointshell's own, of meshes of force_bench's parts; contacts, truth and fits are those
// of wrench_bench, at 5 mm. shell.md says more.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <stdexcept>

#include "pointshell/bake.h"
#include "runtime/field/force_field.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/force_bench_contacts.h"
#include "tests/bench/force_bench_frame.h"
#include "tests/bench/wrench_bench_meshes.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kS = 0.005;
constexpr double kDeviationVoxels = 0.02;  // of the parts' meshes

struct Making {
  const char* name;
  ShellMethod method;
  sample::Effort effort;
};
constexpr Making kMakings[] = {
    {"surface", ShellMethod::kSurface, sample::Effort::kFull},
    {"fast", ShellMethod::kSurface, sample::Effort::kFast},
    {"voxel centers", ShellMethod::kVoxelCenters, sample::Effort::kFull}};

constexpr Part kParts[] = {Part::kSphere, Part::kBox, Part::kCylinder, Part::kCone, Part::kTorus};

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

// pointshell's points about the part's own origin.
AnalyticShell baked_shell(Part part, const Making& making, double radius_voxels) {
  mesh::Assembly assembly;
  assembly.meshes = {part_mesh(part, kDeviationVoxels * kS)};
  assembly.instances = {{0, "part", {}}};
  assembly.meters_per_unit = 1;
  const part::PartInput input{&assembly, 1};
  pointshell::ShellOptions options;
  options.voxel_size_m = kS;
  options.method = making.method;
  options.effort = making.effort;
  if (making.method == ShellMethod::kSurface) options.covering_radius_m = radius_voxels * kS;
  const pointshell::BakedShell baked = value_of(pointshell::bake_shell(
      value_of(part::assemble_part({&input, 1})), options, [](const std::string&, double) {}));
  AnalyticShell shell;
  const auto& c = baked.header.center_m;
  for (std::size_t i = 0; i < baked.x.size(); ++i) {
    shell.points_m.push_back({baked.x[i] + c[0], baked.y[i] + c[1], baked.z[i] + c[2]});
    shell.normals.push_back({baked.nx[i], baked.ny[i], baked.nz[i]});
    shell.areas_m2.push_back(baked.weight_m2[i]);
    shell.radius_m = std::max(shell.radius_m, glm::length(shell.points_m.back()));
    shell.area_m2 += baked.weight_m2[i];
  }
  shell.covering_radius_m = baked.header.covering_radius_m;
  return shell;
}

double middle(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  return values.empty() ? NAN : percentiles(std::move(values)).p50;
}

struct Sample {
  std::vector<double> force_error, noise, direction_deg, torque_error;

  void add(const Quality& q) {
    force_error.push_back(q.force_error);
    noise.push_back(q.noise);
    direction_deg.push_back(q.direction_deg);
    torque_error.push_back(q.torque_error);
  }
  Json to_json() const {
    return {{"force_error", middle(force_error)},
            {"noise", middle(noise)},
            {"direction_deg", middle(direction_deg)},
            {"torque_error", middle(torque_error)},
            {"cases", force_error.size()}};
  }
};

// Each model in the map that it reads: `default` one of voxelize without options, `paper` Chebyshev
// layers, as its paper has them.
struct JudgedModel {
  const char* name;
  Model model;
  test::VoxelKind kind;
  Averaging averaging;
};
constexpr JudgedModel kModels[] = {
    {"paper", Model::kPaper, test::VoxelKind::kChebyshev, Averaging::kByTen},
    {"default", Model::kDefault, test::VoxelKind::kFull, Averaging::kDirections}};
constexpr const char* kGroups[] = {"flush and smooth", "corners and wedges"};

Json row_of(const Making& making, double radius_voxels, int orientations,
            const std::vector<std::string>& only) {
  std::map<Part, PartShells> shells;
  std::map<Part, Pshell> pshells;
  std::size_t points = 0;
  double covering_m = 0;
  for (const Part part : kParts) {
    shells[part] = {baked_shell(part, making, radius_voxels), shells_of(part, kS, 1).fine};
    pshells.emplace(part, pshell_of(shells[part].tested, kS));
    points += shells[part].tested.points_m.size();
    covering_m = std::max(covering_m, shells[part].tested.covering_radius_m);
  }
  std::map<std::string, std::map<std::string, Sample>> samples;  // [model][group]
  std::map<std::string, std::vector<double>> frame_us;           // [model]
  std::mt19937_64 random(20260101);
  for (const Combination& combination : wide_combinations()) {
    if (combination.standoff) continue;
    if (!only.empty() && std::find(only.begin(), only.end(), combination.name) == only.end()) {
      continue;
    }
    for (int i = 0; i < orientations; ++i) {
      const std::mt19937_64 same = random;
      for (const JudgedModel& judged : kModels) {
        random = same;
        const ContactCase contact(combination, shells[combination.part], kS, random, judged.kind);
        const Voxmap& voxmap = contact.voxmap();
        const auto field = value_of(field::make_force_field(
            judged.model, field::usual_force(judged.model, voxmap), voxmap));
        ModelFrame frame(voxmap, pshells.at(combination.part), *field, judged.averaging);
        const bool by_ten = judged.averaging == Averaging::kByTen;
        if (!by_ten) frame.weigh_by_area();
        const auto wrench_at = [&frame](const ContactCase::Placed& placed) {
          return frame.at({placed.position_m, glm::quat_cast(placed.rotation)});
        };
        samples[judged.name][kGroups[combination.smooth ? 0 : 1]].add(
            contact.judge(wrench_at, ContactCase::kShifts, by_ten ? Shared::kByTen : Shared::kNot));
        for (const ContactCase::Placed& placed : contact.slide()) {
          const double start_s = now_s();
          wrench_at(placed);
          frame_us[judged.name].push_back(1e6 * (now_s() - start_s));
        }
      }
    }
  }
  Json row{{"method", making.name},
           {"covering_radius_voxels", covering_m / kS},
           {"asked_radius_voxels", radius_voxels},
           {"points", points}};
  std::printf("%-14s %6.3f %8zu", making.name, covering_m / kS, points);
  for (const auto& [model, groups] : samples) {
    for (const auto& [group, sample] : groups) row[model][group] = sample.to_json();
    row[model]["frame_us"] = to_json(percentiles(frame_us[model]));
    std::printf("   %s", model.c_str());
    for (const auto& [group, sample] : groups) {
      std::printf(" %6.1f%%", 100 * middle(sample.force_error));
    }
    std::printf(" %7.1f us", row[model]["frame_us"]["p50"].get<double>());
  }
  std::printf("\n");
  std::fflush(stdout);
  return row;
}

int run(int argc, char** argv) {
  CLI::App app{"What a denser shell costs and buys", "cover_bench"};
  int orientations = 2;
  std::vector<double> radii = {0.35, 0.5, 0.7, 0.866, 1.2, 1.7};
  std::vector<std::string> only;
  std::string json;
  app.add_option("--orientations", orientations, "of each contact")->check(CLI::PositiveNumber);
  app.add_option("--radius", radii, "covering radii, voxels")->check(CLI::PositiveNumber);
  app.add_option("--contact", only, "\"sphere on plane\", ... (default: all)");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  std::printf("%-14s %6s %8s   force error: corners and wedges, flush and smooth; frame, median\n",
              "shell", "rho/s", "points");
  Json rows = Json::array();
  for (const Making& making : kMakings) {
    const bool free_radius = making.method == ShellMethod::kSurface;
    for (const double radius : free_radius ? radii : std::vector<double>{0.866}) {
      rows.push_back(row_of(making, radius, orientations, only));
    }
  }
  write_report("cover", argc, argv, rows, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("cover_bench", forcelayer::bench::run, argc, argv);
}
