// The meshes of a scene: where they wait, and files that are read side by side.
#include "voxelize/cache/mesh_source.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <random>
#include <thread>

#include "tests/support/mesh_files.h"
#include "voxelize/cache/reading_slots.h"

namespace forcelayer {
namespace {

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

// Files called "0", "1", ... with one mesh each, of which some cannot be read.
struct Files {
  explicit Files(std::mt19937_64& random) : meshes(1 + random() % 30), bad(meshes.size()) {
    for (mesh::Mesh& mesh : meshes) mesh = test::random_soup(random);
    if (random() % 2 == 0) bad[random() % bad.size()] = bad[random() % bad.size()] = true;
  }

  Result<mesh::Assembly> read(const std::string& path) {
    ++reads;
    const auto i = static_cast<std::size_t>(std::stoi(path));
    if (bad[i]) return Error{ErrorCode::kMeshUnreadable, path, "", "is bad", ""};
    mesh::Assembly assembly;
    assembly.meshes.push_back(meshes[i]);
    assembly.instances.push_back({0, "of " + path, {}, {}});
    return assembly;
  }

  std::vector<mesh::Mesh> meshes;
  std::vector<char> bad;
  std::atomic<std::size_t> reads = 0;
};

TEST(MeshSource, GivesWhatItReadAheadInAnyOrder) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 8);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    Files files(random);
    cache::MeshSource source(
        nullptr,
        [&](const std::string& path, const mesh::ReadOptions&) { return files.read(path); },
        random() % 2 == 0 ? 0 : std::size_t{1} << 30);
    std::vector<mesh::FileToRead> listed;
    for (std::size_t i = 0; i < files.meshes.size(); ++i) listed.push_back({std::to_string(i), {}});
    source.read_ahead(listed, 1e9);
    for (std::uint32_t i = 0; i < files.meshes.size(); ++i) {
      const auto assembly = source.read(listed[i].path, {});
      ASSERT_EQ(bool(assembly), !files.bad[i]);
      if (!assembly) break;
      EXPECT_EQ(assembly->instances[0].name, "of " + listed[i].path);
      mesh::MeshObject part;
      part.assembly = i;
      const auto mesh = source.mesh(part);
      ASSERT_TRUE(mesh);
      EXPECT_EQ((*mesh)->vertices, files.meshes[i].vertices);
      EXPECT_EQ((*mesh)->triangles, files.meshes[i].triangles);
    }
    EXPECT_LE(files.reads, files.meshes.size()) << "each file is read at most once";
  }
}

TEST(MeshSource, BeginsNoFileAfterOneThatFailed) {
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  std::mt19937_64 random(1);
  Files files(random);
  files.bad.assign(files.bad.size(), true);
  cache::MeshSource source(
      nullptr, [&](const std::string& path, const mesh::ReadOptions&) { return files.read(path); });
  std::vector<mesh::FileToRead> listed;
  for (std::size_t i = 0; i < files.meshes.size(); ++i) listed.push_back({std::to_string(i), {}});
  source.read_ahead(listed, 1e9);
  EXPECT_EQ(files.reads, 1u);
}

TEST(ReadingSlots, HoldNoMoreThanFits) {
  constexpr double kMax = 100;
  cache::ReadingSlots slots(kMax);
  std::atomic<int> sum = 0, count = 0, side_by_side = 0, too_many = 0;
  std::vector<std::thread> threads;
  for (unsigned n = 0; n < 8; ++n) {
    threads.emplace_back([&, n] {
      std::mt19937_64 random(n);
      for (int i = 0; i < 200; ++i) {
        const int bytes = static_cast<int>(random() % 150);
        const cache::ReadingSlots::Slot slot(slots, bytes);
        const int others = count++, held = sum += bytes;
        if (others > 0) ++(held > kMax ? too_many : side_by_side);
        std::this_thread::yield();
        sum -= bytes;
        --count;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(too_many, 0);
  EXPECT_GT(side_by_side, 0);
}

}  // namespace
}  // namespace forcelayer
