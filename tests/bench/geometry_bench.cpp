// How true the geometry of a bake is, and what it cost: one program on one scene at one resolution,
// as a line of JSON. bake_error.py runs it over scenes, programs and voxel sizes.
//
//   geometry_bench PROGRAM SCENE --voxels N [--units UNIT] [--samples N]
//
// PROGRAM: voxelize, chebyshev (voxelize --metric chebyshev), mesh-to-volume-0.5,
// mesh-to-volume-0.866 (the threshold in voxels), vtk. The whole scene is one object for all of
// them. Values are judged by the exact geometry and the layers of the program's metric: voxelize
// counts them from the mesh, all others from the voxels that it touches.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <optional>
#include <random>
#include <stdexcept>

#include <unistd.h>

#include "formats/voxmap.h"
#include "formats/voxmap_writer.h"
#include "tests/bench/bench_mesh.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/geometry_bench_voxels.h"
#include "tests/support/reference_distance.h"
#include "voxelize/bake.h"
#include "voxelize/scan/scan_conversion.h"
#include "voxelize/scan/snap.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;
using reference::DenseGrid;
namespace fs = std::filesystem;

constexpr int kLayers = 2;

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

// A program's result for a mesh: the voxels that it says the mesh touches, and the class of every
// voxel after the offset.
struct Outcome {
  double wall_s = 0, cpu_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  DenseGrid touched, values;
};

// The voxels that a set of touched voxels encloses, by a flood from outside. Not timed.
reference::ReferenceScene scene_of(const DenseGrid& touched) {
  DenseGrid flooded = touched;
  reference::mark_free({}, flooded);
  reference::ReferenceScene scene{touched, touched};
  flooded.for_each(
      [&](const lattice::VoxelIndex& v) { scene.interior.at(v) = flooded.at(v) == 0 ? 1 : 0; });
  return scene;
}

// The grid to judge on; asked for after the clock and the memory have been read.
using GridMaker = std::function<DenseGrid()>;

Outcome run_voxelize(const mesh::Mesh& meters, double voxel_size_m, Metric metric,
                     const GridMaker& make_grid) {
  voxelize::BakeOptions options;
  options.voxel_size_m = voxel_size_m;
  options.layers = kLayers;
  options.metric = metric;
  const std::vector<voxelize::SceneObject> objects = {{"scene", &meters, {}, {}, 0}};
  const fs::path path =
      fs::temp_directory_path() / ("geometry_bench_" + std::to_string(::getpid()) + ".vox");
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  {
    const voxelize::Bake bake = value_of(forcelayer::voxelize::bake(objects, options));
    value_of(write_voxmap(path, bake.content("{}")));
  }
  const double wall_end_s = now_s(), cpu_end_s = cpu_s();
  const std::uint64_t peak = peak_rss_bytes();
  const DenseGrid like = make_grid();
  Outcome outcome{wall_end_s - wall_s, cpu_end_s - cpu_start_s, peak, like, like};
  const Voxmap map = value_of(Voxmap::open(path));
  fs::remove(path);
  outcome.values.for_each([&](const lattice::VoxelIndex& v) {
    outcome.values.at(v) = static_cast<std::uint8_t>(map.value(v[0], v[1], v[2]));
  });
  const scan::SnappedObject object =
      value_of(scan::snap_object(meters, mesh::Affine{}, voxel_size_m, "scene"));
  const auto tree = scan::scan_convert(object, {0, 0, 0});
  like.for_each([&](const lattice::VoxelIndex& v) {
    const masks::Coord c(static_cast<int>(v[0]), static_cast<int>(v[1]), static_cast<int>(v[2]));
    outcome.touched.at(v) = tree->isValueOn(c) ? 1 : 0;
  });
  return outcome;
}

Outcome run_peer(const std::string& program, const mesh::Mesh& in_voxels,
                 const GridMaker& make_grid) {
  const VoxelRun run = program == "vtk"
                           ? vtk_voxels(in_voxels)
                           : mesh_to_volume_voxels(in_voxels, std::stod(program.substr(15)));
  const DenseGrid like = make_grid();
  Outcome outcome{run.wall_s, run.cpu_s, run.peak_rss_bytes, like, like};
  for (const lattice::VoxelIndex& v : run.voxels) {
    if (like.contains(v)) outcome.touched.at(v) = 1;
  }
  outcome.values = reference::offset_scene(scene_of(outcome.touched), kLayers);
  return outcome;
}

// The mid-surface of the force layer runs through the centers of the surface voxels, where the
// level field is zero. How far these are from the mesh, in voxels.
Json mid_surface(const DenseGrid& values, const mesh::Mesh& in_voxels, std::size_t samples) {
  std::vector<mesh::Vec3d> centers;
  values.for_each([&](const lattice::VoxelIndex& v) {
    if (values.at(v) != static_cast<std::uint8_t>(VoxelValue::kSurface)) return;
    centers.push_back({static_cast<double>(v[0]) + 0.5, static_cast<double>(v[1]) + 0.5,
                       static_cast<double>(v[2]) + 0.5});
  });
  std::mt19937_64 random(1);
  std::shuffle(centers.begin(), centers.end(), random);
  centers.resize(std::min(centers.size(), samples));
  const std::vector<double> distances = vtk_distances(in_voxels, centers);
  double mean = 0, squares = 0, largest = 0;
  for (const double d : distances) mean += d / static_cast<double>(distances.size());
  for (const double d : distances) {
    squares += (d - mean) * (d - mean) / static_cast<double>(distances.size());
    largest = std::max(largest, std::abs(d - mean));
  }
  return {{"samples", distances.size()},
          {"offset_voxels", mean},
          {"rms_voxels", std::sqrt(squares)},
          {"max_voxels", largest}};
}

int run(int argc, char** argv) {
  CLI::App app{"How true the geometry of a bake is", "geometry_bench"};
  std::string program, path, units;
  int voxels = 128;
  std::size_t samples = 20000;
  app.add_option("program", program)
      ->required()
      ->check(CLI::IsMember(
          {"voxelize", "chebyshev", "mesh-to-volume-0.5", "mesh-to-volume-0.866", "vtk"}));
  app.add_option("scene", path)->required();
  app.add_option("--voxels", voxels, "across the longest side");
  app.add_option("--units", units, "of a mesh that has none: m or mm");
  app.add_option("--samples", samples, "surface voxels whose distance is measured");
  CLI11_PARSE(app, argc, argv);

  std::optional<double> unit_m;
  if (!units.empty()) unit_m = units == "mm" ? 1e-3 : 1.0;
  mesh::Mesh meters = merged(value_of(mesh::read_scene(std::span(&path, 1), unit_m)));
  const double voxel_size_m = longest_side(meters) / voxels;
  mesh::Mesh in_voxels = meters;
  for (mesh::Vec3d& vertex : in_voxels.vertices) {
    for (double& x : vertex) x /= voxel_size_m;
  }
  const auto snapped = [&] { return reference::snapped(meters, mesh::Affine{}, voxel_size_m); };
  const auto make_grid = [&] { return reference::grid_around({snapped()}, kLayers + 3); };
  const bool ours = program == "voxelize" || program == "chebyshev";
  const Metric metric = program == "voxelize" ? Metric::kEuclidean : Metric::kChebyshev;
  const Outcome outcome = ours ? run_voxelize(meters, voxel_size_m, metric, make_grid)
                               : run_peer(program, in_voxels, make_grid);
  DenseGrid grid = make_grid();
  reference::mark_geometry(snapped(), grid);
  const DenseGrid values = metric == Metric::kEuclidean
                               ? reference::euclidean_scene({snapped()}, scene_of(grid), kLayers)
                               : reference::offset_scene(scene_of(grid), kLayers);
  std::uint64_t truly = 0, missed = 0, added = 0, wrong = 0;
  grid.for_each([&](const lattice::VoxelIndex& v) {
    const bool is = grid.at(v) == 1, said = outcome.touched.at(v) == 1;
    truly += is;
    missed += is && !said;
    added += said && !is;
    wrong += outcome.values.at(v) != values.at(v);
  });
  const Json row = {{"program", program},
                    {"triangles", meters.triangles.size()},
                    {"voxels_across", voxels},
                    {"voxel_size_m", voxel_size_m},
                    {"wall_s", outcome.wall_s},
                    {"cpu_s", outcome.cpu_s},
                    {"peak_rss_bytes", outcome.peak_rss_bytes},
                    {"touched_voxels", truly},
                    {"missed_voxels", missed},
                    {"added_voxels", added},
                    {"wrong_classes", wrong},
                    {"mid_surface", mid_surface(outcome.values, in_voxels, samples)}};
  std::cout << row.dump() << std::endl;
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("geometry_bench", forcelayer::bench::run, argc, argv);
}
