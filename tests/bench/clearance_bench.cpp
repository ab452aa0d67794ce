// Proven clearances beside the exact distances of the meshes, in generated scenes, the sample data
// and the shared models:
//
//   clearance_bench frames   the clearance of a frame, at 100,000 random poses
//   clearance_bench paths    the clearance that voxcheck proves, at 100,000 moments of random
//   paths;
//                            and whether it finds paths that are 0.1 to 2 voxels too near
//
//   [--family NAME]... [--count N] [--models FOLDER] [--json FILE]
//
// Seeds are fixed: the poses are the same on every machine. Exit status 1 where more is proven than
// there is, or a path that is too near is not found.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>

#include "tests/bench/bench_report.h"
#include "tests/stress/clearance_campaign.h"
#include "tests/stress/clearance_cases.h"
#include "tests/stress/path_campaign.h"
#include "tests/support/places.h"

namespace forcelayer::stress {
namespace {

using Json = nlohmann::ordered_json;

struct Choice {
  std::string what, models = test::source_path("../shared/models"), json;
  std::size_t count = 100'000;    // of all families together
  std::vector<std::string> only;  // families; all where empty
};

constexpr const char* kGroups[] = {"generated", "sample", "shared", "all"};

// Judges whole scenes of each family, from seed 1 on, until there are enough. The generated family
// has `generated_fraction` of them, the others share the rest. `judge` says how many it judged.
template <class Judge>
void judge_families(const Choice& choice, double generated_fraction, const Judge& judge) {
  const auto families = clearance_families();
  const double each = (1 - generated_fraction) / static_cast<double>(families.size() - 1);
  for (const ClearanceFamily& family : families) {
    const std::string name(family.name), needs(family.needs);
    if (!choice.only.empty() && std::ranges::find(choice.only, name) == choice.only.end()) continue;
    if (!needs.empty() && !std::filesystem::exists(std::filesystem::path(choice.models) / needs)) {
      std::printf("%s left out: no %s\n", name.c_str(), needs.c_str());
      continue;
    }
    const double fraction = family.group == "generated" ? generated_fraction : each;
    const auto wanted = static_cast<std::size_t>(fraction * static_cast<double>(choice.count));
    std::size_t judged = 0;
    for (std::uint64_t seed = 1; judged < wanted; ++seed) judged += judge(family, seed);
  }
}

void add_row(Json& rows, Json row) {
  std::printf("%s\n", row.dump().c_str());
  std::fflush(stdout);
  rows.push_back(std::move(row));
}

// Whether all is well.
bool judge_frames(const Choice& choice, Json& results) {
  // Exact distances, in voxels; an end of 0 is that of the band.
  constexpr std::pair<double, double> kRanges[] = {{0, 0.3}, {0.3, 0.6}, {0.6, 0.9}, {0.9, 1.2},
                                                   {1.2, 0}, {1.2, 2},   {2, 0}};
  std::map<std::string, std::vector<JudgedPose>> by_group;
  judge_families(choice, 0.4, [&](const ClearanceFamily& family, std::uint64_t seed) {
    const auto judged = judge_scene(family.make(seed, choice.models), seed, family.poses);
    for (const std::string& group : {std::string(family.group), std::string("all")}) {
      by_group[group].insert(by_group[group].end(), judged.begin(), judged.end());
    }
    return judged.size();
  });
  std::ptrdiff_t failed = 0;
  for (const char* group : kGroups) {
    if (!by_group.contains(group)) continue;
    const std::vector<JudgedPose>& poses = by_group[group];
    const auto too_much =
        std::ranges::count_if(poses, [](const JudgedPose& p) { return p.too_much; });
    const ObjectSummary objects = objects_of(poses);
    failed += too_much;
    add_row(results["clearance_poses"],
            {{"scenes", group},
             {"poses", poses.size()},
             {"too_much", too_much},
             {"premise_failed",
              std::ranges::count_if(poses, [](const JudgedPose& p) { return p.premise_failed; })},
             {"objects_right", objects.right},
             {"objects_wrong", objects.wrong}});
    for (const auto& [from, to] : kRanges) {
      const ClearanceSummary summary = summary_of(poses, from, to);
      if (summary.poses == 0) continue;
      add_row(results["clearance"], {{"scenes", group},
                                     {"from_voxels", from},
                                     {"to_voxels", to > 0 ? Json(to) : Json(nullptr)},
                                     {"poses", summary.poses},
                                     {"without", summary.without},
                                     {"slack_median", summary.slack.median},
                                     {"slack_p99", summary.slack.high},
                                     {"slack_most", summary.slack.largest}});
    }
  }
  return failed == 0;
}

bool judge_all_paths(const Choice& choice, Json& results) {
  // Exact distances, in voxels.
  constexpr std::pair<double, double> kRanges[] = {{0, 1.2}, {1.2, 3}, {3, 6}, {6, 10}, {10, 14}};
  std::map<std::string, JudgedPaths> by_group;
  judge_families(choice, 0.6, [&](const ClearanceFamily& family, std::uint64_t seed) {
    const JudgedPaths judged = judge_paths(family.make(seed, choice.models), seed, family.poses);
    for (const std::string& group : {std::string(family.group), std::string("all")}) {
      JudgedPaths& sum = by_group[group];
      sum.moments.insert(sum.moments.end(), judged.moments.begin(), judged.moments.end());
      sum.planted += judged.planted, sum.found += judged.found;
    }
    return judged.moments.size();
  });
  bool well = true;
  for (const char* group : kGroups) {
    if (!by_group.contains(group)) continue;
    const JudgedPaths& judged = by_group[group];
    const auto too_much =
        std::ranges::count_if(judged.moments, [](const JudgedMoment& m) { return m.too_much(); });
    well = well && too_much == 0 && judged.planted == judged.found;
    add_row(results["path_poses"], {{"scenes", group},
                                    {"moments", judged.moments.size()},
                                    {"too_much", too_much},
                                    {"planted", judged.planted},
                                    {"found", judged.found}});
    for (const auto& [from, to] : kRanges) {
      std::vector<double> slack;
      for (const JudgedMoment& m : judged.moments) {
        if (m.alone < 0 || m.premise_failed || m.exact < from || m.exact >= to) continue;
        slack.push_back(m.exact - m.alone);
      }
      if (slack.empty()) continue;
      const std::size_t poses = slack.size();
      const Spread spread = spread_of(std::move(slack));
      add_row(results["path"], {{"scenes", group},
                                {"from_voxels", from},
                                {"to_voxels", to},
                                {"poses", poses},
                                {"median", spread.median},
                                {"p99", spread.high},
                                {"most", spread.largest}});
    }
  }
  return well;
}

int run(int argc, char** argv) {
  CLI::App app{"Proven clearances against exact distances", "clearance_bench"};
  Choice choice;
  app.add_option("what", choice.what, "frames or paths")
      ->required()
      ->check(CLI::IsMember({"frames", "paths"}));
  app.add_option("--family", choice.only, "\"generated\", \"pump on bay\", ... (default: all)");
  app.add_option("--count", choice.count, "poses or moments, of all families together")
      ->check(CLI::PositiveNumber);
  app.add_option("--models", choice.models, "folder of the models");
  app.add_option("--json", choice.json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);
  const bool frames = choice.what == "frames";
  Json results;
  const bool well = frames ? judge_frames(choice, results) : judge_all_paths(choice, results);
  bench::write_report(frames ? "clearance" : "path", argc, argv, results, choice.json);
  return well ? 0 : 1;
}

}  // namespace
}  // namespace forcelayer::stress

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("clearance_bench", forcelayer::stress::run, argc, argv);
}
