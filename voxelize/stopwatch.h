// Wall time of a bake and of its stages.
#pragma once

#include <chrono>

namespace forcelayer::voxelize {

class Stopwatch {
 public:
  double total_s() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  // Since the last call, or since the start.
  double lap_s() {
    const double now_s = total_s(), lap_s = now_s - lap_start_s_;
    lap_start_s_ = now_s;
    return lap_s;
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double lap_start_s_ = 0;
};

// Wall time by stage. Objects are baked side by side; their stages add up.
struct StageSeconds {
  double snap = 0, scan = 0, flood = 0, near = 0, cavities = 0, cache = 0, unite = 0, tree = 0;
};

}  // namespace forcelayer::voxelize
