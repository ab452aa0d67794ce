#include "tests/bench/bench_report.h"
#include "tests/support/places.h"

#include <sys/utsname.h>
#include <unistd.h>

#include <hwy/targets.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace forcelayer::bench {
namespace {

std::string cpu_model() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

// The widest vectors that it has.
const char* vectors() {
  const auto targets = hwy::SupportedTargets();
  return hwy::TargetName(targets & -targets);
}

std::string utc_date() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  return text;
}

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

Percentiles percentiles(std::vector<double> sample) {
  if (sample.empty()) return {NAN, NAN, NAN, NAN};
  std::sort(sample.begin(), sample.end());
  const auto at = [&](double fraction) {
    const auto rank = static_cast<std::size_t>(std::ceil(fraction * double(sample.size())));
    return sample[std::min(sample.size() - 1, rank == 0 ? 0 : rank - 1)];
  };
  return {at(0.5), at(0.99), at(0.999), sample.back()};
}

nlohmann::ordered_json to_json(const Percentiles& p) {
  return {{"p50", p.p50}, {"p99", p.p99}, {"p999", p.p999}, {"max", p.max}};
}

nlohmann::ordered_json machine() {
  utsname system{};
  uname(&system);
  const double memory_gib =
      double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE)) / (1 << 30);
  return {{"cpu", cpu_model()},
          {"vectors", vectors()},
          {"cores", std::thread::hardware_concurrency()},
          {"memory_gib", std::round(memory_gib)},
          {"system", std::string(system.sysname) + " " + system.machine},
          {"compiler", std::string("gcc-compatible ") + __VERSION__},
          {"version", FORCELAYER_VERSION},
          {"date", utc_date()}};
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_s() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

void write_report(const std::string& benchmark, int argc, char** argv,
                  const nlohmann::ordered_json& results, const std::string& path) {
  std::string command = file_name(argv[0]);
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--json") {
      ++i;  // where a figure was written says nothing of it
    } else {
      command += std::string(" ") + argv[i];
    }
  }
  const nlohmann::ordered_json report = {
      {"benchmark", benchmark}, {"command", command}, {"machine", machine()}, {"results", results}};
  std::filesystem::path target = path;
  if (target.empty()) {
    target = test::source_path("build/bench/" + benchmark + ".json");
  }
  if (target.has_parent_path()) std::filesystem::create_directories(target.parent_path());
  std::ofstream file(target);
  file << report.dump(2) << "\n";
  if (!file) throw std::runtime_error("cannot write " + target.string());
  std::printf("wrote %s\n", target.c_str());
}

int run_benchmark(const char* name, int (*run)(int argc, char** argv), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", name, error.what());
    return 1;
  }
}

}  // namespace forcelayer::bench
