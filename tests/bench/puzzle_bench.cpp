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
#include "runtime/voxplan/pose_check.h"
#include "runtime/voxplan/search.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/process_run.h"
#include "tests/bench/puzzle_bench_fcl.h"
#include "tests/support/scratch_folder.h"

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
  // Of voxplan::SearchResult or PeerResult. A motion that is kept counts as the steps in which it
  // would be tested, another one as one.
  void add(bool found, double taken_s, std::uint64_t poses, std::uint64_t motions,
           std::uint64_t kept, double kept_m, double step_m) {
    solved += found ? 1 : 0;
    if (found) seconds.push_back(taken_s);
    poses_per_s.push_back(static_cast<double>(poses) / std::max(taken_s, 1e-9));
    motions_per_s.push_back(static_cast<double>(motions) / std::max(taken_s, 1e-9));
    steps_per_s.push_back((static_cast<double>(motions - kept) + kept_m / step_m) /
                          std::max(taken_s, 1e-9));
  }
};

// The lower quartile, the median and the upper quartile; null where there is nothing.
Json quartiles(std::vector<double> sample) {
  if (sample.empty()) return {nullptr, nullptr, nullptr};
  std::sort(sample.begin(), sample.end());
  Json all = Json::array();
  for (const double share : {0.25, 0.5, 0.75}) {
    const double at = share * static_cast<double>(sample.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sample.size() - 1);
    all.push_back(sample[below] +
                  (at - static_cast<double>(below)) * (sample[above] - sample[below]));
  }
  return all;
}

// Both tests on the same poses, drawn as a search draws them.
Json validity_rates(const Puzzle& puzzle, const voxplan::Problem& problem, int poses) {
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
  int free = 0, by_meshes = 0, wrong = 0;
  const double begin_s = cpu_s();
  std::vector<bool> holds;
  for (const Pose& pose : drawn) holds.push_back(check->holds(voxplan::Rule::kClear, pose));
  const double middle_s = cpu_s();
  std::vector<bool> is_free;
  for (const Pose& pose : drawn) is_free.push_back(meshes.is_free(pose));
  const double end_s = cpu_s();
  for (std::size_t n = 0; n < drawn.size(); ++n) {
    free += holds[n] ? 1 : 0;
    by_meshes += is_free[n] ? 1 : 0;
    wrong += holds[n] && !is_free[n] ? 1 : 0;
  }
  return {{"poses", poses},
          {"free", free},
          {"free_by_meshes", by_meshes},
          {"free_but_not_by_meshes", wrong},
          {"poses_per_s", poses / (middle_s - begin_s)},
          {"meshes_poses_per_s", poses / (end_s - middle_s)}};
}

Json row_of(const Trials& trials, int seeds) {
  return {{"solved", trials.solved},
          {"seeds", seeds},
          {"seconds", quartiles(trials.seconds)},
          {"poses_per_s", quartiles(trials.poses_per_s)},
          {"motions_per_s", quartiles(trials.motions_per_s)},
          {"steps_per_s", quartiles(trials.steps_per_s)}};
}

void print(const std::string& puzzle, double voxel_m, const char* validity, const Json& row,
           const Json& alone) {
  const auto figure = [](const Json& number) {
    char text[32] = "";
    if (number.is_number()) std::snprintf(text, sizeof text, "%.3g", number.get<double>());
    return std::string(text);
  };
  std::string line = '"' + puzzle + "\"," + figure(1e3 * voxel_m) + ',' + validity + ',' +
                     row["solved"].dump() + ',' + row["seeds"].dump();
  for (const Json& s : row["seconds"]) line += ',' + figure(s);
  for (const char* rate : {"poses_per_s", "motions_per_s", "steps_per_s"}) {
    line += ',' + figure(row[rate][1]);
  }
  line += ',' + figure(alone);
  std::puts(line.c_str());
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  CLI::App app{"Puzzles, taken apart by voxplan and by OMPL with FCL", "puzzle_bench"};
  int seeds = 10, poses = 20000;
  double most_s = 20, voxel_mm = 0;
  std::string json, only;
  std::string commands = std::filesystem::path(argv[0]).parent_path().string();
  app.add_option("--seeds", seeds);
  app.add_option("--time", most_s, "of a trial, s of processor time");
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
  std::puts(
      "puzzle,voxel_mm,validity,solved,seeds,q1_s,median_s,q3_s,poses_per_s,motions_per_s,"
      "steps_per_s,alone_poses_per_s");
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
      voxplan::SearchRequest request;
      request.seed = static_cast<std::uint64_t>(seed);
      request.most_s = most_s;
      request.clock_s = cpu_s;
      const auto result = value_of(voxplan::search(problem, goal, request));
      ours.add(result.found, result.seconds, result.poses_tested, result.motions_tested,
               result.motions_kept, result.kept_m, step_m);
      const PeerResult peer =
          solve_by_meshes(puzzle, problem, step_m, static_cast<std::uint64_t>(seed), most_s);
      theirs.add(peer.found, peer.seconds, peer.poses, peer.motions, peer.kept, peer.kept_m,
                 step_m);
    }
    Json row{{"puzzle", puzzle.name},
             {"voxel_size_m", voxel_m},
             {"triangles", puzzle.scene.triangles.size() + puzzle.part.triangles.size()},
             {"shell_points", part.view().point_count}};
    row["voxplan"] = row_of(ours, seeds);
    row["fcl"] = row_of(theirs, seeds);
    row["validity"] = validity_rates(puzzle, problem, poses);
    print(puzzle.name, voxel_m, "voxplan", row["voxplan"], row["validity"]["poses_per_s"]);
    print(puzzle.name, voxel_m, "fcl", row["fcl"], row["validity"]["meshes_poses_per_s"]);
    rows.push_back(std::move(row));
  }
  write_report("puzzles", argc, argv, {{"most_s", most_s}, {"rows", rows}}, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("puzzle_bench", forcelayer::bench::run, argc, argv);
}
