// AtomicFile leaves all of the old bytes or all of the new ones.
#include "formats/file/atomic_file.h"

#include <grp.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <thread>

#include "formats/file/temporary_files.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::testing {
namespace {

namespace fs = std::filesystem;
using test::entries_of;
using test::ScratchFolder;

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string content_of(const fs::path& path) {
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

void write_text(const fs::path& path, std::string_view text) {
  auto file = AtomicFile::create(path);
  ASSERT_TRUE(file) << to_line(file.error());
  ASSERT_TRUE(file->write(bytes_of(text)));
  ASSERT_TRUE(file->commit());
}

TEST(AtomicFile, ReplacesOnCommitAndNotBefore) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "scene.vox";
  write_text(path, "old");
  auto file = AtomicFile::create(path);
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write(bytes_of("new ")));
  ASSERT_TRUE(file->write(bytes_of("bytes")));
  EXPECT_EQ(content_of(path), "old");
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(content_of(path), "new bytes");
  EXPECT_EQ(entries_of(folder.path()), 1);
}

TEST(AtomicFile, LeavesTheOldFileWithoutCommit) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "scene.vox";
  write_text(path, "old");
  {
    auto file = AtomicFile::create(path);
    ASSERT_TRUE(file && file->write(bytes_of("new")));
  }
  EXPECT_EQ(content_of(path), "old");
  EXPECT_EQ(entries_of(folder.path()), 1);
}

TEST(AtomicFile, MovesWithItsTemporary) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / "scene.vox";
  auto created = AtomicFile::create(path);
  ASSERT_TRUE(created);
  AtomicFile moved = std::move(*created);
  AtomicFile again = std::move(moved);
  ASSERT_TRUE(again.write(bytes_of("new")));
  ASSERT_TRUE(again.commit());
  EXPECT_EQ(content_of(path), "new");
  EXPECT_EQ(entries_of(folder.path()), 1);
}

TEST(AtomicFile, FollowsASymbolicLink) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "real");
  fs::create_symlink("real/scene.vox", folder.path() / "link.vox");
  write_text(folder.path() / "link.vox", "first");  // the link's target does not exist yet
  write_text(folder.path() / "link.vox", "second");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link.vox"));
  EXPECT_EQ(content_of(folder.path() / "real" / "scene.vox"), "second");
  EXPECT_EQ(entries_of(folder.path() / "real"), 1);
}

TEST(AtomicFile, HasTheModeOfAnOrdinaryFile) {
  const ScratchFolder folder;
  const mode_t before = ::umask(022);
  write_text(folder.path() / "scene.vox", "x");
  ::umask(before);
  struct stat status {};
  ASSERT_EQ(::stat((folder.path() / "scene.vox").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0644u);
}

TEST(AtomicFile, KeepsOwnerAndModeOfTheOldFile) {
  const ScratchFolder folder;
  const std::string path = (folder.path() / "scene.vox").string();
  write_text(path, "first");
  ASSERT_EQ(::chmod(path.c_str(), 0460), 0);
  constexpr uid_t kOther = 12345;  // nobody here
  const bool is_root = ::geteuid() == 0;
  if (is_root) {
    ASSERT_EQ(::chown(path.c_str(), kOther, kOther + 1), 0);
  }
  write_text(path, "second");
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(content_of(path), "second");
  EXPECT_EQ(status.st_mode & 0777, 0460u);
  EXPECT_EQ(status.st_uid, is_root ? kOther : ::geteuid());
  if (is_root) {
    EXPECT_EQ(status.st_gid, kOther + 1);
  }
}

// A user who cannot keep the owner does not let others read what they could not.
TEST(AtomicFile, IsNoMoreOpenThanTheOldFileOfAnotherOwner) {
  if (::geteuid() != 0) GTEST_SKIP() << "takes root, to become another user";
  const ScratchFolder folder;
  ASSERT_EQ(::chmod(folder.path().c_str(), 0777), 0);
  const std::string path = (folder.path() / "scene.vox").string();
  write_text(path, "first");
  ASSERT_EQ(::chmod(path.c_str(), 0600), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kOther = 12345;
    if (::setgroups(0, nullptr) != 0 || ::setresgid(kOther, kOther, kOther) != 0 ||
        ::setresuid(kOther, kOther, kOther) != 0) {
      ::_exit(1);
    }
    write_text(path, "second");
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_EQ(status, 0);
  struct stat facts {};
  ASSERT_EQ(::stat(path.c_str(), &facts), 0);
  EXPECT_EQ(content_of(path), "second");
  EXPECT_EQ(facts.st_mode & 0777, 0600u);
}

TEST(AtomicFile, TakesLongNames) {
  const ScratchFolder folder;
  const fs::path path = folder.path() / std::string(255, 'x');
  write_text(path, "x");
  EXPECT_EQ(content_of(path), "x");
}

TEST(AtomicFile, RefusesWhatIsNoFile) {
  const ScratchFolder folder;
  for (const fs::path& path : {folder.path(), folder.path() / "no" / "scene.vox", fs::path(),
                               folder.path() / std::string(256, 'x')}) {
    const auto file = AtomicFile::create(path);
    ASSERT_FALSE(file) << path;
    EXPECT_EQ(file.error().code, ErrorCode::kWriteFailed);
    EXPECT_EQ(file.error().file, path.string());
  }
  EXPECT_EQ(entries_of(folder.path()), 0);
}

TEST(AtomicFile, WritesThroughDevicesAndDescriptors) {
  write_text("/dev/null", "x");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const ScratchFolder folder;
  const fs::path path = folder.path() / "redirected";
  std::FILE* redirected = std::fopen(path.c_str(), "w");
  std::fputs("before ", redirected);
  std::fflush(redirected);
  write_text("/dev/fd/" + std::to_string(::fileno(redirected)), "report");
  std::fputs(" after", redirected);
  std::fclose(redirected);
  EXPECT_EQ(content_of(path), "before report after");
}

// Three threads begin files all the time while the process ends as on a signal. A file that was
// registered, and created only after the others had been removed, was left behind.
TEST(AtomicFile, NoneIsBegunOnceTheProcessEnds) {
  const ScratchFolder folder;
  constexpr int kEnds = 300;
  for (int n = 0; n < kEnds; ++n) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      std::atomic<int> begun{0};
      for (int thread = 0; thread < 3; ++thread) {
        std::thread([&, thread] {
          while (true) {
            const auto file = AtomicFile::create(folder / std::to_string(thread));
            ++begun;
          }
        }).detach();
      }
      while (begun < 10 + n % 7) std::this_thread::yield();
      remove_temporary_files();
      ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0);
    for (const auto& left : std::filesystem::directory_iterator(folder / "")) {
      FAIL() << left.path() << " is left after " << n << " ends";
    }
  }
}

TEST(AtomicFile, ReportsAFullDisk) {
  auto full = AtomicFile::create("/dev/full");
  if (!full) GTEST_SKIP() << "no /dev/full here";
  const Status written = full->write(bytes_of("x"));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kWriteFailed);
  EXPECT_EQ(written.error().mend, "free some space, or write elsewhere");
}

}  // namespace
}  // namespace forcelayer::testing
