// Running another program and seeing what it took.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace forcelayer::bench {

struct ProcessRun {
  double wall_s = 0, cpu_s = 0;
  std::uint64_t peak_rss_bytes = 0;
  std::string output;  // stdout and stderr
};

// Runs `command` (program and arguments) to its end. Throws std::runtime_error where it cannot be
// started or fails.
ProcessRun run_process(const std::vector<std::string>& command);

}  // namespace forcelayer::bench
