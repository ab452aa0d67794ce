// The contact query by motion and shell size, beside peers: an OpenVDB ValueAccessor on the same
// tree, and FCL, mesh against mesh. All take turns along the same recorded poses.
//
//   query_bench [--motion NAME]... [--from POINTS] [--largest POINTS] [--seconds S]
//               [--our-seconds S] [--threads N]... [--no-peers]
//               [--json FILE]
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <random>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include "runtime/query/contact_query.h"
#include "runtime/query/query_kernel.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/query_bench_fcl.h"
#include "tests/bench/query_bench_openvdb.h"
#include "tests/bench/query_bench_setting.h"
#include "tests/stress/baked.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kFrames = 100'000;
constexpr std::size_t kStretch = 50;  // frames that a method runs before the next one does
constexpr std::size_t kColdFrames = 200;
constexpr std::size_t kColdPoints = 100'000'000;  // in all cold frames: flushing them takes longer
constexpr std::uint32_t kNotCompared = UINT32_MAX;  // of methods that count something else

struct Choice {
  std::vector<std::string> motions;
  std::size_t from = 100, largest = 1'000'000;
  double seconds = 0.5;     // a method may take, per motion and size
  double our_seconds = 10;  // the method as it is used, of which the percentiles are quoted
  std::vector<unsigned> threads = {2};  // that share a frame
  bool peers = true;
  std::string json;
};

// One way of answering the query; returns the number of points found.
struct Method {
  std::string name;
  std::function<std::uint32_t(const Pose&)> run;
  std::function<void()> before, after;  // a run, unmeasured; may be empty
  std::size_t same_as = 0;              // the method that finds the same
  std::vector<double> ns;
  std::vector<std::uint32_t> found;
  double spent_s = 0, may_spend_s = 0;

  bool is_done(std::size_t frames) const {
    return ns.size() >= frames || (spent_s > may_spend_s && ns.size() >= 20);
  }
};

// Everything of one part in one setting.
struct Contest {
  Contest(const Setting& setting, const SpherePart& part, const Choice& choice);

  void add(const std::string& name, const Voxmap& scene, const query::QueryOptions& options);
  void add_peers(const Setting& setting, const SpherePart& part);
  void run_frame(Method& method, const Pose& pose);

  Voxmap map;
  std::optional<Voxmap> lean, chebyshev;  // of the same scene, without distances
  const Pshell& shell;
  query::CollectedPoints collected;
  std::vector<std::unique_ptr<query::ContactQuery>> queries;
  std::unique_ptr<AccessorQuery> accessor;
  std::unique_ptr<FclQuery> fcl, grown_fcl;
  std::vector<Method> methods;
};

// As voxelize writes it where nothing else is said.
Voxmap baked(const mesh::Mesh& scene, test::VoxelKind kind = test::VoxelKind::kFull) {
  return stress::BakedScene(scene, kVoxelSizeM).open(kind);
}

Contest::Contest(const Setting& setting, const SpherePart& part, const Choice& choice)
    : map(baked(setting.scene)), shell(part.shell) {
  collected.reserve(shell.view().point_count);
  add("all skipping", map, {});
  for (const unsigned threads : choice.threads) {
    query::QueryOptions shared;
    shared.threads = threads;
    add("all skipping, " + std::to_string(threads) + " threads", map, shared);
  }
  query::QueryOptions plain;
  plain.skip = {false, false, false, true};
  add("no skipping", map, plain);
  if (setting.name == "wall") {
    lean = baked(setting.scene, test::VoxelKind::kLean);
    chebyshev = baked(setting.scene, test::VoxelKind::kChebyshev);
    add("lean file, Euclidean layers", *lean, {});
    add("lean file, Chebyshev layers", *chebyshev, {});
    methods.back().same_as = methods.size() - 1;
  }
  if (choice.peers) add_peers(setting, part);
}

void Contest::add(const std::string& name, const Voxmap& scene,
                  const query::QueryOptions& options) {
  queries.push_back(std::make_unique<query::ContactQuery>(scene, shell, options));
  query::ContactQuery* query = queries.back().get();
  Method method;
  method.name = name;
  method.run = [this, query](const Pose& pose) {
    query->run(pose, collected);
    return collected.count;
  };
  if (options.threads > 1) {
    method.before = [query] { query->wake(); };
    method.after = [query] { query->rest(); };
  }
  methods.push_back(std::move(method));
}

void Contest::add_peers(const Setting& setting, const SpherePart& part) {
  const query::ContactQuery& query = *queries.front();
  const auto add_peer = [this](const char* name, std::function<std::uint32_t(const Pose&)> run) {
    Method method;
    method.name = name;
    method.run = std::move(run);
    methods.push_back(std::move(method));
  };
  accessor = std::make_unique<AccessorQuery>(map);
  add_peer("OpenVDB ValueAccessor",
           [&](const Pose& pose) { return accessor->collect(query, pose, collected); });
  const mesh::Mesh mesh = sphere_mesh(part.radius_m);
  fcl = std::make_unique<FclQuery>(setting.scene, mesh);
  grown_fcl = std::make_unique<FclQuery>(setting.grown, mesh);
  add_peer("FCL meshes, contacts", [&](const Pose& pose) {
    grown_fcl->contacts(pose);
    return kNotCompared;
  });
  add_peer("FCL meshes, distance", [&](const Pose& pose) {
    fcl->distance_m(pose);
    return kNotCompared;
  });
}

void Contest::run_frame(Method& method, const Pose& pose) {
  if (method.before) method.before();
  const double begin = now_s();
  const std::uint32_t found = method.run(pose);
  const double took = now_s() - begin;
  if (method.after) method.after();
  method.ns.push_back(took * 1e9);
  method.found.push_back(found);
  method.spent_s += took;
}

// Stretches of frames in random order, so that no method always follows the same one, and caches
// are as warm as a loop that does nothing else would find them.
void run_warm(Contest& contest, const Setting& setting, const Choice& choice) {
  std::mt19937_64 random(1);
  std::vector<Method*> left;
  for (Method& method : contest.methods) {
    method.may_spend_s = left.empty() ? choice.our_seconds : choice.seconds;
    left.push_back(&method);
  }
  while (!left.empty()) {
    std::shuffle(left.begin(), left.end(), random);
    for (Method* method : left) {
      for (std::size_t i = 0; i < kStretch && !method->is_done(setting.poses.size()); ++i) {
        contest.run_frame(*method, setting.poses[method->ns.size()]);
      }
    }
    std::erase_if(left,
                  [&](const Method* method) { return method->is_done(setting.poses.size()); });
  }
}

// Every method that counts the same finds the same in each frame.
void compare(const Contest& contest, const Setting& setting) {
  for (const Method& method : contest.methods) {
    const Method& first = contest.methods[method.same_as];
    for (std::size_t i = 0; i < std::min(method.found.size(), first.found.size()); ++i) {
      if (method.found[i] == kNotCompared || method.found[i] == first.found[i]) continue;
      throw std::runtime_error(setting.name + ", frame " + std::to_string(i) + ": " + method.name +
                               " found " + std::to_string(method.found[i]) + " points instead of " +
                               std::to_string(first.found[i]));
    }
  }
}

// Throws the bytes out of all caches. False where this machine offers no way.
bool evict(const void* begin, std::size_t bytes) {
#if defined(__SSE2__)
  for (std::size_t at = 0; at < bytes; at += 64) {
    _mm_clflush(static_cast<const char*>(begin) + at);
  }
  return true;
#else
  (void)begin, (void)bytes;
  return false;
#endif
}

template <class T>
bool evict(const std::vector<T>& values) {
  return evict(values.data(), values.size() * sizeof(T));
}

bool evict_all(const Contest& contest) {
  const query::CollectedPoints& c = contest.collected;
  bool done = evict(contest.map.bytes().data(), contest.map.bytes().size());
  done = done && evict(contest.shell.bytes().data(), contest.shell.bytes().size());
  done = done && evict(c.index) && evict(c.value);
  for (const auto* v : {&c.vx, &c.vy, &c.vz}) done = done && evict(*v);
  for (const auto* v : {&c.fx, &c.fy, &c.fz, &c.rx, &c.ry, &c.rz, &c.nx, &c.ny, &c.nz}) {
    done = done && evict(*v);
  }
  return done;
}

// The same motion with map, shell and results out of the caches before every frame. What the
// skipper keeps of each block stays warm.
void add_cold(Contest& contest, const Setting& setting) {
  Method cold;
  cold.name = "all skipping, cold";
  cold.run = contest.methods.front().run;
  const std::size_t frames =
      std::min({kColdFrames, setting.poses.size(), kColdPoints / contest.shell.view().point_count});
  for (std::size_t i = 0; i < frames; ++i) {
    if (!evict_all(contest)) return;
    contest.run_frame(cold, setting.poses[i]);
  }
  contest.methods.push_back(std::move(cold));
}

void add_rows(const Setting& setting, std::size_t points, const Contest& contest, Json& rows) {
  const std::vector<std::uint32_t>& found = contest.methods.front().found;
  double sum = 0;
  for (const std::uint32_t n : found) sum += n;
  for (const Method& method : contest.methods) {
    const Percentiles ns = percentiles(method.ns);
    rows.push_back({{"motion", setting.name},
                    {"points", points},
                    {"points_in_band", sum / double(found.size())},
                    {"method", method.name},
                    {"frames", method.ns.size()},
                    {"p50_us", ns.p50 / 1e3},
                    {"p99_us", ns.p99 / 1e3},
                    {"p999_us", ns.p999 / 1e3},
                    {"max_us", ns.max / 1e3}});
    std::printf("%-10s %9zu  %-28s %6zu frames  p50 %11.2f us  p99 %11.2f us\n",
                setting.name.c_str(), points, method.name.c_str(), method.ns.size(), ns.p50 / 1e3,
                ns.p99 / 1e3);
  }
  std::fflush(stdout);
}

void measure(const Choice& choice, int argc, char** argv) {
  Json rows = Json::array();
  std::printf("instruction set %s\n", query::kernel_target());
  for (std::size_t points = choice.from; points <= choice.largest; points *= 10) {
    const SpherePart part(points);
    for (const std::string& motion : choice.motions) {
      const Setting setting = make_setting(motion, part.radius_m, kFrames);
      Contest contest(setting, part, choice);
      run_warm(contest, setting, choice);
      compare(contest, setting);
      if (motion == "wall") add_cold(contest, setting);
      add_rows(setting, points, contest, rows);
    }
  }
  write_report("query", argc, argv, rows, choice.json);
}

int run(int argc, char** argv) {
  CLI::App app{"The contact query, its ways of working and its peers", "query_bench"};
  Choice choice;
  app.add_option("--motion", choice.motions, "motions; all by default")
      ->check(CLI::IsMember(
          std::vector<std::string>(std::begin(kSettingNames), std::end(kSettingNames))));
  app.add_option("--from", choice.from, "points of the smallest shell");
  app.add_option("--largest", choice.largest, "points of the largest shell");
  app.add_option("--seconds", choice.seconds, "that a method may take per motion and size");
  app.add_option("--our-seconds", choice.our_seconds, "the same of the query as it is used");
  app.add_option("--threads", choice.threads, "that share a frame, each beside one alone")
      ->capture_default_str();
  app.add_flag("!--no-peers", choice.peers, "our own ways of working alone");
  app.add_option("--json", choice.json, "report; by default under build/bench");
  CLI11_PARSE(app, argc, argv);
  if (choice.motions.empty())
    choice.motions.assign(std::begin(kSettingNames), std::end(kSettingNames));
  measure(choice, argc, argv);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("query_bench", forcelayer::bench::run, argc, argv);
}
