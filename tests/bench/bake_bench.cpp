// The bake beside what people use today: one run, one machine, same mesh, resolution and threads.
//
//   bake_bench [--wide [--vectors TARGET]] [--case NAME]... [--voxels N]... [--repeat N]
//              [--models FOLDER] [--json FILE]
//
// With --wide: the bakes of Euclidean layers and of voxels that store distances beside the usual
// one, in memory and by the command, and beside vdb_tool and meshToVolume making floats of the same
// distances. With --vectors without the commands: it limits this process alone.
//
// Without, for every case: the whole bake from triangles in memory to the finished file, checksums
// and provenance included, and the whole command, beside `vdb_tool -mesh2ls` (which writes a level
// set, no classification); and the scan conversion alone beside meshToVolume and beside the
// straightforward way, which has the same output. Every figure is the least of the repetitions,
// which alternate between the programs: other work on the machine only ever adds time. What takes
// long runs once: meshToVolume, and with --wide vdb_tool too. The one-thread scans are compared by
// CPU time.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <thread>

#include <unistd.h>

#include "formats/mesh/scene.h"
#include "formats/voxmap_writer.h"
#include "tests/bench/bake_bench_peers.h"
#include "tests/bench/bench_mesh.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/process_run.h"
#include "tests/support/places.h"
#include "voxelize/bake.h"
#include "voxelize/provenance.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct Model {
  const char* name;
  const char* file;   // in the models folder
  const char* units;  // empty: the file has its own
};
constexpr Model kModels[] = {{"bunny", "scan/stanford-bunny.obj", "m"},
                             {"dragon", "scan/dragon-100k.obj", "m"},
                             {"counter", "cad/counter.unitsmm.stl", "mm"},
                             {"engine", "cad/2CylinderEngine.glb", ""}};

// The kinds of maps that a bake can write; the cheapest first, the default last.
struct Kind {
  const char* name;
  Metric metric;
  bool distances;
};
constexpr Kind kKinds[] = {{"lean, chebyshev", Metric::kChebyshev, false},
                           {"lean", Metric::kEuclidean, false},
                           {"full", Metric::kEuclidean, true}};
// The stored distances lie between these, voxels from the mesh, outside and inside, rounded up.
constexpr int kExteriorBand = 6, kInteriorBand = 2;

struct Best {
  double wall_s = std::numeric_limits<double>::infinity();
  double cpu_s = wall_s;
  void add(double wall, double cpu) {
    wall_s = std::min(wall_s, wall);
    cpu_s = std::min(cpu_s, cpu);
  }
};
Json to_json(const Best& best) { return {{"wall_s", best.wall_s}, {"cpu_s", best.cpu_s}}; }

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

void write_binary_ply(const fs::path& path, const mesh::Mesh& mesh) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertices.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nelement face "
       << mesh.triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const mesh::Vec3d& v : mesh.vertices) {
    const float xyz[3] = {static_cast<float>(v[0]), static_cast<float>(v[1]),
                          static_cast<float>(v[2])};
    file.write(reinterpret_cast<const char*>(xyz), sizeof xyz);
  }
  for (const mesh::Triangle& t : mesh.triangles) {
    file.put(3);
    file.write(reinterpret_cast<const char*>(t.data()), sizeof t);
  }
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

// "... completed in 1 second and 62.4 milliseconds (1062.4ms)" of a vdb_tool stage, seconds.
double vdb_tool_stage_s(const std::string& output, const std::string& stage) {
  const std::size_t at = output.find(stage);
  const std::size_t line_end = output.find('\n', at);
  if (at == std::string::npos) throw std::runtime_error("vdb_tool does not report " + stage);
  const std::string line = output.substr(at, line_end - at);
  const std::size_t open = line.rfind('(');
  const std::size_t plain = line.find("completed in ");
  const std::size_t number = open != std::string::npos ? open + 1 : plain + 13;
  return std::stod(line.substr(number)) * 1e-3;
}

// One model at one resolution.
class Case {
 public:
  Case(const Model& model, const fs::path& models, const fs::path& folder, int voxels)
      : model_(model), path_((models / model.file).string()), folder_(folder), voxels_(voxels) {
    std::optional<double> unit;
    if (model.units[0] != '\0') unit = std::string_view(model.units) == "mm" ? 1e-3 : 1.0;
    scene_ = value_of(mesh::read_scene(std::span(&path_, 1), unit));
    const mesh::Mesh meters = merged(scene_);
    voxel_size_m_ = longest_side(meters) / voxels;
    peer_mesh_ = merged(scene_, 1 / voxel_size_m_);
    // vdb_tool reads no GLB: that model is converted to one PLY, in meters, for both.
    peer_path_ = path_;
    peer_units_ = model.units;
    peer_voxel_ = voxel_size_m_ / unit.value_or(1);
    if (model.units[0] == '\0') {
      peer_path_ = (folder / (std::string(model.name) + ".ply")).string();
      peer_units_ = "m";
      write_binary_ply(peer_path_, meters);
    }
  }

  Json run(int repeat) {
    for (int i = 0; i < repeat; ++i) {
      file_bytes_ = bake_in_memory(kKinds[0], in_memory_);
      command_rss_ = run_command(kKinds[0], command_);
      run_vdb_tool(3);
      scan_one_thread_.add(run_scan_conversion(peer_mesh_, 1));
      scan_all_threads_.add(run_scan_conversion(peer_mesh_, threads()));
      scan_straightforward_.add(run_straightforward(peer_mesh_));
      if (scan_straightforward_.voxels != scan_one_thread_.voxels) {
        throw std::runtime_error("the straightforward scan has other voxels");
      }
      if (i == 0)
        scan_mesh_to_volume_.add(run_mesh_to_volume(peer_mesh_, 3, 3));  // it takes longest
    }
    return report();
  }

  // Every kind, and the peers once: they take longest.
  Json run_wide(int repeat, bool with_command) {
    Best kinds[std::size(kKinds)], commands[std::size(kKinds)];
    std::uint64_t bytes[std::size(kKinds)] = {};
    for (int i = 0; i < repeat; ++i) {
      for (std::size_t k = 0; k < std::size(kKinds); ++k) {
        bytes[k] = bake_in_memory(kKinds[k], kinds[k]);
        if (with_command) run_command(kKinds[k], commands[k]);
      }
      if (i > 0) continue;
      run_vdb_tool(kExteriorBand);
      scan_mesh_to_volume_.add(run_mesh_to_volume(peer_mesh_, kExteriorBand, kInteriorBand));
    }
    Json row = {{"model", model_.name},
                {"triangles", peer_mesh_.triangles.size()},
                {"voxels_across", voxels_},
                {"voxel_size_m", voxel_size_m_},
                {"vdb_tool", to_json(vdb_tool_)},
                {"vdb_tool_without_reading", to_json(vdb_tool_no_reading_)},
                {"vdb_bytes", vdb_bytes_},
                {"mesh_to_volume", to_json(scan_mesh_to_volume_.best)}};
    for (std::size_t k = 0; k < std::size(kKinds); ++k) {
      Json kind = {{"in_memory_to_file", to_json(kinds[k])},
                   {"file_bytes", bytes[k]},
                   {"over_two_bits", kinds[k].wall_s / kinds[0].wall_s},
                   {"vdb_tool_times", vdb_tool_no_reading_.wall_s / kinds[k].wall_s},
                   {"mesh_to_volume_times", scan_mesh_to_volume_.best.wall_s / kinds[k].wall_s}};
      if (with_command) {
        kind["command"] = to_json(commands[k]);
        kind["command_over_two_bits"] = commands[k].wall_s / commands[0].wall_s;
      }
      row["kinds"][kKinds[k].name] = std::move(kind);
    }
    return row;
  }

 private:
  struct Scan {
    Best best;
    std::uint64_t voxels = 0;
    void add(const PeerRun& run) {
      best.add(run.wall_s, run.cpu_s);
      voxels = run.voxels;
    }
  };

  voxelize::BakeOptions options(const Kind& kind) const {
    voxelize::BakeOptions options;
    options.voxel_size_m = voxel_size_m_;
    options.metric = kind.metric;
    options.distances = kind.distances;
    return options;
  }

  // The file's size.
  std::uint64_t bake_in_memory(const Kind& kind, Best& best) const {
    std::vector<voxelize::SceneObject> objects;
    for (const mesh::MeshObject& part : scene_.objects) {
      objects.push_back({part.name, &scene_.mesh_of(part), part.world_from_mesh, {}, 0});
    }
    const double wall_s = now_s(), cpu_start_s = cpu_s();
    const voxelize::Bake bake = value_of(forcelayer::voxelize::bake(objects, options(kind)));
    std::vector<cache::MeshOutline> outlines;
    for (const mesh::MeshObject& part : scene_.objects)
      outlines.push_back(cache::outline_of(scene_.mesh_of(part)));
    const std::string provenance = voxelize::provenance_of(scene_, outlines, options(kind));
    const std::uint64_t bytes =
        value_of(write_voxmap(folder_ / "ours.vox", bake.content(provenance)));
    best.add(now_s() - wall_s, cpu_s() - cpu_start_s);
    return bytes;
  }

  // Its peak memory, bytes.
  std::uint64_t run_command(const Kind& kind, Best& best) const {
    std::vector<std::string> command = {test::command_path("voxelize"),
                                        peer_path_,
                                        "--quiet",
                                        "-o",
                                        (folder_ / "command.vox").string(),
                                        "--voxel-size",
                                        number(voxel_size_m_) + "m",
                                        "--units",
                                        peer_units_,
                                        "--metric",
                                        metric_name(kind.metric)};
    if (!kind.distances && kind.metric == Metric::kEuclidean) command.push_back("--lean");
    const ProcessRun run = run_process(command);
    best.add(run.wall_s, run.cpu_s);
    return run.peak_rss_bytes;
  }

  void run_vdb_tool(int width_voxels) {
    const ProcessRun run = run_process(
        {"vdb_tool", "-read", peer_path_, "-mesh2ls", "voxel=" + number(peer_voxel_),
         "width=" + std::to_string(width_voxels), "-write", (folder_ / "peer.vdb").string()});
    const double read_s = vdb_tool_stage_s(run.output, "Read geometry");
    vdb_tool_.add(run.wall_s, run.cpu_s);
    vdb_tool_no_reading_.add(run.wall_s - read_s, run.cpu_s - read_s);
    vdb_tool_rss_ = run.peak_rss_bytes;
    vdb_bytes_ = fs::file_size(folder_ / "peer.vdb");
  }

  static const char* metric_name(Metric metric) {
    return metric == Metric::kEuclidean ? "euclidean" : "chebyshev";
  }
  static int threads() {
    return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  }
  static std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
  }

  Json report() const {
    return {{"model", model_.name},
            {"triangles", peer_mesh_.triangles.size()},
            {"objects", scene_.objects.size()},
            {"voxels_across", voxels_},
            {"voxel_size_m", voxel_size_m_},
            {"in_memory_to_file", to_json(in_memory_)},
            {"command", to_json(command_)},
            {"command_peak_rss_bytes", command_rss_},
            {"file_bytes", file_bytes_},
            {"vdb_tool", to_json(vdb_tool_)},
            {"vdb_tool_without_reading", to_json(vdb_tool_no_reading_)},
            {"vdb_tool_peak_rss_bytes", vdb_tool_rss_},
            {"vdb_bytes", vdb_bytes_},
            {"scan_one_thread", to_json(scan_one_thread_.best)},
            {"scan_all_threads", to_json(scan_all_threads_.best)},
            {"scan_voxels", scan_one_thread_.voxels},
            {"straightforward_one_thread", to_json(scan_straightforward_.best)},
            {"straightforward_voxels", scan_straightforward_.voxels},
            {"mesh_to_volume", to_json(scan_mesh_to_volume_.best)},
            {"mesh_to_volume_voxels", scan_mesh_to_volume_.voxels}};
  }

  const Model& model_;
  std::string path_;
  fs::path folder_;
  int voxels_;
  mesh::Scene scene_;
  double voxel_size_m_ = 0;
  mesh::Mesh peer_mesh_;  // voxels
  std::string peer_path_, peer_units_;
  double peer_voxel_ = 0;  // in the units of the file that vdb_tool reads
  Best in_memory_, command_, vdb_tool_, vdb_tool_no_reading_;
  Scan scan_one_thread_, scan_all_threads_, scan_straightforward_, scan_mesh_to_volume_;
  std::uint64_t command_rss_ = 0, vdb_tool_rss_ = 0, file_bytes_ = 0, vdb_bytes_ = 0;
};

void print_header() {
  std::printf("%-8s %6s | %9s %7s | %9s %7s | %9s %9s %7s | %9s %9s %7s | %6s\n", "model", "voxels",
              "plain ms", "times", "m2v ms", "times", "bake ms", "vdb ms", "times", "cmd ms",
              "vdb ms", "times", "rss");
}

void print_row(const Json& row) {
  const auto ms = [&](const char* key) { return row[key]["wall_s"].get<double>() * 1e3; };
  const auto times = [&](const char* theirs, const char* ours, const char* clock = "wall_s") {
    return row[theirs][clock].get<double>() / row[ours][clock].get<double>();
  };
  const auto bytes = [&](const char* key) { return row[key].get<double>(); };
  std::printf(
      "%-8s %6d | %9.1f %7.1f | %9.0f %7.1f | %9.1f %9.0f %7.1f | %9.1f %9.0f %7.1f | %5.1f%%\n",
      row["model"].get<std::string>().c_str(), row["voxels_across"].get<int>(),
      ms("straightforward_one_thread"),
      times("straightforward_one_thread", "scan_one_thread", "cpu_s"), ms("mesh_to_volume"),
      times("mesh_to_volume", "scan_all_threads"), ms("in_memory_to_file"),
      ms("vdb_tool_without_reading"), times("vdb_tool_without_reading", "in_memory_to_file"),
      ms("command"), ms("vdb_tool"), times("vdb_tool", "command"),
      100 * bytes("command_peak_rss_bytes") / bytes("vdb_tool_peak_rss_bytes"));
  std::fflush(stdout);
}

void print_wide_header() {
  std::printf("%-8s %6s | %-20s %9s %7s | %8s | %9s %7s | %9s %7s | %7s %7s\n", "model", "voxels",
              "kind", "ms", "times", "MB", "vdb ms", "times", "m2v ms", "times", "command",
              "times");
}

void print_wide_row(const Json& row) {
  for (const auto& [name, kind] : row["kinds"].items()) {
    std::printf("%-8s %6d | %-20s %9.1f %7.2f | %8.2f | %9.0f %7.1f | %9.0f %7.1f",
                row["model"].get<std::string>().c_str(), row["voxels_across"].get<int>(),
                name.c_str(), kind["in_memory_to_file"]["wall_s"].get<double>() * 1e3,
                kind["over_two_bits"].get<double>(), kind["file_bytes"].get<double>() / 1e6,
                row["vdb_tool_without_reading"]["wall_s"].get<double>() * 1e3,
                kind["vdb_tool_times"].get<double>(),
                row["mesh_to_volume"]["wall_s"].get<double>() * 1e3,
                kind["mesh_to_volume_times"].get<double>());
    if (kind.contains("command")) {
      std::printf(" | %7.0f %7.2f", kind["command"]["wall_s"].get<double>() * 1e3,
                  kind["command_over_two_bits"].get<double>());
    }
    std::printf("\n");
  }
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  CLI::App app{"The bake beside what people use today", "bake_bench"};
  std::vector<std::string> cases;
  std::vector<int> voxels = {512, 1024};
  int repeat = 5;
  bool wide = false;
  std::string models = test::source_path("../shared/models"), json, vectors;
  app.add_option("--case", cases, "bunny, dragon, counter, engine (default: all)");
  CLI::Option* const wide_flag =
      app.add_flag("--wide", wide, "Euclidean layers and stored distances");
  app.add_option("--vectors", vectors, "AVX2, SSE4, ...: none wider, and no commands")
      ->needs(wide_flag);
  app.add_option("--voxels", voxels, "voxels across the longest side (default 512 1024)");
  app.add_option("--repeat", repeat, "repetitions, of which the least counts")
      ->check(CLI::PositiveNumber);
  app.add_option("--models", models, "folder of the models");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  if (!vectors.empty()) use_vectors(vectors);
  const fs::path folder = fs::temp_directory_path() / ("bake_bench_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  Json results = Json::array();
  wide ? print_wide_header() : print_header();
  for (const Model& model : kModels) {
    if (!cases.empty() && std::find(cases.begin(), cases.end(), model.name) == cases.end())
      continue;
    if (!fs::exists(fs::path(models) / model.file)) {
      std::printf("%-8s left out: no %s in %s\n", model.name, model.file, models.c_str());
      continue;
    }
    for (const int n : voxels) {
      Case one(model, models, folder, n);
      results.push_back(wide ? one.run_wide(repeat, vectors.empty()) : one.run(repeat));
      wide ? print_wide_row(results.back()) : print_row(results.back());
    }
  }
  fs::remove_all(folder);
  write_report(wide ? "bake_wide" : "bake", argc, argv, results, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("bake_bench", forcelayer::bench::run, argc, argv);
}
