// Arrays that wait on disk keep their content, in the file and where there is none.
#include "voxelize/scan/spill_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace forcelayer {
namespace {

// $TMPDIR for one test.
class Folder {
 public:
  explicit Folder(const char* path) {
    if (const char* const old = std::getenv("TMPDIR")) old_ = old;
    setenv("TMPDIR", path, 1);
  }
  ~Folder() { old_ ? setenv("TMPDIR", old_->c_str(), 1) : unsetenv("TMPDIR"); }

 private:
  std::optional<std::string> old_;
};

// Writes arrays of many sizes, lets them go in between, and reads all back.
void expect_kept(scan::SpillFile& file) {
  constexpr std::size_t kSizes[] = {0, 1, 1000, 7, 20'000'000, 3, 5'000'000, 1};
  std::vector<std::span<std::uint32_t>> arrays;
  for (const std::size_t size : kSizes) {
    const auto array = arrays.emplace_back(file.array<std::uint32_t>(size));
    ASSERT_EQ(array.size(), size);
    for (const std::size_t i : {std::size_t{0}, size / 2}) {
      if (i < size) {
        EXPECT_EQ(array[i], 0u);
      }
    }
    for (std::size_t i = 0; i < size; ++i) {
      array[i] = static_cast<std::uint32_t>(i * 2654435761u + size);
    }
    file.touched(array.size_bytes());
    if (size % 2 == 1) file.let_go();
  }
  for (const auto& array : arrays) {
    for (std::size_t i = 0; i < array.size(); ++i) {
      ASSERT_EQ(array[i], static_cast<std::uint32_t>(i * 2654435761u + array.size()));
    }
  }
}

TEST(SpillFile, KeepsArraysOnDisk) {
  scan::SpillFile file;
  expect_kept(file);
  EXPECT_GE(file.bytes_on_disk(), 100'000'000u) << "of 25 million numbers";
}

std::size_t resident_file_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word == "RssFile:" && status >> word) return 1024 * std::stoul(word);
  }
  return 0;
}

// Each place that is read may lie on a page of its own: the bytes that are known say little.
TEST(SpillFile, LetsPagesGoOfWhichLittleWasRead) {
  constexpr std::size_t kPage = 4096, kMax = std::size_t{450} << 20;
  scan::SpillFile file;
  const auto array = file.array<std::uint8_t>(std::size_t{800} << 20);
  ASSERT_GT(file.bytes_on_disk(), 0u);
  const std::size_t before = resident_file_bytes();
  std::size_t largest = 0;
  for (std::size_t i = 0; i < array.size(); i += kPage) {
    ASSERT_EQ(array[i], 0);
    file.touched(128);
    if (i % (1024 * kPage) == 0) largest = std::max(largest, resident_file_bytes());
  }
  EXPECT_GT(largest, before + (std::size_t{200} << 20));
  EXPECT_LT(largest, before + kMax);
}

TEST(SpillFile, KeepsArraysInMemoryWhereNoFileCanBeMade) {
  const Folder nowhere("/nonexistent");
  scan::SpillFile file;
  expect_kept(file);
  EXPECT_EQ(file.bytes_on_disk(), 0u);
}

}  // namespace
}  // namespace forcelayer
