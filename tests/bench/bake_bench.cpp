// The bake beside what people use today: one run, one machine, same mesh, resolution and threads.
//
//   bake_bench [--case NAME]... [--voxels N]... [--repeat N] [--models FOLDER] [--json FILE]
//
// For every case and every kind of map: the bake from triangles in memory to the finished file,
// checksums and provenance included, and the whole command; beside vdb_tool and OpenVDB's
// meshToVolume, which make floats of the same distances. Our figures are the least of the
// repetitions: other work on the machine only ever adds time. The peers take long and run once.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>

#include <unistd.h>

#include "formats/mesh/scene.h"
#include "formats/voxmap_writer.h"
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

  // Adds a row for each kind.
  void run(int repeat, Json& rows) const {
    Best bakes[std::size(kKinds)], commands[std::size(kKinds)];
    std::uint64_t bytes[std::size(kKinds)] = {};
    for (int i = 0; i < repeat; ++i) {
      for (std::size_t k = 0; k < std::size(kKinds); ++k) {
        bytes[k] = bake_in_memory(kKinds[k], bakes[k]);
        run_command(kKinds[k], commands[k]);
      }
    }
    const Json peers = run_peers();
    for (std::size_t k = 0; k < std::size(kKinds); ++k) {
      Json row{{"vectors", machine()["vectors"]},
               {"model", model_.name},
               {"voxels", voxels_},
               {"kind", kKinds[k].name},
               {"bake_s", bakes[k].wall_s},
               {"bake_cpu_s", bakes[k].cpu_s},
               {"command_s", commands[k].wall_s},
               {"file_bytes", bytes[k]}};
      row.update(peers);
      std::printf("%-8s %6d %-20s", model_.name, voxels_, kKinds[k].name);
      for (const char* key : {"bake_s", "command_s", "vdb_tool_s", "mesh_to_volume_s"}) {
        std::printf("  %s %8.4f", key, row[key].get<double>());
      }
      std::printf("  %.2f MB\n", static_cast<double>(bytes[k]) / 1e6);
      std::fflush(stdout);
      rows.push_back(std::move(row));
    }
  }

 private:
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

  void run_command(const Kind& kind, Best& best) const {
    std::vector<std::string> command = {test::command_path("voxelize"),
                                        peer_path_,
                                        "--quiet",
                                        "-o",
                                        (folder_ / "command.vox").string(),
                                        "--voxel-size",
                                        number(voxel_size_m_) + "m",
                                        "--units",
                                        peer_units_,
                                        "--kind",
                                        kind.metric == Metric::kChebyshev ? "paper"
                                        : kind.distances                  ? "full"
                                                                          : "lean"};
    const ProcessRun run = run_process(command);
    best.add(run.wall_s, run.cpu_s);
  }

  // vdb_tool, whole and without reading the mesh, and meshToVolume, on all threads: each makes a
  // band of floats as wide as that of our stored distances.
  Json run_peers() const {
    const fs::path vdb = folder_ / "peer.vdb";
    const ProcessRun run =
        run_process({"vdb_tool", "-read", peer_path_, "-mesh2ls", "voxel=" + number(peer_voxel_),
                     "width=" + std::to_string(kExteriorBand), "-write", vdb.string()});
    const double read_s = vdb_tool_stage_s(run.output, "Read geometry");
    return {{"vdb_tool_bake_s", run.wall_s - read_s},
            {"vdb_tool_s", run.wall_s},
            {"mesh_to_volume_s", mesh_to_volume_s()},
            {"vdb_bytes", fs::file_size(vdb)}};
  }

  double mesh_to_volume_s() const {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec3I> triangles;
    for (const auto& v : peer_mesh_.vertices) points.emplace_back(openvdb::Vec3d(v.data()));
    for (const mesh::Triangle& t : peer_mesh_.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(
        points, triangles);
    const auto transform = openvdb::math::Transform::createLinearTransform(1);
    const double begin_s = now_s();
    openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform, kExteriorBand,
                                                     kInteriorBand);
    return now_s() - begin_s;
  }

  static const char* metric_name(Metric metric) {
    return metric == Metric::kEuclidean ? "euclidean" : "chebyshev";
  }
  static std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    return text;
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
};

int run(int argc, char** argv) {
  CLI::App app{"The bake beside what people use today", "bake_bench"};
  std::vector<std::string> cases;
  std::vector<int> voxels = {512, 1024};
  int repeat = 5;
  std::string models = test::source_path("../shared/models"), json;
  app.add_option("--case", cases, "bunny, dragon, counter, engine (default: all)");
  app.add_option("--voxels", voxels, "voxels across the longest side (default 512 1024)");
  app.add_option("--repeat", repeat, "repetitions, of which the least counts")
      ->check(CLI::PositiveNumber);
  app.add_option("--models", models, "folder of the models");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  const fs::path folder = fs::temp_directory_path() / ("bake_bench_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  Json results = Json::array();
  for (const Model& model : kModels) {
    if (!cases.empty() && std::find(cases.begin(), cases.end(), model.name) == cases.end())
      continue;
    if (!fs::exists(fs::path(models) / model.file)) {
      std::printf("%-8s left out: no %s in %s\n", model.name, model.file, models.c_str());
      continue;
    }
    for (const int n : voxels) {
      Case(model, models, folder, n).run(repeat, results);
    }
  }
  fs::remove_all(folder);
  write_report("bake_kinds", argc, argv, results, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("bake_bench", forcelayer::bench::run, argc, argv);
}
