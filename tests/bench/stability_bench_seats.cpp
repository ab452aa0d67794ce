// Parts that start installed: whether they rest, how deep hands at random push them into the metal
// about them, and whether they come out and go back.
#include <cmath>
#include <cstdio>

#include "tests/bench/stability_bench.h"
#include "tests/stress/seat_trial.h"

namespace forcelayer::stress {

Json seat_table(std::uint64_t pairs, std::uint64_t first, double covering_voxels) {
  constexpr double kPushSeconds = 10;
  Json rows = Json::array();
  std::printf("seats: lengths in voxels; depth is beyond that at the start\n");
  for (std::uint64_t seed = first; seed < first + pairs; ++seed) {
    const InstalledPair pair = installed_pair(seed);
    const SeatOutcome o = try_seat(pair, seed, kPushSeconds, covering_voxels);
    std::printf(
        "  %3llu %-20s %.2f mm, gap %.2f: drift %.3f, %.2g N still, start %.3f, depth %.3f, "
        "edges "
        "%.3f, touching %.2f%s%s%s %s\n",
        static_cast<unsigned long long>(seed), pair.kind, pair.voxel_size_m * 1e3, pair.gap_m * 1e3,
        o.drift, o.still_force_n, o.start_depth, o.depth, o.edge_depth, o.touching,
        o.came_out ? "" : ", STAYED", o.tried_back ? "" : ", not tried back",
        o.tried_back && !o.went_back ? ", NOT BACK" : "", o.refused.c_str());
    std::fflush(stdout);
    rows.push_back({{"seed", seed},
                    {"covering_voxels", covering_voxels > 0 ? covering_voxels : std::sqrt(0.75)},
                    {"pair", pair.kind},
                    {"voxel_m", pair.voxel_size_m},
                    {"gap_m", pair.gap_m},
                    {"refused", o.refused.empty() ? 0 : 1},
                    {"start_depth_voxels", o.start_depth},
                    {"drift_voxels", o.drift},
                    {"still_force_n", o.still_force_n},
                    {"depth_voxels", o.depth},
                    {"edge_depth_voxels", o.edge_depth},
                    {"touching", o.touching},
                    {"came_out", o.came_out ? 1 : 0},
                    {"tried_back", o.tried_back ? 1 : 0},
                    {"went_back", o.went_back ? 1 : 0}});
  }
  return rows;
}

}  // namespace forcelayer::stress
