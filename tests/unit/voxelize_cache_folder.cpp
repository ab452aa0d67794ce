// The cache folder: what was kept is found, and nothing else ever is.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <utime.h>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "tests/support/scratch_folder.h"
#include "voxelize/cache/cache_folder.h"

namespace forcelayer {
namespace {

namespace fs = std::filesystem;

constexpr cache::Digest kKey{0x0123456789abcdef, 0xfedcba9876543210};

std::vector<std::byte> content(std::size_t bytes, unsigned first = 7) {
  std::vector<std::byte> result(bytes);
  for (std::size_t i = 0; i < bytes; ++i) result[i] = static_cast<std::byte>(first + 31 * i);
  return result;
}

class CacheFolderTest : public ::testing::Test {
 protected:
  cache::CacheFolder open() {
    auto cache = cache::CacheFolder::open((scratch_ / "cache").string());
    if (!cache) throw std::runtime_error(to_line(cache.error()));
    return std::move(*cache);
  }
  bool finds(const cache::CacheFolder& cache, const std::vector<std::byte>& expected) {
    const auto entry = cache.find("part", kKey);
    return entry && std::equal(expected.begin(), expected.end(), entry->bytes().begin(),
                               entry->bytes().end());
  }
  fs::path entry_path() const { return scratch_ / "cache" / "fe" / (kKey.hex() + ".part"); }
  std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  void write(const fs::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
  }

  test::ScratchFolder scratch_;
};

TEST_F(CacheFolderTest, FindsWhatWasKept) {
  const cache::CacheFolder cache = open();
  EXPECT_FALSE(cache.find("part", kKey));
  for (const std::size_t bytes : {0u, 1u, 8u, 100000u}) {
    cache.keep("part", kKey, content(bytes));
    EXPECT_TRUE(finds(cache, content(bytes)));
    EXPECT_TRUE(finds(open(), content(bytes)));
  }
  EXPECT_TRUE(fs::exists(entry_path()));
  EXPECT_TRUE(fs::is_empty(scratch_ / "cache" / "tmp"));
  EXPECT_FALSE(cache.find("facts", kKey));
  EXPECT_FALSE(cache.find("part", cache::Digest{kKey.low + 1, kKey.high}));
  EXPECT_FALSE(cache.trouble());
}

TEST_F(CacheFolderTest, DamageInAnyByteIsFound) {
  const cache::CacheFolder cache = open();
  cache.keep("part", kKey, content(64));
  const std::string good = read(entry_path());
  ASSERT_EQ(good.size(), 128u);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    write(entry_path(), bad);
    EXPECT_FALSE(cache.find("part", kKey)) << "byte " << i;
    write(entry_path(), good.substr(0, i));
    EXPECT_FALSE(cache.find("part", kKey)) << "cut after " << i;
  }
  write(entry_path(), good + "x");
  EXPECT_FALSE(cache.find("part", kKey)) << "trailing byte";
  cache.keep("part", kKey, content(64));
  EXPECT_TRUE(finds(cache, content(64))) << "a damaged entry is replaced";
}

TEST_F(CacheFolderTest, AnEntryUnderAnotherNameIsForeign) {
  const cache::CacheFolder cache = open();
  const cache::Digest other{kKey.low + 1, kKey.high};
  cache.keep("part", other, content(64));
  fs::copy_file(scratch_ / "cache" / "fe" / (other.hex() + ".part"), entry_path());
  EXPECT_FALSE(cache.find("part", kKey));
}

TEST_F(CacheFolderTest, LinksInsideAreNotFollowed) {
  const cache::CacheFolder cache = open();
  cache.keep("part", kKey, content(64));
  fs::rename(entry_path(), scratch_ / "elsewhere");
  fs::create_symlink(scratch_ / "elsewhere", entry_path());
  EXPECT_FALSE(cache.find("part", kKey)) << "an entry that is a link";
  const std::string before = read(scratch_ / "elsewhere");
  cache.keep("part", kKey, content(32));
  EXPECT_EQ(read(scratch_ / "elsewhere"), before) << "written through a link";
  EXPECT_TRUE(finds(cache, content(32)));

  fs::rename(scratch_ / "cache" / "fe", scratch_ / "folder");
  fs::create_directory_symlink(scratch_ / "folder", scratch_ / "cache" / "fe");
  EXPECT_FALSE(cache.find("part", kKey)) << "a folder that is a link";
  const auto count = std::distance(fs::directory_iterator(scratch_ / "folder"), {});
  cache.keep("part", cache::Digest{1, kKey.high}, content(32));
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch_ / "folder"), {}), count);
  EXPECT_TRUE(cache.trouble());
}

TEST_F(CacheFolderTest, WhatIsNoFileIsNotWaitedFor) {
  const cache::CacheFolder cache = open();
  fs::create_directories(entry_path().parent_path());
  ASSERT_EQ(::mkfifo(entry_path().c_str(), 0600), 0);
  EXPECT_FALSE(cache.find("part", kKey));
  fs::remove(entry_path());
  fs::create_directories(entry_path());
  EXPECT_FALSE(cache.find("part", kKey));
  cache.keep("part", kKey, content(8));
  EXPECT_FALSE(cache.find("part", kKey));
  EXPECT_TRUE(cache.trouble());
  EXPECT_TRUE(fs::is_empty(scratch_ / "cache" / "tmp"));
}

TEST_F(CacheFolderTest, RemovesWhatKilledWritersLeft) {
  open();
  const fs::path old_file = scratch_ / "cache" / "tmp" / "old",
                 young_file = scratch_ / "cache" / "tmp" / "young";
  write(old_file, "half");
  write(young_file, "half");
  const std::time_t two_hours_ago = std::time(nullptr) - 7200;
  const utimbuf times{two_hours_ago, two_hours_ago};
  ASSERT_EQ(::utime(old_file.c_str(), &times), 0);
  open();
  EXPECT_FALSE(fs::exists(old_file));
  EXPECT_TRUE(fs::exists(young_file)) << "somebody may be writing it";
}

TEST_F(CacheFolderTest, AFileInItsPlaceIsAnError) {
  write(scratch_ / "cache", "no folder");
  const auto cache = cache::CacheFolder::open((scratch_ / "cache").string());
  ASSERT_FALSE(cache);
  EXPECT_EQ(cache.error().code, ErrorCode::kWriteFailed);
}

// Readers see one whole content or another while writers replace it.
TEST_F(CacheFolderTest, ManyAtOnce) {
  open();
  std::vector<std::thread> threads;
  std::atomic<int> wrong = 0, found = 0;
  for (unsigned t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      const cache::CacheFolder cache = open();
      for (int i = 0; i < 200; ++i) {
        cache.keep("part", kKey, content(5000 + t, t));
        const auto entry = cache.find("part", kKey);
        if (!entry) continue;
        ++found;
        const auto size = entry->bytes().size();
        const auto expected = content(size, static_cast<unsigned>(size - 5000));
        if (size < 5000 || size > 5003 ||
            !std::equal(expected.begin(), expected.end(), entry->bytes().begin())) {
          ++wrong;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(found, 800);
}

}  // namespace
}  // namespace forcelayer
