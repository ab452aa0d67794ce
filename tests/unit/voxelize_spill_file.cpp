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

#include "tests/support/mesh_files.h"
#include "voxelize/cache/mesh_source.h"

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

// Each place that is read may lie on a page of its own: the bytes that are told say little.
TEST(SpillFile, LetsPagesGoOfWhichLittleWasRead) {
  constexpr std::size_t kPage = 4096, kMost = std::size_t{450} << 20;
  scan::SpillFile file;
  const auto array = file.array<std::uint8_t>(std::size_t{800} << 20);
  ASSERT_GT(file.bytes_on_disk(), 0u);
  const std::size_t before = resident_file_bytes();
  std::size_t most = 0;
  for (std::size_t i = 0; i < array.size(); i += kPage) {
    ASSERT_EQ(array[i], 0);
    file.touched(128);
    if (i % (1024 * kPage) == 0) most = std::max(most, resident_file_bytes());
  }
  EXPECT_GT(most, before + (std::size_t{200} << 20));
  EXPECT_LT(most, before + kMost);
}

TEST(SpillFile, KeepsArraysInMemoryWhereNoFileCanBeMade) {
  const Folder nowhere("/nonexistent");
  scan::SpillFile file;
  expect_kept(file);
  EXPECT_EQ(file.bytes_on_disk(), 0u);
}

// Meshes of three files, of which the last two wait on disk.
TEST(MeshSource, GivesWhatItReadFromDiskToo) {
  std::mt19937_64 random(5);
  std::vector<mesh::Assembly> files(3);
  std::size_t first_bytes = 0;
  for (mesh::Assembly& file : files) {
    for (std::uint32_t m = 0; m < 3; ++m) {
      file.meshes.push_back(test::random_soup(random));
      file.meshes.back().single_precision = m % 2 == 0;
      file.instances.push_back({m, "object", {}, {}});
    }
  }
  for (const mesh::Mesh& mesh : files[0].meshes) {
    first_bytes += 24 * mesh.vertices.size() + 12 * mesh.triangles.size();
  }
  cache::MeshSource source(
      nullptr,
      [&](const std::string& path, const mesh::ReadOptions&) -> Result<mesh::Assembly> {
        return files[static_cast<std::size_t>(path[0] - '0')];
      },
      first_bytes);
  for (const char* path : {"0", "1", "2"}) {
    const auto assembly = source.read(path, {});
    ASSERT_TRUE(assembly);
    EXPECT_EQ(assembly->meshes.size(), 3u);
    EXPECT_TRUE(assembly->meshes[0].triangles.empty());
  }
  for (std::uint32_t file = 0; file < 3; ++file) {
    for (std::uint32_t m = 0; m < 3; ++m) {
      mesh::MeshObject part;
      part.assembly = file;
      part.mesh = m;
      const auto mesh = source.mesh(part);
      ASSERT_TRUE(mesh);
      EXPECT_EQ((*mesh)->vertices, files[file].meshes[m].vertices);
      EXPECT_EQ((*mesh)->triangles, files[file].meshes[m].triangles);
      EXPECT_EQ((*mesh)->single_precision, files[file].meshes[m].single_precision);
      EXPECT_EQ(mesh->use_count() == 0, file == 0) << "copies end with their last pointer";
    }
  }
}

}  // namespace
}  // namespace forcelayer
