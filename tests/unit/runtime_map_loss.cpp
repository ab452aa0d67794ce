// Files that vanish, are cut short or are written to while they are mapped.
#include "runtime/machine/map_loss.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <thread>

#include "forcelayer/run.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop/loop.h"
#include "runtime/query/query_workers.h"
#include "tests/support/both_models.h"
#include "tests/support/point_part.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;

// A run of 600 frames that presses on the slab. After 300 the files are changed. Then
// check_mappings() looks at them, as a thread beside every loop does, unless `looks` is false and
// the SIGBUS alone must tell.
struct MappedRun {
  ScratchFolder folder;
  std::unique_ptr<model::Simulation> sim;
  std::uint64_t frames = 0;
  OutputState output = OutputState::kWaiting;
  TripCause trip = TripCause::kNone;
  Wrench last_wrench;
  bool looks = true;
  int changed_files = 0;

  explicit MappedRun(Model model) {
    static const auto slab =
        voxmap_bytes(SceneFile(closed(offset_scene(kS, {0, 0, -2}, {256, 256, 8}, 2, [](Voxel v) {
                       return v[2] <= 0;
                     }))).content());
    save_bytes(folder / "scene.vox", slab);
    save_pshell(folder / "part.pshell", sphere_part(0.02, 2000, kS));
    RunRequest request = default_run_request(folder / "scene.vox", folder / "part.pshell");
    request.model = model;
    auto run = open_run(request);
    if (!run) throw std::runtime_error(to_line(run.error()));
    sim = run->release_simulation();
  }

  void go(const std::function<void(const std::filesystem::path&)>& change) {
    const Pose high{{0.1, 0.1, 0.06}, {1, 0, 0, 0}}, low{{0.1, 0.1, 0.03}, {1, 0, 0, 0}};
    devices::SimDevice device(
        devices::MotionScript({{0, high}, {0.1, low}, {0.6, {{0.9, 0.9, 0.03}, {1, 0, 0, 0}}}}),
        {});
    loop::DeviceInput input(device, {});
    loop::OutputLimits limits;
    limits.max_force_n = 10;
    limits.max_torque_nm = 1;
    limits.rearm_alone = true;
    loop::Servo servo(*sim, input, sim->registered(high, high), limits);
    loop::LoopStatistics* const statistics = new loop::LoopStatistics;
    loop::LoopOptions options;
    options.as_fast_as_possible = true;
    options.frames = 300;
    loop::run_loop(servo, options, nullptr, *statistics);
    EXPECT_GT(statistics->max_device_force_n, 1);
    // The time of a file's last writing has the grain of the system's ticks: up to 10 ms.
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    change(folder.path());
    if (looks) changed_files = machine::check_mappings();
    loop::run_loop(servo, options, nullptr, *statistics);
    frames = statistics->frames;
    output = servo.output().state();
    trip = servo.output().last_trip();
    last_wrench = device.last_wrench();
    delete statistics;
  }

  bool stopped_at_zero() const {
    return frames < (looks ? 302 : 600) && output == OutputState::kTripped &&
           trip == TripCause::kMapLost && last_wrench.force_n == glm::dvec3(0) &&
           last_wrench.torque_nm == glm::dvec3(0);
  }
};

class MapLoss : public BothModels {};
using MapLossDeathTest = MapLoss;
INSTANTIATE_TEST_SUITE_P(Models, MapLoss, kBothModels, name_of_model);
INSTANTIATE_TEST_SUITE_P(Models, MapLossDeathTest, kBothModels, name_of_model);

// A bake replaces files and never writes to them: no loss to a run that has them mapped.
TEST_P(MapLoss, FilesThatVanishOrAreReplacedDoNoHarm) {
  using std::filesystem::path;
  const std::function<void(const path&)> changes[] = {
      [](const path& folder) {
        std::filesystem::remove(folder / "scene.vox");
        std::filesystem::remove(folder / "part.pshell");
      },
      [](const path& folder) {
        save_voxmap(folder / "new.vox",
                    closed(offset_scene(kS, {0, 0, -2}, {8, 8, 8}, 2, [](Voxel) { return true; })));
        std::filesystem::rename(folder / "new.vox", folder / "scene.vox");
        std::filesystem::rename(folder / "part.pshell", folder / "elsewhere.pshell");
      },
      [](const path& folder) {
        std::filesystem::permissions(folder / "scene.vox", std::filesystem::perms::none);
        std::filesystem::create_hard_link(folder / "part.pshell", folder / "second.pshell");
      }};
  for (const auto& change : changes) {
    MappedRun run(GetParam());
    run.go(change);
    EXPECT_EQ(run.changed_files, 0);
    EXPECT_EQ(run.frames, 600u);
    EXPECT_EQ(run.trip, TripCause::kNone);
  }
}

// A file whose bytes change in place: no page is missing, no signal comes.
TEST_P(MapLoss, FilesThatAreWrittenToStopTheRunAtZero) {
  using std::filesystem::last_write_time;
  for (const auto& [file, sets_back] :
       {std::pair{"scene.vox", false}, {"part.pshell", false}, {"scene.vox", true}}) {
    MappedRun run(GetParam());
    run.go([file = file, sets_back = sets_back](const auto& folder) {
      const auto before = last_write_time(folder / file);
      std::fstream written(folder / file, std::ios::in | std::ios::out | std::ios::binary);
      written.seekp(-64, std::ios::end);
      written.put('x');
      written.close();
      if (sets_back) last_write_time(folder / file, before);  // as a copy that keeps times does
    });
    EXPECT_EQ(run.changed_files, 1) << file;
    EXPECT_TRUE(run.stopped_at_zero()) << file << " after " << run.frames;
    // And stays there, while other files are none the worse for it.
    EXPECT_EQ(machine::check_mappings(), 1);
    MappedRun other(GetParam());
    other.go([](const auto&) {});
    EXPECT_EQ(other.frames, 600u);
    EXPECT_EQ(other.trip, TripCause::kNone);
  }
  EXPECT_EQ(machine::check_mappings(), 0);  // nothing is in use any more
}

// Threads that read the same lost page at once: each reads the words that stand for "nothing",
// never the zeros of a page that another thread is about to fill.
TEST(BusErrorDeathTest, NoThreadReadsAPageThatIsHalfMade) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto race = [] {
    machine::contain_map_loss();
    constexpr std::size_t kPages = 500, kPageWords = 4096 / sizeof(std::uint32_t);
    constexpr int kThreads = 2;
    const ScratchFolder folder;
    const auto path = folder / "file";
    std::ofstream(path, std::ios::binary) << std::string(kPages * 4096, '\xff');
    const auto file = MappedFile::open_for_long(path);
    const machine::WatchedMapping watch(file->bytes(), file->stamp());
    std::filesystem::resize_file(path, 0);
    const auto* const words = reinterpret_cast<const volatile std::uint32_t*>(file->bytes().data());
    std::atomic<std::size_t> arrived{0}, wrong{0};
    std::vector<std::thread> threads;
    for (int n = 0; n < kThreads; ++n) {
      threads.emplace_back([&] {
        for (std::size_t page = 0; page < kPages; ++page) {
          ++arrived;
          while (arrived < (page + 1) * kThreads) std::this_thread::yield();
          for (const std::size_t word : {kPageWords - 1, std::size_t{0}, kPageWords / 2}) {
            wrong += words[page * kPageWords + word] != kUniformBit;
          }
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    std::fprintf(stderr, "%zu wrong words\n", wrong.load());
    std::filesystem::remove_all(folder.path());
    std::_Exit(wrong == 0 && watch.lost() ? 0 : 1);
  };
  EXPECT_EXIT(race(), testing::ExitedWithCode(0), "^0 wrong words");
}

// Each in a process of its own: SIGBUS is the whole process's.
void cut(Model model, const char* file, std::uintmax_t bytes, bool looks) {
  machine::contain_map_loss();
  MappedRun run(model);
  run.looks = looks;
  run.go([&](const auto& folder) { std::filesystem::resize_file(folder / file, bytes); });
  std::filesystem::remove_all(run.folder.path());
  std::_Exit(run.stopped_at_zero() && machine::check_mappings() == 1 ? 0 : 1);
}

TEST_P(MapLossDeathTest, FilesThatAreCutShortStopTheRunAtZero) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const char* file : {"scene.vox", "part.pshell"}) {
    for (const std::uintmax_t bytes : {0, 4096, 8192}) {
      EXPECT_EXIT(cut(GetParam(), file, bytes, false), testing::ExitedWithCode(0), "")
          << file << " " << bytes;
    }
  }
  EXPECT_EXIT(cut(GetParam(), "scene.vox", 4096, true), testing::ExitedWithCode(0), "")
      << "looked at";
}

// A file that is written over with indices that lead out of it, before anyone looks: what the step
// then reads is not there.
void write_over(Model model, const char* file) {
  machine::contain_map_loss();
  MappedRun run(model);
  run.looks = false;
  run.go([&](const auto& folder) {
    const std::string noise(std::filesystem::file_size(folder / file), '\x7f');
    std::fstream(folder / file, std::ios::in | std::ios::out | std::ios::binary) << noise;
  });
  std::filesystem::remove_all(run.folder.path());
  std::_Exit(run.stopped_at_zero() && machine::check_mappings() == 1 ? 0 : 1);
}

TEST_P(MapLossDeathTest, IndicesThatLeadAstrayStopTheRunAtZero) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(write_over(GetParam(), "scene.vox"), testing::ExitedWithCode(0), "");
}

// The same in a helper thread of the query, at an address of no kind that a processor knows.
TEST(BadReadDeathTest, HelpersThatAreLedAstrayGoOn) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto astray = [] {
    machine::contain_map_loss();
    const ScratchFolder folder;
    const auto path = folder / "file";
    std::ofstream(path, std::ios::binary) << std::string(4096, 'x');
    const auto file = MappedFile::open_for_long(path);
    const machine::WatchedMapping watch(file->bytes(), file->stamp());
    std::filesystem::resize_file(path, 8192);
    query::QueryWorkers workers(2);
    std::atomic<std::uint32_t> begun{0};
    workers.wake();
    workers.run(
        [](void* context, std::uint32_t chunk) noexcept {
          ++*static_cast<std::atomic<std::uint32_t>*>(context);
          const std::uintptr_t nowhere = chunk % 2 ? 0x7f7f'7f7f'7f7f'7f7f : 16;
          static_cast<void>(*reinterpret_cast<const volatile char*>(nowhere));
        },
        &begun, 1000);
    workers.rest();
    std::filesystem::remove_all(folder.path());
    std::_Exit(begun == 1000 && watch.lost() ? 0 : 1);
  };
  EXPECT_EXIT(astray(), testing::ExitedWithCode(0), "");
}

// While no file has changed, a bad read ends the process as before.
TEST(BadReadDeathTest, OtherBadReadsAreNotHidden) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto fault = [] {
    machine::contain_map_loss();
    machine::Landing landing;
    if (sigsetjmp(landing.here, 0) != 0) std::_Exit(0);
    const ScratchFolder folder;
    std::ofstream(folder / "file", std::ios::binary) << std::string(4096, 'x');
    const auto file = MappedFile::open_for_long(folder / "file");
    const machine::WatchedMapping watch(file->bytes(), file->stamp());
    const volatile char* volatile nothing = nullptr;
    static_cast<void>(nothing[16]);
  };
  EXPECT_DEATH(fault(), "");
}

// A bus error outside the watched files ends the process as before.
TEST(BusErrorDeathTest, OtherBusErrorsAreNotHidden) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto fault = [] {
    machine::contain_map_loss();
    machine::contain_map_loss();
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
