// Puzzles: how often, how soon, and by how many poses a second voxplan's search takes them apart,
// beside the same planner of OMPL with FCL's collision of the meshes as its validity test. Times
// are the process' processor time; all work is one thread's.
//
//   puzzle_bench [--seeds N] [--time S] [--voxel-size MM] [--poses N] [--only NAME] [--bin FOLDER]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>

#include "runtime/run/baked_files.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/process_run.h"
#include "tests/bench/puzzle_bench_fcl.h"
#include "tests/support/scratch_folder.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/search.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

void bake(const std::string& command, const mesh::Mesh& mesh, double voxel_m,
          const std::filesystem::path& mesh_file, const std::filesystem::path& baked) {
  std::ofstream out(mesh_file);
  out.precision(std::numeric_limits<double>::max_digits10);
  for (const mesh::Vec3d& v : mesh.vertices) {
    out << "v " << v[0] << ' ' << v[1] << ' ' << v[2] << '\n';
  }
  for (const mesh::Triangle& t : mesh.triangles) {
    out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  }
  out.close();
  run_process({command, mesh_file.string(), "--units", "m", "--voxel-size",
               std::to_string(1e3 * voxel_m) + "mm", "-o", baked.string(), "--quiet"});
}

struct Trials {
  int solved = 0;
  std::vector<double> seconds;  // of those that are solved
  std::vector<double> poses_per_s, motions_per_s, steps_per_s;

  // A motion that is kept counts as the steps in which it would be tested, another one as one.
  void add(const Trial& trial, double step_m) {
    solved += trial.found ? 1 : 0;
    if (trial.found) seconds.push_back(trial.seconds);
    const double taken_s = std::max(trial.seconds, 1e-9);
    poses_per_s.push_back(static_cast<double>(trial.poses) / taken_s);
    motions_per_s.push_back(static_cast<double>(trial.motions) / taken_s);
    steps_per_s.push_back(
        (static_cast<double>(trial.motions - trial.kept) + trial.kept_m / step_m) / taken_s);
  }
};

Trial search_once(const voxplan::Problem& problem, const voxplan::Destination& goal,
                  std::uint64_t seed, double max_s) {
  voxplan::SearchRequest request;
  request.seed = seed;
  request.max_s = max_s;
  request.clock_s = cpu_s;
  const double begin_s = cpu_s();
  const auto r = value_of(voxplan::search(problem, goal, request));
  return {r.found, cpu_s() - begin_s, r.poses_tested, r.motions_tested, r.motions_kept, r.kept_m};
}

// The lower quartile, the median and the upper quartile; null where there is nothing.
Json quartiles(std::vector<double> sample) {
  if (sample.empty()) return {nullptr, nullptr, nullptr};
  std::sort(sample.begin(), sample.end());
  Json all = Json::array();
  for (const double fraction : {0.25, 0.5, 0.75}) {
    const double at = fraction * static_cast<double>(sample.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sample.size() - 1);
    all.push_back(sample[below] +
                  (at - static_cast<double>(below)) * (sample[above] - sample[below]));
  }
  return all;
}

struct ValidityRates {
  double poses_per_s, meshes_poses_per_s;
  int wrong;  // poses that we call free and that collide by the meshes
};

// Both tests on the same poses, drawn as a search draws them.
ValidityRates validity_rates(const Puzzle& puzzle, const voxplan::Problem& problem, int poses) {
  const auto check = value_of(voxplan::PoseCheck::create(problem));
  const MeshValidity meshes(puzzle, problem);
  const auto bounds = voxplan::Destination::out_of_scene(problem).bounds();
  voxplan::Random random(7);
  std::vector<Pose> drawn;
  for (int n = 0; n < poses; ++n) {
    Pose pose{{}, random.orientation()};
    for (int axis = 0; axis < 3; ++axis) {
      pose.position_m[axis] = random.between(bounds.low[axis], bounds.high[axis]);
    }
    drawn.push_back(pose);
  }
  const double begin_s = cpu_s();
  std::vector<bool> holds;
  for (const Pose& pose : drawn) holds.push_back(check->holds(voxplan::Rule::kClear, pose));
  const double middle_s = cpu_s();
  std::vector<bool> is_free;
  for (const Pose& pose : drawn) is_free.push_back(meshes.is_free(pose));
  const double end_s = cpu_s();
  ValidityRates rates{poses / (middle_s - begin_s), poses / (end_s - middle_s), 0};
  for (std::size_t n = 0; n < drawn.size(); ++n) rates.wrong += holds[n] && !is_free[n] ? 1 : 0;
  return rates;
}

// A row of the report, and its line on the terminal.
Json row_of(const Puzzle& puzzle, double voxel_m, const char* validity, const Trials& trials,
            int seeds, const Json& alone_poses_per_s) {
  const Json seconds = quartiles(trials.seconds);
  Json row{{"puzzle", puzzle.name},
           {"voxel_m", voxel_m},
           {"validity", validity},
           {"solved", trials.solved},
           {"seeds", seeds},
           {"q1_s", seconds[0]},
           {"median_s", seconds[1]},
           {"q3_s", seconds[2]},
           {"poses_per_s", quartiles(trials.poses_per_s)[1]},
           {"motions_per_s", quartiles(trials.motions_per_s)[1]},
           {"steps_per_s", quartiles(trials.steps_per_s)[1]},
           {"alone_poses_per_s", alone_poses_per_s}};
  std::string line;
  for (const auto& [key, value] : row.items()) {
    char number[32] = "";
    if (value.is_number()) std::snprintf(number, sizeof number, "%.3g", value.get<double>());
    line += key + ' ' + (value.is_string() ? value.get<std::string>() : number) + "  ";
  }
  std::puts(line.c_str());
  std::fflush(stdout);
  return row;
}

int run(int argc, char** argv) {
  CLI::App app{"Puzzles, taken apart by voxplan and by OMPL with FCL", "puzzle_bench"};
  int seeds = 10, poses = 20000;
  double max_s = 20, voxel_mm = 0;
  std::string json, only;
  std::string commands = std::filesystem::path(argv[0]).parent_path().string();
  app.add_option("--seeds", seeds);
  app.add_option("--time", max_s, "of a trial, s of processor time");
  app.add_option("--voxel-size", voxel_mm, "mm; 0: a quarter of a puzzle's slack");
  app.add_option("--poses", poses, "of the comparison of the validity tests");
  app.add_option("--only", only, "puzzles whose names begin with it");
  app.add_option("--bin", commands, "the folder of voxelize and pointshell");
  app.add_option("--json", json);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  }
  Json rows = Json::array();
  for (const Puzzle& puzzle : puzzles()) {
    if (!puzzle.name.starts_with(only)) continue;
    const double voxel_m = voxel_mm > 0 ? voxel_mm / 1000 : puzzle.slack_m / 4;
    const double step_m = voxel_m / 2;
    const test::ScratchFolder folder;
    const auto scene_file = folder.path() / "scene.vox", part_file = folder.path() / "part.pshell";
    bake(commands + "/voxelize", puzzle.scene, voxel_m, folder.path() / "scene.obj", scene_file);
    bake(commands + "/pointshell", puzzle.part, voxel_m, folder.path() / "part.obj", part_file);
    const Voxmap scene = value_of(open_scene(scene_file));
    const Pshell part = value_of(open_part(part_file));
    const voxplan::Problem problem{
        scene, part, 0, puzzle.world_from_part * voxplan::part_from_center(part), {}};
    const auto goal = voxplan::Destination::out_of_scene(problem);
    Trials ours, theirs;
    for (int seed = 1; seed <= seeds; ++seed) {
      const auto n = static_cast<std::uint64_t>(seed);
      ours.add(search_once(problem, goal, n, max_s), step_m);
      theirs.add(solve_by_meshes(puzzle, problem, step_m, n, max_s), step_m);
    }
    const ValidityRates alone = validity_rates(puzzle, problem, poses);
    if (alone.wrong > 0) throw std::runtime_error("a pose is free that collides by the meshes");
    rows.push_back(row_of(puzzle, voxel_m, "voxplan", ours, seeds, alone.poses_per_s));
    rows.push_back(row_of(puzzle, voxel_m, "FCL", theirs, seeds, alone.meshes_poses_per_s));
  }
  write_report("puzzles", argc, argv, rows, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("puzzle_bench", forcelayer::bench::run, argc, argv);
}
