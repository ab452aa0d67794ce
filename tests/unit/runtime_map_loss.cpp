// Files that vanish or are cut short while they are mapped.
#include "runtime/map_loss.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <filesystem>
#include <functional>

#include "runtime/derive_parameters.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop.h"
#include "tests/support/point_part.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;

// A run of 600 frames that presses on the slab; after 300 the files are changed. Returns how often
// the output was not zero after that, or -1 where the loss was not noticed.
struct MappedRun {
  ScratchFolder folder;
  std::unique_ptr<Simulation> sim;
  std::uint64_t frames = 0;
  OutputState output = OutputState::kWaiting;
  TripCause trip = TripCause::kNone;
  Wrench last_wrench;

  MappedRun() {
    const auto slab = [](Voxel v) { return v[2] <= 0; };
    save_voxmap(folder / "scene.vox", offset_scene(kS, {0, 0, -2}, {256, 256, 8}, 2, slab));
    save_pshell(folder / "part.pshell", sphere_part(0.02, 2000, kS));
    auto voxmap = Voxmap::open(folder / "scene.vox");
    auto shell = Pshell::open(folder / "part.pshell");
    const auto derived = derive_parameters({}, *voxmap, *shell, sim_capabilities());
    auto created = Simulation::create(std::move(*voxmap), std::move(*shell), derived->values);
    sim = std::move(*created);
  }

  void go(const std::function<void(const std::filesystem::path&)>& change) {
    const Pose high{{0.1, 0.1, 0.06}, {1, 0, 0, 0}}, low{{0.1, 0.1, 0.03}, {1, 0, 0, 0}};
    SimDevice device(MotionScript({{0, high}, {0.1, low}, {0.6, {{0.9, 0.9, 0.03}, {1, 0, 0, 0}}}}),
                     {});
    DeviceInput input(device, {});
    OutputLimits limits;
    limits.max_force_n = 10;
    limits.max_torque_nm = 1;
    limits.rearm_alone = true;
    Servo servo(*sim, input, sim->registered(high, high), limits);
    LoopStatistics* const statistics = new LoopStatistics;
    LoopOptions options;
    options.as_fast_as_possible = true;
    options.frames = 300;
    run_loop(servo, options, nullptr, *statistics);
    EXPECT_GT(statistics->max_device_force_n, 1);
    change(folder.path());
    run_loop(servo, options, nullptr, *statistics);
    frames = statistics->frames;
    output = servo.output().state();
    trip = servo.output().last_trip();
    last_wrench = device.last_wrench();
    delete statistics;
  }
};

TEST(MapLoss, FilesThatVanishDoNoHarm) {
  MappedRun run;
  run.go([](const auto& folder) {
    std::filesystem::remove(folder / "scene.vox");
    std::filesystem::remove(folder / "part.pshell");
  });
  EXPECT_EQ(run.frames, 600u);
  EXPECT_EQ(run.trip, TripCause::kNone);
}

// Each in a process of its own, since a loss is remembered for good.
void cut(const char* file, std::uintmax_t bytes) {
  contain_map_loss();
  MappedRun run;
  run.go([&](const auto& folder) { std::filesystem::resize_file(folder / file, bytes); });
  const bool stopped = run.frames < 600 && run.output == OutputState::kTripped &&
                       run.trip == TripCause::kMapLost &&
                       run.last_wrench.force_n == glm::dvec3(0) && map_lost();
  std::_Exit(stopped ? 0 : 1);
}

TEST(MapLossDeathTest, FilesThatAreCutShortStopTheRunAtZero) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const char* file : {"scene.vox", "part.pshell"}) {
    for (const std::uintmax_t bytes : {0, 4096, 8192}) {
      EXPECT_EXIT(cut(file, bytes), testing::ExitedWithCode(0), "") << file << " " << bytes;
    }
  }
}

// What is not ours dies as ever.
TEST(MapLossDeathTest, OtherBusErrorsAreNotHidden) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto fault = [] {
    contain_map_loss();
    contain_map_loss();
    const ScratchFolder folder;
    const auto path = folder / "file";
    std::FILE* const file = std::fopen(path.c_str(), "w+");
    std::filesystem::resize_file(path, 4096);
    volatile char* const bytes =
        static_cast<char*>(mmap(nullptr, 4096, PROT_READ, MAP_SHARED, fileno(file), 0));
    std::filesystem::resize_file(path, 0);
    static_cast<void>(bytes[0]);
    std::_Exit(0);
  };
  EXPECT_DEATH(fault(), "");  // by SIGBUS, or by a sanitizer's report of it
}

}  // namespace
}  // namespace forcelayer::test
