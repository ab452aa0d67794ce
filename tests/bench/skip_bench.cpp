// The parts of a baked scene that a contact query skips, and the saving of each way of skipping:
// one scene and part as a line of JSON. skipped.py runs it over scenes.
//
//   skip_bench SCENE.vox PART.pshell [--places N] [--frames N]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <iostream>
#include <optional>
#include <random>
#include <stdexcept>
#include <unordered_map>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/query/contact_query.h"
#include "tests/bench/bench_report.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kSpeedMps = 0.05, kFrameS = 0.001, kTurnRad = 0.0005;  // a slow hand at 1 kHz
constexpr double kReachVoxels = 5;                                      // of the sliding to and fro

template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

// The tree as it would be with nothing stored twice: entries by level and value.
struct TreeCount {
  std::uint64_t bricks = 0;                        // that some entry points to
  std::uint64_t uniform_voxels[4] = {0, 0, 0, 0};  // in uniform boxes, by value code
};

class TreeCounter {
 public:
  explicit TreeCounter(const Voxmap& voxmap) : view_(voxmap.view()) {}

  TreeCount all() {
    TreeCount sum;
    const auto& dims = view_.directory_dims;
    for (std::int64_t n = 0; n < std::int64_t{dims[0]} * dims[1] * dims[2]; ++n) {
      add(sum, of_entry(view_.directory[n], 3));
    }
    return sum;
  }

 private:
  static void add(TreeCount& sum, const TreeCount& more) {
    sum.bricks += more.bricks;
    for (int code = 0; code < 4; ++code) sum.uniform_voxels[code] += more.uniform_voxels[code];
  }

  TreeCount of_entry(std::uint32_t entry, int level) {
    TreeCount count;
    if (is_uniform(entry)) {
      const std::uint64_t edge = std::uint64_t{1} << (3 * level);
      count.uniform_voxels[uniform_value(entry) & 3] = edge * edge * edge;
    } else if (level == 1) {
      count.bricks = 1;
    } else {
      count = of_node(entry, level);
    }
    return count;
  }

  const TreeCount& of_node(std::uint32_t node, int level) {
    auto& known = known_[level - 2];
    if (const auto found = known.find(node); found != known.end()) return found->second;
    const std::uint32_t* entries =
        (level == 3 ? view_.upper_nodes : view_.lower_nodes) + std::uint64_t{node} * kNodeEntries;
    TreeCount sum;
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) add(sum, of_entry(entries[n], level - 1));
    return known[node] = sum;
  }

  VoxmapView view_;
  std::unordered_map<std::uint32_t, TreeCount> known_[2];  // nodes may be shared
};

Json tree_facts(const Voxmap& voxmap) {
  const VoxmapHeader& header = voxmap.header();
  const TreeCount count = TreeCounter(voxmap).all();
  const auto& dims = header.dims_voxels;
  return {{"voxels_in_box", std::uint64_t{dims[0]} * dims[1] * dims[2]},
          {"voxels_not_free",
           std::uint64_t{header.interior_voxels} + header.surface_voxels + header.proximity_voxels},
          {"voxels_in_bricks", count.bricks * 512},
          {"interior_voxels_in_uniform_boxes", count.uniform_voxels[1]},
          {"bricks_needed", count.bricks},
          {"bricks_stored", voxmap.brick_count()},
          {"pages_of_file", (voxmap.bytes().size() + 4095) / 4096}};
}

// The part's way: from free space along a random line until a point is in the force layer, then to
// and fro across that line, turning.
class Places {
 public:
  Places(const Voxmap& voxmap, const Pshell& shell) : map_(voxmap), query_(voxmap, shell) {
    found_.reserve(shell.view().point_count);
  }

  std::vector<Pose> frames(std::size_t places, std::size_t frames_each) {
    std::vector<Pose> poses;
    for (std::size_t tries = 0; poses.size() < places * frames_each; ++tries) {
      if (tries > 1000 * places) throw std::runtime_error("no place where the part touches");
      const std::optional<Pose> touching = touch();
      if (!touching) continue;
      const glm::dvec3 along = direction(), axis = direction();
      const double reach_m = kReachVoxels * map_.voxel_size_m();
      for (std::size_t n = 0; n < frames_each; ++n) {
        const double phase = std::fmod(kSpeedMps * kFrameS * double(n), 4 * reach_m);
        Pose pose = *touching;
        pose.position_m += along * (std::abs(phase - 2 * reach_m) - 2 * reach_m);
        pose.orientation = glm::angleAxis(kTurnRad * double(n), axis) * pose.orientation;
        poses.push_back(pose);
      }
    }
    return poses;
  }

 private:
  glm::dvec3 direction() {
    const double x = normal_(random_), y = normal_(random_), z = normal_(random_);
    return glm::normalize(glm::dvec3(x, y, z));
  }

  std::optional<Pose> touch() {
    const VoxmapHeader& header = map_.header();
    Pose pose;
    for (int d = 0; d < 3; ++d) {
      const auto i = static_cast<std::size_t>(d);
      const double share = std::uniform_real_distribution<double>(0, 1)(random_);
      pose.position_m[d] =
          (double(header.origin_voxel[i]) + share * header.dims_voxels[i]) * header.voxel_size_m;
    }
    pose.orientation = glm::normalize(
        glm::dquat(normal_(random_), normal_(random_), normal_(random_), normal_(random_)));
    query_.run(pose, found_);
    if (found_.count > 0) return std::nullopt;
    const glm::dvec3 way = direction() * (0.25 * header.voxel_size_m);
    for (int n = 0; n < 1000; ++n) {
      pose.position_m += way;
      query_.run(pose, found_);
      if (found_.interior_count > 0) return std::nullopt;
      if (found_.surface_count > 0) return pose;
    }
    return std::nullopt;
  }

  const Voxmap& map_;
  query::ContactQuery query_;
  query::CollectedPoints found_;
  std::mt19937_64 random_{1};
  std::normal_distribution<double> normal_;
};

// Pages of the map that were touched since forget_pages(), by the kernel's own count; none where it
// does not tell, or tells 0, since every query reads the map.
void forget_pages() { std::ofstream("/proc/self/clear_refs") << "1\n"; }

std::optional<std::uint64_t> touched_pages(const void* mapped) {
  std::ifstream file("/proc/self/smaps");
  bool inside = false;
  const auto address = reinterpret_cast<std::uintptr_t>(mapped);
  for (std::string line; std::getline(file, line);) {
    unsigned long low = 0, high = 0, kib = 0;
    if (std::sscanf(line.c_str(), "%lx-%lx ", &low, &high) == 2 && line.find(": ") > 16) {
      inside = address >= low && address < high;
    } else if (inside && std::sscanf(line.c_str(), "Referenced: %lu kB", &kib) == 1) {
      return kib > 0 ? std::optional<std::uint64_t>(kib / 4) : std::nullopt;
    }
  }
  return std::nullopt;
}

struct Way {
  const char* name;
  query::SkipOptions skip;  // clearance, super-blocks, coherence, walls
};
constexpr Way kWays[] = {{"all skipping", {true, true, true, true}},
                         {"no coherence", {true, true, false, true}},
                         {"no super-blocks", {true, false, true, true}},
                         {"no walls", {true, true, true, false}},
                         {"no skipping", {false, false, false, false}}};

Json run_way(const Way& way, const Voxmap& voxmap, const Pshell& shell,
             const std::vector<Pose>& poses, std::uint64_t& found) {
  query::QueryOptions options;
  options.skip = way.skip;
  query::ContactQuery query(voxmap, shell, options);
  query::CollectedPoints collected;
  collected.reserve(shell.view().point_count);
  std::vector<double> us;
  double looked_at = 0;
  found = 0;
  forget_pages();
  for (const Pose& pose : poses) {
    const double start_s = now_s();
    query.run(pose, collected);
    us.push_back(1e6 * (now_s() - start_s));
    looked_at += double(query.points_looked_at());
    found += collected.count;
  }
  const std::optional<std::uint64_t> pages = touched_pages(voxmap.bytes().data());
  const double frames = double(poses.size());
  return {{"points_looked_at", looked_at / frames},
          {"blocks_looked_at", looked_at / frames / double(shell.view().block_points)},
          {"points_found", double(found) / frames},
          {"pages_touched", pages ? Json(*pages) : Json(nullptr)},
          {"frame_us", to_json(percentiles(us))}};
}

int run(int argc, char** argv) {
  CLI::App app{"What a contact query need not look at", "skip_bench"};
  std::string scene, part;
  std::size_t places = 20, frames = 1000;
  app.add_option("scene", scene)->required();
  app.add_option("part", part)->required();
  app.add_option("--places", places, "where the part touches")->check(CLI::PositiveNumber);
  app.add_option("--frames", frames, "at each of them")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  const Voxmap voxmap = value_of(Voxmap::open(scene));
  const Pshell shell = value_of(Pshell::open(part));
  const std::vector<Pose> poses = Places(voxmap, shell).frames(places, frames);
  Json row{{"tree", tree_facts(voxmap)},
           {"points", shell.view().point_count},
           {"blocks", shell.view().block_count},
           {"super_blocks", shell.view().super_block_count},
           {"frames", poses.size()}};
  std::uint64_t expected = 0;
  for (const Way& way : kWays) {
    std::uint64_t found = 0;
    row["ways"][way.name] = run_way(way, voxmap, shell, poses, found);
    if (expected == 0) expected = found;
    if (found != expected) throw std::runtime_error(std::string(way.name) + " finds other points");
  }
  std::cout << row.dump() << std::endl;
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("skip_bench", forcelayer::bench::run, argc, argv);
}
