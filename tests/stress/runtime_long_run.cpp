// Days of contact and thousands of openings: memory stays flat, the part comes home, and a second
// run gives the same bits. FORCELAYER_LONG_TESTS=1 runs 24 hours of simulated time, or as many as
// FORCELAYER_LONG_HOURS says.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <thread>

#include "forcelayer/forcelayer.h"
#include "runtime/model/outcome_hash.h"
#include "tests/support/motion_bench.h"
#include "tests/support/point_part.h"
#include "tests/support/sanitized.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kVoxelSizeM = 0.005;
constexpr std::uint64_t kHourFrames = 3600 * 1000;
constexpr std::uint64_t kShortFrames = 100'000;

// The model lets the part rest about 1e-9 from where the spring would have it; drift that matters
// is a thousandth of a voxel, and this far below it.
constexpr double kHomeM = 1e-8, kHomeRad = 1e-7;

// A page or two of the heap's own: a leak of 100 bytes shows. A sanitizer's memory grows by what it
// remembers of each allocation.
constexpr int kOpenings = kSanitized ? 300 : 3000;
constexpr double kFlatBytes = kSanitized ? 400e6 : 300e3;
constexpr std::ptrdiff_t kMoreMappings = kSanitized ? 20 : 2;  // the heap may take another piece

std::uint64_t frames_to_run() {
  if (std::getenv("FORCELAYER_LONG_TESTS") == nullptr) return kShortFrames;
  const char* const hours = std::getenv("FORCELAYER_LONG_HOURS");
  return kHourFrames * static_cast<std::uint64_t>(hours == nullptr ? 24 : std::atoi(hours));
}

double resident_bytes() {
  std::ifstream statm("/proc/self/statm");
  double all = 0, resident = 0;
  statm >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::ptrdiff_t mappings() {
  std::ifstream maps("/proc/self/maps");
  std::string line;
  std::ptrdiff_t count = 0;
  while (std::getline(maps, line)) ++count;
  return count;
}

VoxelScene floor_scene() {
  return offset_scene(kVoxelSizeM, {0, 0, -2}, {48, 40, 8}, 2, [](Voxel v) { return v[2] <= 0; });
}

// A hand that wanders over the floor, into it, along it and away, and never rests.
class WanderingHand {
 public:
  explicit WanderingHand(const Pose& start, std::uint64_t seed) : pose_(start), random_(seed) {
    choose();
  }

  const Pose& next() {
    constexpr double kNearer = 0.01;
    if (++frame_ % 250 == 0) choose();
    pose_.position_m += kNearer * (goal_.position_m - pose_.position_m);
    pose_.orientation = glm::normalize(glm::slerp(pose_.orientation, goal_.orientation, kNearer));
    return pose_;
  }

 private:
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  void choose() {
    goal_.position_m = {between(0.05, 0.18), between(0.05, 0.15), between(0.01, 0.05)};
    goal_.orientation =
        glm::normalize(glm::dquat(1, between(-0.5, 0.5), between(-0.5, 0.5), between(-0.5, 0.5)));
  }

  Pose pose_, goal_;
  std::mt19937_64 random_;
  std::uint64_t frame_ = 0;
};

struct LongRun {
  std::uint64_t hash = 0, touching = 0, interior = 0;
  double growth_bytes = 0;  // between a tenth of the run and its end
  double home_error_m = 0, home_error_rad = 0, norm_error = 0;
  double seconds = 0;
};

LongRun run(Model model, std::uint64_t frames) {
  const Pose home{{0.1, 0.1, 0.06}, {1, 0, 0, 0}};
  BenchOptions options;
  options.model = model;
  MotionBench bench(floor_scene(), sphere_part(0.02, 400, kVoxelSizeM), home, options);
  const State at_home = bench.state;
  WanderingHand hand(home, 1);
  LongRun result;
  double early_bytes = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (std::uint64_t i = 0; i < frames; ++i) {
    const StepResult step = bench.step_to(hand.next());
    result.hash = (result.hash ^ model::outcome_hash(step, bench.state)) * 0x100000001b3;
    result.touching += step.report.surface > 0 ? 1 : 0;
    result.interior += step.report.interior > 0 ? 1 : 0;
    if (i == frames / 10) early_bytes = resident_bytes();
  }
  result.growth_bytes = resident_bytes() - early_bytes;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  // Home again: the part stands where it began, to the last of what the spring can tell.
  Pose way = bench.input.world_from_handle;
  for (int i = 0; i < 4000; ++i) {
    way.position_m += 0.01 * (home.position_m - way.position_m);
    way.orientation = glm::normalize(glm::slerp(way.orientation, home.orientation, 0.01));
    bench.step_to(i < 3000 ? way : home);
  }
  const Pose part = bench.state.world_from_center, start = at_home.world_from_center;
  result.home_error_m = glm::length(part.position_m - start.position_m);
  result.home_error_rad =
      glm::length(coupling::rotation_vector(part.orientation * glm::conjugate(start.orientation)));
  result.norm_error = std::abs(glm::length(part.orientation) - 1);
  return result;
}

void expect_steady(Model model) {
  const std::uint64_t frames = frames_to_run();
  const LongRun first = run(model, frames);
  std::printf(
      "%.3g frames, %.1f h simulated, %.1f s, %.0f frames/s, %.0f%% touching, hash %016llx\n",
      static_cast<double>(frames), static_cast<double>(frames) / 3.6e6, first.seconds,
      static_cast<double>(frames) / first.seconds,
      100 * static_cast<double>(first.touching) / static_cast<double>(frames),
      static_cast<unsigned long long>(first.hash));
  EXPECT_GT(first.touching, frames / 5);
  EXPECT_LT(first.touching, frames - frames / 5);
  EXPECT_LT(first.growth_bytes, kFlatBytes);
  EXPECT_LT(first.home_error_m, kHomeM);
  EXPECT_LT(first.home_error_rad, kHomeRad);
  EXPECT_LT(first.norm_error, 1e-12);
  if (model == Model::kDefault) {
    EXPECT_EQ(first.interior, 0u);
  }
  const LongRun second = run(model, frames);
  EXPECT_EQ(first.hash, second.hash);
  // The error at home does not grow with the way there: the same bounds after shorter ones.
  for (const std::uint64_t fraction : {1000, 100, 10}) {
    const LongRun shorter = run(model, frames / fraction);
    std::printf("home after %.3g frames: %.2g m, %.2g rad\n",
                static_cast<double>(frames) / static_cast<double>(fraction), shorter.home_error_m,
                shorter.home_error_rad);
    EXPECT_LT(shorter.home_error_m, kHomeM);
    EXPECT_LT(shorter.home_error_rad, kHomeRad);
  }
  std::printf("home after %.3g frames: %.2g m, %.2g rad\n", static_cast<double>(frames),
              first.home_error_m, first.home_error_rad);
}

TEST(LongRun, RandomContactIsSteady) { expect_steady(Model::kDefault); }

TEST(LongRun, RandomContactOfThePaperIsSteady) { expect_steady(Model::kPaper); }

TEST(LongRun, OpeningAndClosingLeaksNothing) {
  const ScratchFolder folder;
  save_voxmap(folder / "floor.vox", closed(floor_scene()));
  save_pshell(folder / "ball.pshell", sphere_part(0.02, 100, kVoxelSizeM));
  const std::string scene = (folder / "floor.vox").string();
  const std::string part = (folder / "ball.pshell").string();
  forcelayer_options options;
  forcelayer_default_options(&options);
  forcelayer_reading reading{};
  reading.device_from_handle[3] = 1;
  reading.fresh = reading.present = reading.calibrated = 1;
  const double start[7] = {0.1, 0.1, 0.06, 1, 0, 0, 0};
  const auto open_and_close = [&] {
    char error[256] = "";
    forcelayer_runtime* const runtime =
        forcelayer_open(scene.c_str(), part.c_str(), &options, error, sizeof error);
    ASSERT_NE(runtime, nullptr) << error;
    forcelayer_result result;
    ASSERT_EQ(forcelayer_start(runtime, start, nullptr, &reading, error, sizeof error), 0) << error;
    ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
    forcelayer_close(runtime);
  };
  const auto threads = entries_of("/proc/self/task");
  for (int i = 0; i < kOpenings / 10; ++i) open_and_close();
  const double bytes = resident_bytes();
  const auto files = entries_of("/proc/self/fd");
  const auto maps = mappings();
  for (int i = kOpenings / 10; i < kOpenings; ++i) open_and_close();
  EXPECT_LT(resident_bytes() - bytes, kFlatBytes);
  EXPECT_EQ(entries_of("/proc/self/fd"), files);
  // A thread that was joined stands in the list until the kernel has buried it.
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (entries_of("/proc/self/task") > threads && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(entries_of("/proc/self/task"), threads);
  EXPECT_LE(mappings(), maps + kMoreMappings);
}

}  // namespace
}  // namespace forcelayer::test
