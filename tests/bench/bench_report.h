// The output of every benchmark, as JSON: the machine, the command, and rows of figures.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace forcelayer::bench {

// Percentiles of a sample, in the sample's unit. Never a mean alone.
struct Percentiles {
  double p50, p99, p999, max;
};
Percentiles percentiles(std::vector<double> sample);
nlohmann::ordered_json to_json(const Percentiles& percentiles);

// CPU model, cores, memory, kernel, compiler and flags, date (UTC) of this run.
nlohmann::ordered_json machine();

// Seconds of a monotonic clock, and CPU seconds of this process (all threads).
double now_s();
double cpu_s();

// Writes {"benchmark", "command", "machine", "results"} to `path`, or, where it is empty, to
// build/bench/<benchmark>.json; prints where. Throws std::runtime_error.
void write_report(const std::string& benchmark, int argc, char** argv,
                  const nlohmann::ordered_json& results, const std::string& path = "");

// The whole of a benchmark's main(): its exit status, and one line on stderr where it throws.
int run_benchmark(const char* name, int (*run)(int argc, char** argv), int argc, char** argv);

}  // namespace forcelayer::bench
