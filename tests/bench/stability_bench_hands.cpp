// Random hands in congested scenes, the default model, with a journal of the trials that are done.
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/bench/stability_bench.h"
#include "tests/stress/cases.h"

namespace forcelayer::stress {
namespace {

volatile std::sig_atomic_t interrupted = 0;

// One line per trial, seeds from 1 on; a last line that was cut short does not count.
class HandJournal {
 public:
  explicit HandJournal(std::string path) : path_(std::move(path)) {
    std::ifstream file(path_);
    for (std::string line; std::getline(file, line) && !file.eof();) add(line);
    if (!path_.empty()) rewrite();
  }

  const Metrics& sum() const { return sum_; }

  void keep(const Metrics& trial) {
    sum_.add(trial);
    if (path_.empty()) return;
    lines_ << line_of(trial) << '\n';
    std::ofstream file(path_, std::ios::app);
    file << line_of(trial) << '\n';
    if (!file.flush()) throw std::runtime_error("cannot write " + path_);
  }

 private:
  static double most(const std::vector<double>& sample) { return percentile(sample, 100); }

  std::string line_of(const Metrics& m) const {
    std::ostringstream text;
    text.precision(17);
    text << sum_.trials << ' ' << m.frames << ' ' << m.starts_inside << ' ' << m.force_layer_frames
         << ' ' << m.penetration_frames << ' ' << m.guard_cuts << ' ' << m.saturated_frames << ' '
         << m.non_finite << ' ' << m.overflows << ' ' << m.over_limit << ' ' << m.peak_force_n
         << ' ' << m.peak_torque_nm << ' ' << m.generated_j << ' ' << m.worst_generated_j << ' '
         << m.smallest_distance_m << ' ' << m.guaranteed_m << ' ' << m.distances_visited << ' '
         << m.distances_measured << ' ' << most(m.lag_m) << ' ' << most(m.approach_mps);
    return text.str();
  }

  void add(const std::string& line) {
    std::istringstream words(line);
    std::uint64_t seed = 0;
    double lag_m = 0, approach_mps = 0;
    Metrics m;
    m.trials = 1;
    words >> seed >> m.frames >> m.starts_inside >> m.force_layer_frames >> m.penetration_frames >>
        m.guard_cuts >> m.saturated_frames >> m.non_finite >> m.overflows >> m.over_limit >>
        m.peak_force_n >> m.peak_torque_nm >> m.generated_j >> m.worst_generated_j >>
        m.smallest_distance_m >> m.guaranteed_m >> m.distances_visited >> m.distances_measured >>
        lag_m >> approach_mps;
    if (!words || seed != sum_.trials + 1) {
      throw std::runtime_error(path_ + " is not a journal of seeds 1, 2, ...: trial " +
                               std::to_string(sum_.trials + 1) + " is not where it should be");
    }
    m.lag_m = {lag_m};
    m.approach_mps = {approach_mps};
    sum_.add(m);
    lines_ << line << '\n';
  }

  void rewrite() {
    std::ofstream file(path_, std::ios::trunc);
    file << lines_.str();
    if (!file.flush()) throw std::runtime_error("cannot write " + path_);
  }

  std::string path_;
  std::ostringstream lines_;
  Metrics sum_;
};

unsigned long long count(std::uint64_t n) { return n; }

void print(const Metrics& sum) {
  std::printf(
      "  seeds 1-%llu: %llu frames, %llu in the force layer, %llu penetrating, %llu not finite, "
      "%llu over the limits, %llu guard cuts; smallest distance %.3f mm, guaranteed %.3f mm\n",
      count(sum.trials), count(sum.frames), count(sum.force_layer_frames),
      count(sum.penetration_frames), count(sum.non_finite), count(sum.over_limit),
      count(sum.guard_cuts), sum.smallest_distance_m * 1e3, sum.guaranteed_m * 1e3);
  std::fflush(stdout);
}

}  // namespace

Json random_hands(std::uint64_t frames, const std::string& journal_path) {
  std::signal(SIGINT, [](int) { interrupted = 1; });
  std::printf("hands that wander through congested scenes, default model\n");
  const Case& hands = case_named("random-hand");
  HandJournal journal(journal_path);
  std::uint64_t shown = 0;
  while (journal.sum().frames < frames && interrupted == 0) {
    Trial trial = hands.make(journal.sum().trials + 1);
    trial.distance_below_m = journal.sum().smallest_distance_m;
    journal.keep(run(trial, Model::kDefault));
    if (journal.sum().frames < shown + 1'000'000) continue;
    shown = journal.sum().frames;
    print(journal.sum());
  }
  print(journal.sum());
  std::signal(SIGINT, SIG_DFL);
  Json report = to_json(journal.sum());
  // The journal has the fastest contact of each trial alone.
  report.erase("approach_mps_p50");
  report.erase("approach_mps_p95");
  return {{"default", report}};
}

}  // namespace forcelayer::stress
