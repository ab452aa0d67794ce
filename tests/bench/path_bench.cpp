// The clearance that voxcheck proves beside the meshes' exact distance, at 100,000 moments of
// random paths in generated scenes, the sample data and the shared models; and whether it finds
// paths that are 0.1 to 2 voxels too near.
//
//   path_bench [--family NAME]... [--moments N] [--models FOLDER] [--json FILE]
//
// Seeds are fixed: the moments are the same on every machine. Exit status 1 where more is proven
// than there is, or a path that is too near is not found.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>

#include "tests/bench/bench_report.h"
#include "tests/bench/scene_families.h"
#include "tests/stress/clearance_campaign.h"
#include "tests/stress/path_campaign.h"

namespace forcelayer::stress {
namespace {

using Json = nlohmann::ordered_json;

// Exact distances, in voxels.
constexpr std::pair<double, double> kRanges[] = {{0, 1.2}, {1.2, 3}, {3, 6}, {6, 10}, {10, 14}};

Json ranges_of(const std::vector<JudgedMoment>& moments) {
  Json rows = Json::array();
  for (const auto& [from, to] : kRanges) {
    std::vector<double> slack;
    for (const JudgedMoment& m : moments) {
      if (m.alone < 0 || m.premise_failed || m.exact < from || m.exact >= to) continue;
      slack.push_back(m.exact - m.alone);
    }
    if (slack.empty()) continue;
    const std::size_t poses = slack.size();
    const Spread spread = spread_of(std::move(slack));
    rows.push_back({{"from_voxels", from},
                    {"to_voxels", to},
                    {"poses", poses},
                    {"median", spread.median},
                    {"p99", spread.high},
                    {"most", spread.most}});
  }
  return rows;
}

Json report_of(const std::string& name, const JudgedPaths& judged) {
  const auto too_much = std::count_if(judged.moments.begin(), judged.moments.end(),
                                      [](const JudgedMoment& m) { return m.too_much(); });
  const Json ranges = ranges_of(judged.moments);
  std::printf("%s: %zu moments, %td above the truth; %llu of %llu paths that are too near found\n",
              name.c_str(), judged.moments.size(), too_much,
              static_cast<unsigned long long>(judged.found),
              static_cast<unsigned long long>(judged.planted));
  for (const Json& row : ranges) std::printf("  %s\n", row.dump().c_str());
  return {{"scenes", name},        {"moments", judged.moments.size()},
          {"too_much", too_much},  {"planted", judged.planted},
          {"found", judged.found}, {"ranges", ranges}};
}

void add(const JudgedPaths& judged, JudgedPaths& to) {
  to.moments.insert(to.moments.end(), judged.moments.begin(), judged.moments.end());
  to.planted += judged.planted;
  to.found += judged.found;
}

int run(int argc, char** argv) {
  CLI::App app{"What voxcheck proves against the exact distance", "path_bench"};
  bench::FamilyChoice choice;
  choice.generated_share = 0.6;
  std::string json;
  bench::add_options(app, "--moments", choice);
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  std::map<std::string, JudgedPaths> by_group;
  bench::judge_families(choice, [&](const ClearanceFamily& family, std::uint64_t seed) {
    const JudgedPaths judged = judge_paths(family.make(seed, choice.models), seed, family.poses);
    add(judged, by_group[std::string(family.group)]);
    add(judged, by_group["all"]);
    return judged.moments.size();
  });
  Json results = Json::array();
  bool failed = false;
  for (const char* group : {"generated", "sample", "shared", "all"}) {
    if (!by_group.contains(group)) continue;
    const Json row = report_of(group, by_group[group]);
    failed |= row["too_much"].get<int>() > 0 || row["planted"] != row["found"];
    results.push_back(row);
  }
  bench::write_report("path", argc, argv, results, json);
  return failed ? 1 : 0;
}

}  // namespace
}  // namespace forcelayer::stress

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("path_bench", forcelayer::stress::run, argc, argv);
}
