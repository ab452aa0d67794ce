// The clearance of a frame beside the exact distance of the meshes, at 100,000 random poses of
// generated scenes, the sample data and the shared models.
//
//   clearance_bench [--family NAME]... [--poses N] [--models FOLDER] [--json FILE]
//
// Seeds are fixed: the poses are the same on every machine. Exit status 1 where a clearance is
// above the exact distance.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>

#include "tests/bench/bench_report.h"
#include "tests/bench/scene_families.h"
#include "tests/stress/clearance_campaign.h"

namespace forcelayer::stress {
namespace {

using Json = nlohmann::ordered_json;

// Exact distances, in voxels; an end of 0 is that of the band.
constexpr std::pair<double, double> kRanges[] = {{0, 0.3}, {0.3, 0.6}, {0.6, 0.9}, {0.9, 1.2},
                                                 {1.2, 0}, {1.2, 2},   {2, 0}};

Json to_json(const Spread& spread, std::uint64_t sample) {
  if (sample == 0) return nullptr;
  return {{"median", spread.median}, {"p99", spread.high}, {"most", spread.most}};
}

Json rows_of(const std::vector<JudgedPose>& poses) {
  Json rows = Json::array();
  for (const auto& [from, to] : kRanges) {
    const ClearanceSummary summary = summary_of(poses, from, to);
    if (summary.poses == 0) continue;
    rows.push_back({{"from_voxels", from},
                    {"to_voxels", to > 0 ? Json(to) : Json(nullptr)},
                    {"poses", summary.poses},
                    {"without", summary.without},
                    {"slack", to_json(summary.slack, summary.poses)},
                    {"compared", summary.compared},
                    {"of_provable", to_json(summary.of_provable, summary.compared)},
                    {"of_by_points", to_json(summary.of_by_points, summary.compared)}});
  }
  return rows;
}

Json report_of(const std::string& name, const std::vector<JudgedPose>& poses) {
  const ObjectSummary objects = objects_of(poses);
  const auto count = [&](auto&& what) { return std::count_if(poses.begin(), poses.end(), what); };
  const Json rows = rows_of(poses);
  std::printf("%s: %zu poses, %td above the truth; objects right %llu of %llu\n", name.c_str(),
              poses.size(), count([](const JudgedPose& p) { return p.too_much; }),
              static_cast<unsigned long long>(objects.right),
              static_cast<unsigned long long>(objects.right + objects.wrong));
  for (const Json& row : rows) std::printf("  %s\n", row.dump().c_str());
  return {{"scenes", name},
          {"poses", poses.size()},
          {"too_much", count([](const JudgedPose& p) { return p.too_much; })},
          {"premise_failed", count([](const JudgedPose& p) { return p.premise_failed; })},
          {"objects_right", objects.right},
          {"objects_wrong", objects.wrong},
          {"ranges", rows}};
}

int run(int argc, char** argv) {
  CLI::App app{"Proven clearance against the exact distance", "clearance_bench"};
  bench::FamilyChoice choice;
  choice.generated_share = 0.4;
  std::string json;
  bench::add_options(app, "--poses", choice);
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  std::map<std::string, std::vector<JudgedPose>> by_group;
  bench::judge_families(choice, [&](const ClearanceFamily& family, std::uint64_t seed) {
    const auto judged = judge_scene(family.make(seed, choice.models), seed, family.poses);
    for (const std::string& group : {std::string(family.group), std::string("all")}) {
      by_group[group].insert(by_group[group].end(), judged.begin(), judged.end());
    }
    return judged.size();
  });
  Json results = Json::array();
  bool too_much = false;
  for (const char* group : {"generated", "sample", "shared", "all"}) {
    if (!by_group.contains(group)) continue;
    results.push_back(report_of(group, by_group[group]));
    too_much |= results.back()["too_much"].get<int>() > 0;
  }
  bench::write_report("clearance", argc, argv, results, json);
  return too_much ? 1 : 0;
}

}  // namespace
}  // namespace forcelayer::stress

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("clearance_bench", forcelayer::stress::run, argc, argv);
}
