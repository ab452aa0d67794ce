#include "tests/bench/process_run.h"
#include "tests/support/places.h"

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace forcelayer::bench {
namespace {

std::string quoted(const std::string& argument) {
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

ProcessRun run_process(const std::vector<std::string>& command) {
  const auto report = std::filesystem::temp_directory_path() /
                      ("measured_run_" + std::to_string(::getpid()) + ".json");
  std::string line = "python3 " + quoted(test::source_path("tests/bench/measured_run.py")) + " " +
                     quoted(report.string());
  for (const std::string& argument : command) line += " " + quoted(argument);
  line += " 2>&1";

  ProcessRun run;
  FILE* output = ::popen(line.c_str(), "r");
  if (output == nullptr) throw std::runtime_error("cannot start " + command[0]);
  char buffer[4096];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, output)) > 0;) {
    run.output.append(buffer, n);
  }
  const int status = ::pclose(output);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error(command[0] + " failed: " + run.output);
  }
  const auto json = nlohmann::json::parse(std::ifstream(report));
  std::filesystem::remove(report);
  run.wall_s = json.at("wall_s");
  run.cpu_s = json.at("cpu_s");
  run.peak_rss_bytes = json.at("peak_rss_bytes");
  return run;
}

}  // namespace forcelayer::bench
