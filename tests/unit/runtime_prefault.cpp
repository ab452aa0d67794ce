// The pages of a map that a part can reach are in memory before the loop, and the others are not.
#include "runtime/machine/prefault.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "tests/support/random_scenes.h"
#include "tests/support/sanitized.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

// Sanitizers keep a shadow of what is read, whose pages have faults of their own.
constexpr bool kFaultsAreOurs = !kSanitized;

constexpr double kS = 0.001;
constexpr std::int64_t kLong = 4096, kWide = 32;

// Throws a file out of the system's cache, from which whole folios would be mapped at the first
// touch.
void forget(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  ::fsync(file);
  ::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
  ::close(file);
}

// A long bar of noise, in which no two bricks are equal, on disk: 1 MiB of bricks.
struct NoisyBar {
  ScratchFolder folder;
  Voxmap voxmap;

  NoisyBar() : voxmap(written(folder)) {}

  static Voxmap written(const ScratchFolder& folder) {
    static const Voxmap made = [] {
      Random random(11);
      return make_voxmap(VoxelScene::filled(kS, {0, 0, 0}, {kLong, kWide, kWide}, [&](Voxel) {
        return static_cast<VoxelValue>(random() % 4);
      }));
    }();
    const auto path = folder.path() / "bar.vox";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(made.bytes().data()),
               static_cast<std::streamsize>(made.bytes().size()));
    forget(path);
    auto opened = Voxmap::open(path);
    if (!opened) throw std::runtime_error(opened.error().what);
    return std::move(*opened);
  }
};

std::uint64_t sum_of_values(const Voxmap& map, std::int64_t from, std::int64_t to) {
  std::uint64_t sum = 0;
  for (std::int64_t x = from; x < to; ++x)
    for (std::int64_t y = 0; y < kWide; ++y)
      for (std::int64_t z = 0; z < kWide; ++z) sum += static_cast<unsigned>(map.value(x, y, z));
  return sum;
}

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

TEST(Prefault, ReadsWhatThePartCanReachAndLittleElse) {
  const NoisyBar bar;
  const std::uint64_t file = bar.voxmap.bytes().size();
  ASSERT_GT(file, 1u << 20);
  const std::uint64_t before = machine::resident_bytes(bar.voxmap.bytes());
  if (before > file / 2) GTEST_SKIP() << "this file system maps small files whole";
  // A sixteenth of the bar, in its middle.
  const std::int64_t from = 15 * kLong / 32, to = 17 * kLong / 32;
  const machine::ReachBox reach{{kS * double(from), 0, 0},
                                {kS * double(to), kS * kWide, kS * kWide}};
  const std::uint64_t read = machine::prefault(bar.voxmap, reach);
  EXPECT_GE(read, file / 20);
  EXPECT_LE(read, file / 8);
  const std::uint64_t after = machine::resident_bytes(bar.voxmap.bytes());
  EXPECT_GE(after, read);
  // The system maps some of what an earlier read-ahead left in its cache about a fault.
  EXPECT_LE(after, before + read + (256u << 10));
  EXPECT_LT(after, file * 3 / 4);
  sum_of_values(bar.voxmap, from, from + 1);  // its code is there too
  const long faults = page_faults();
  EXPECT_GT(sum_of_values(bar.voxmap, from, to), 0u);
  if (kFaultsAreOurs) {
    EXPECT_EQ(page_faults(), faults) << "a page of the reach was not there";
  }
  sum_of_values(bar.voxmap, 0, kLong);
  EXPECT_GT(page_faults(), faults) << "the test has lost its teeth: everything was there";
  EXPECT_GE(machine::resident_bytes(bar.voxmap.bytes()), file * 7 / 8);
}

TEST(Prefault, AnEndlessReachIsTheWholeMapAndOneElsewhereNothing) {
  const NoisyBar bar;
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  EXPECT_EQ(machine::prefault(bar.voxmap, {{1, 1, 1}, {2, 2, 2}}), 0u);
  EXPECT_GE(machine::prefault(bar.voxmap, {glm::dvec3(-kEndless), glm::dvec3(kEndless)}),
            bar.voxmap.brick_count() * 128);
  sum_of_values(bar.voxmap, 0, 1);  // its code is there too
  const long faults = page_faults();
  sum_of_values(bar.voxmap, 0, kLong);
  if (kFaultsAreOurs) {
    EXPECT_EQ(page_faults(), faults);
  }
}

}  // namespace
}  // namespace forcelayer::test
