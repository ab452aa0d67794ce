// The contact query against a wall, by shell size and way of working, beside an OpenVDB
// ValueAccessor on the same tree: all methods in turn at every frame of one motion.
//
//   query_bench [--frames N] [--largest POINTS] [--json FILE]
//
// Spheres of 0.63 points per squared voxel (what certified surface shells spend) slide and turn on
// a wall of 320 x 320 voxels, their lowest points in the force layer. What the peer leaves out, in
// its favour: it collects nothing, it only counts.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "runtime/contact_query.h"
#include "runtime/query_kernel.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/query_bench_accessor.h"
#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::bench {
namespace {

using test::PointPart;
using test::Voxel;
using test::VoxelScene;

constexpr double kVoxelSizeM = 0.001;
constexpr double kPointsPerVoxelArea = 0.63;
constexpr double kLayerTopVoxels = 3;  // the wall fills z < 1, the force layer is z in [2, 3)

// Interleaves the bits of three 10-bit numbers.
std::uint32_t morton(const std::array<float, 3>& p, float radius) {
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto cell = static_cast<std::uint32_t>((p[axis] / radius * 0.499f + 0.5f) * 1023);
    for (std::uint32_t bit = 0; bit < 10; ++bit) code |= ((cell >> bit) & 1u) << (3 * bit + axis);
  }
  return code;
}

// A sphere whose points stand along a space-filling curve, as pointshell writes them.
PointPart curve_sphere(std::size_t points, double& radius_voxels) {
  radius_voxels = std::sqrt(double(points) / (4 * M_PI * kPointsPerVoxelArea));
  const PointPart spiral = test::sphere_part(radius_voxels * kVoxelSizeM, points, kVoxelSizeM);
  std::vector<std::size_t> order(points);
  for (std::size_t i = 0; i < points; ++i) order[i] = i;
  const auto radius_m = static_cast<float>(radius_voxels * kVoxelSizeM);
  std::vector<std::uint32_t> codes;
  for (const auto& p : spiral.points) codes.push_back(morton(p, radius_m));
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return codes[a] < codes[b]; });
  PointPart part = spiral;
  for (std::size_t i = 0; i < points; ++i) {
    part.points[i] = spiral.points[order[i]];
    part.normals[i] = spiral.normals[order[i]];
  }
  return part;
}

// Frame n of the motion: a hand at 50 mm/s and 0.5 rad/s at 1 kHz, half a voxel up and down.
Pose pose_of(int frame, double radius_voxels) {
  Pose pose;
  const double z = kLayerTopVoxels - 0.5 + 0.5 * std::sin(0.01 * frame) + radius_voxels;
  pose.position_m = glm::dvec3(0.05 * std::fmod(frame, 1000.0) - 25, 3, z) * kVoxelSizeM;
  pose.orientation = glm::angleAxis(0.0005 * frame, glm::normalize(glm::dvec3(0.3, 1, 0.2)));
  return pose;
}

// One way of answering the query; returns the number of points found.
struct Method {
  std::string name;
  std::function<std::uint32_t(const Pose&)> run;
  std::vector<double> ns;
};

struct Ways {
  std::vector<std::unique_ptr<ContactQuery>> queries;
  CollectedPoints found;
  std::vector<Method> methods;

  void add(const char* name, const Voxmap& map, const Pshell& shell, const QueryOptions& options) {
    queries.push_back(std::make_unique<ContactQuery>(map, shell, options));
    ContactQuery* query = queries.back().get();
    methods.push_back({name,
                       [this, query](const Pose& pose) {
                         query->run(pose, found);
                         return found.count;
                       },
                       {}});
  }
};

QueryOptions ways_of(bool clearance, bool super_blocks, bool coherence) {
  QueryOptions options;
  options.skip = {clearance, super_blocks, coherence};
  return options;
}

void add_methods(const Voxmap& map, const Pshell& shell, const AccessorQuery& peer, Ways& ways) {
  ways.add("all skipping", map, shell, ways_of(true, true, true));
  ways.add("no coherence", map, shell, ways_of(true, true, false));
  ways.add("no super-blocks", map, shell, ways_of(true, false, true));
  ways.add("no skipping", map, shell, ways_of(false, false, false));
  QueryOptions scalar = ways_of(false, false, false);
  scalar.vector = false;
  ways.add("scalar, no skipping", map, shell, scalar);
  const ContactQuery* query = ways.queries.back().get();
  ways.methods.push_back({"openvdb ValueAccessor",
                          [query, &peer](const Pose& pose) { return peer.count(*query, pose); },
                          {}});
}

nlohmann::ordered_json measure(const VoxelScene& scene, const Voxmap& map, std::size_t points,
                               int frames) {
  double radius_voxels = 0;
  const Pshell shell = test::make_pshell(curve_sphere(points, radius_voxels));
  const AccessorQuery peer(scene);
  Ways ways;
  ways.found.reserve(points);
  add_methods(map, shell, peer, ways);
  std::uint64_t found = 0;
  std::mt19937_64 random(1);
  std::vector<std::size_t> order(ways.methods.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (int frame = 0; frame < frames; ++frame) {
    const Pose pose = pose_of(frame, radius_voxels);
    std::uint32_t first = 0;
    // In another order at every frame: who comes after the peer meets the shell in cold caches.
    std::shuffle(order.begin(), order.end(), random);
    for (const std::size_t turn : order) {
      Method& method = ways.methods[turn];
      const double begin = now_s();
      const std::uint32_t count = method.run(pose);
      method.ns.push_back((now_s() - begin) * 1e9);
      if (turn == order.front()) first = count;
      if (count != first) throw std::runtime_error(method.name + " found other points");
    }
    found += first;
  }
  nlohmann::ordered_json row = {{"points", points},
                                {"frames", frames},
                                {"mean_points_in_band", double(found) / frames},
                                {"methods", nlohmann::ordered_json::object()}};
  for (const Method& method : ways.methods) {
    const Percentiles p = percentiles(method.ns);
    row["methods"][method.name] = {{"frame_ns", to_json(p)},
                                   {"ns_per_point", p.p50 / double(points)}};
    std::printf("%9zu  %-22s p50 %10.1f us  p99 %10.1f us  %7.3f ns a point\n", points,
                method.name.c_str(), p.p50 / 1e3, p.p99 / 1e3, p.p50 / double(points));
  }
  return row;
}

void run(int frames, std::size_t largest, const std::string& json, int argc, char** argv) {
  const VoxelScene scene = test::offset_scene(kVoxelSizeM, {-160, -160, -2}, {320, 320, 8}, 2,
                                              [](Voxel v) { return v[2] < 1; });
  const Voxmap map = test::make_voxmap(scene);
  nlohmann::ordered_json results = {{"instruction_set", kernel_target()},
                                    {"rows", nlohmann::ordered_json::array()}};
  std::printf("instruction set %s, %d frames\n", kernel_target(), frames);
  for (std::size_t points = 100; points <= largest; points *= 10) {
    const int share = std::max(20, static_cast<int>(frames / std::max(1.0, double(points) / 1e4)));
    results["rows"].push_back(measure(scene, map, points, share));
  }
  write_report("query", argc, argv, results, json);
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  CLI::App app{"The contact query against a wall", "query_bench"};
  int frames = 20000;
  std::size_t largest = 1'000'000;
  std::string json;
  app.add_option("--frames", frames, "frames for shells of up to 10^4 points, fewer beyond");
  app.add_option("--largest", largest, "points of the largest shell");
  app.add_option("--json", json, "report; by default under tests/bench/results");
  CLI11_PARSE(app, argc, argv);
  forcelayer::bench::run(frames, largest, json, argc, argv);
  return 0;
}
