// What `voxelize --json` says.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "voxelize/bake.h"

namespace forcelayer {

struct RunFacts {
  double read_s = 0, write_s = 0, total_s = 0;
  std::uint64_t file_bytes = 0;
  int threads = 0;
};

nlohmann::ordered_json report_of(const Bake& bake, const RunFacts& run);

}  // namespace forcelayer
