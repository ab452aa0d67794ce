// What voxcheck proves along paths beside the exact distance of the meshes, at 100,000 moments of
// random paths in generated scenes, the sample data and the shared models; and whether it finds
// paths that are 0.1 to 2 voxels too near.
//
//   path_bench [--family NAME]... [--moments N] [--journal FILE] [--models FOLDER] [--json FILE]
//
// Seeds are fixed: the moments are the same on every machine. A journal keeps what was judged; a
// run that was ended goes on from it. Exit status 1 where more is proven than there is, or a path
// that is too near is not found.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/bench/bench_report.h"
#include "tests/stress/clearance_campaign.h"
#include "tests/stress/path_campaign.h"
#include "tests/support/places.h"

namespace forcelayer::stress {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Three fifths of the moments are of generated scenes; the other families share the rest.
constexpr double kGeneratedShare = 0.6;

using Chunk = std::pair<std::string, std::uint64_t>;  // family, seed

// A line a moment, and one with the planted paths behind the last one of a chunk.
class Journal {
 public:
  explicit Journal(const std::string& path) : path_(path) {
    std::ifstream file(path);
    JudgedPaths open;
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string kind, family;
      std::uint64_t seed = 0, count = 0;
      words >> kind;
      if (kind == "moment") {
        JudgedMoment m;
        words >> m.exact >> m.along >> m.alone >> m.premise_failed;
        open.moments.push_back(m);
      } else if (kind == "end" && words >> seed >> count >> open.planted >> open.found &&
                 std::getline(words >> std::ws, family)) {
        if (count == open.moments.size()) chunks_[{family, seed}] = open;
        open = {};
      }
    }
  }

  const JudgedPaths* find(const Chunk& chunk) const {
    const auto found = chunks_.find(chunk);
    return found == chunks_.end() ? nullptr : &found->second;
  }

  void keep(const Chunk& chunk, const JudgedPaths& judged) {
    chunks_[chunk] = judged;
    if (path_.empty()) return;
    std::ostringstream text;
    text.precision(9);
    text << '\n';  // after a line that was cut short
    for (const JudgedMoment& m : judged.moments) {
      text << "moment " << m.exact << ' ' << m.along << ' ' << m.alone << ' ' << m.premise_failed
           << '\n';
    }
    text << "end " << chunk.second << ' ' << judged.moments.size() << ' ' << judged.planted << ' '
         << judged.found << ' ' << chunk.first << '\n';
    std::ofstream file(path_, std::ios::app);
    file << text.str();
    if (!file.flush()) throw std::runtime_error("cannot write " + path_);
  }

 private:
  std::string path_;
  std::map<Chunk, JudgedPaths> chunks_;
};

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

// The moments of a family, whole scenes until there are enough.
JudgedPaths judge_family(const ClearanceFamily& family, std::size_t wanted,
                         const std::string& models, Journal& journal) {
  JudgedPaths all;
  for (std::uint64_t seed = 1; all.moments.size() < wanted; ++seed) {
    const Chunk chunk{family.name, seed};
    if (journal.find(chunk) == nullptr) {
      journal.keep(chunk, judge_paths(family.make(seed, models), seed, family.poses));
    }
    add(*journal.find(chunk), all);
  }
  return all;
}

int run(int argc, char** argv) {
  CLI::App app{"What voxcheck proves against the exact distance", "path_bench"};
  std::vector<std::string> only;
  std::string journal_path, json, models = test::source_path("../shared/models");
  std::size_t moments = 100000;
  app.add_option("--family", only, "\"generated\", \"pump on bay\", ... (default: all)");
  app.add_option("--moments", moments, "of all families together")->check(CLI::PositiveNumber);
  app.add_option("--journal", journal_path, "what was judged, to go on from");
  app.add_option("--models", models, "folder of the models");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  Journal journal(journal_path);
  std::map<std::string, JudgedPaths> by_group;
  const auto families = clearance_families();
  const double each = (1 - kGeneratedShare) / static_cast<double>(families.size() - 1);
  for (const ClearanceFamily& family : families) {
    const std::string name(family.name);
    if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end()) continue;
    if (!family.needs.empty() && !fs::exists(fs::path(models) / family.needs)) {
      std::printf("%s left out: no %s\n", name.c_str(), std::string(family.needs).c_str());
      continue;
    }
    const double share = family.group == "generated" ? kGeneratedShare : each;
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(moments));
    const JudgedPaths judged = judge_family(family, wanted, models, journal);
    add(judged, by_group[std::string(family.group)]);
    add(judged, by_group["all"]);
  }
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
