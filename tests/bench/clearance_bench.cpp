// The clearance of a frame beside the exact distance of the meshes, at 100,000 random poses of
// generated scenes, the sample data and the shared models.
//
//   clearance_bench [--family NAME]... [--poses N] [--journal FILE] [--models FOLDER] [--json FILE]
//
// Seeds are fixed: the poses are the same on every machine. A journal keeps what was judged; a run
// that was ended goes on from it. Exit status 1 where a clearance is above the exact distance.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/bench/bench_report.h"
#include "tests/stress/clearance_campaign.h"
#include "tests/support/places.h"

namespace forcelayer::stress {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// Two fifths of the poses are of generated scenes; the other families share the rest.
constexpr double kGeneratedShare = 0.4;

using Chunk = std::pair<std::string, std::uint64_t>;  // family, seed
using Chunks = std::map<Chunk, std::vector<JudgedPose>>;

// A line a pose, and a line with their number after the last one of a chunk.
class Journal {
 public:
  explicit Journal(const std::string& path) : path_(path) {
    std::ifstream file(path);
    std::vector<JudgedPose> open;
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string kind, family;
      std::uint64_t seed = 0, count = 0;
      words >> kind;
      if (kind == "pose") {
        open.push_back(read(words));
      } else if (kind == "end" && words >> seed >> count &&
                 std::getline(words >> std::ws, family)) {
        if (count == open.size()) chunks_[{family, seed}] = open;
        open.clear();
      }
    }
  }

  const std::vector<JudgedPose>* find(const Chunk& chunk) const {
    const auto found = chunks_.find(chunk);
    return found == chunks_.end() ? nullptr : &found->second;
  }

  void keep(const Chunk& chunk, const std::vector<JudgedPose>& poses) {
    chunks_[chunk] = poses;
    if (path_.empty()) return;
    std::ostringstream text;
    text.precision(9);
    text << '\n';  // after a line that was cut short
    for (const JudgedPose& p : poses) {
      text << "pose " << p.exact << ' ' << p.claimed << ' ' << p.band_end << ' ' << p.provable
           << ' ' << p.by_points << ' ' << static_cast<int>(p.kind) << ' ' << p.premise_failed
           << ' ' << p.too_much << ' ' << static_cast<int>(p.object) << '\n';
    }
    text << "end " << chunk.second << ' ' << poses.size() << ' ' << chunk.first << '\n';
    std::ofstream file(path_, std::ios::app);
    file << text.str();
    if (!file.flush()) throw std::runtime_error("cannot write " + path_);
  }

 private:
  static JudgedPose read(std::istream& words) {
    JudgedPose p;
    int kind = 0, object = 0;
    words >> p.exact >> p.claimed >> p.band_end >> p.provable >> p.by_points >> kind >>
        p.premise_failed >> p.too_much >> object;
    p.kind = static_cast<ClearanceKind>(kind);
    p.object = static_cast<ObjectVerdict>(object);
    return p;
  }

  std::string path_;
  Chunks chunks_;
};

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

// The poses of a family, whole scenes until there are enough.
std::vector<JudgedPose> judge_family(const ClearanceFamily& family, std::size_t wanted,
                                     const std::string& models, Journal& journal) {
  std::vector<JudgedPose> all;
  for (std::uint64_t seed = 1; all.size() < wanted; ++seed) {
    const Chunk chunk{family.name, seed};
    if (journal.find(chunk) == nullptr) {
      journal.keep(chunk, judge_scene(family.make(seed, models), seed, family.poses));
    }
    const std::vector<JudgedPose>& poses = *journal.find(chunk);
    all.insert(all.end(), poses.begin(), poses.end());
  }
  return all;
}

int run(int argc, char** argv) {
  CLI::App app{"Proven clearance against the exact distance", "clearance_bench"};
  std::vector<std::string> only;
  std::string journal_path, json, models = test::source_path("../shared/models");
  std::size_t poses = 100000;
  app.add_option("--family", only, "\"generated\", \"pump on bay\", ... (default: all)");
  app.add_option("--poses", poses, "of all families together")->check(CLI::PositiveNumber);
  app.add_option("--journal", journal_path, "what was judged, to go on from");
  app.add_option("--models", models, "folder of the models");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  Journal journal(journal_path);
  std::map<std::string, std::vector<JudgedPose>> by_group;
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
    const auto judged = judge_family(
        family, static_cast<std::size_t>(share * static_cast<double>(poses)), models, journal);
    for (const std::string& group : {std::string(family.group), std::string("all")}) {
      by_group[group].insert(by_group[group].end(), judged.begin(), judged.end());
    }
  }
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
