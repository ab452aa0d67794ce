// Files that are read whole into memory.
#include "formats/file/file_bytes.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "formats/section_table.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

// Bytes of which no two neighbors are equal.
std::string pattern(std::size_t size) {
  std::string text(size, 0);
  for (std::size_t i = 0; i < size; ++i) text[i] = static_cast<char>(i * 37 + i / 251);
  return text;
}

std::string text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// On both sides of a page, and of the pieces of read_in_pieces().
TEST(FileBytes, HaveEveryByteWholeAndInPieces) {
  constexpr std::size_t kPage = 4096, kPiece = 256 * 1024;
  const ScratchFolder folder;
  const auto path = folder / "file";
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kPage - 1, kPage, kPage + 1,
                                 kPiece - 1, kPiece, kPiece + 1, 3 * kPiece + 5}) {
    const std::string written = pattern(size);
    std::ofstream(path, std::ios::binary) << written;
    const auto file = FileBytes::read(path);
    ASSERT_TRUE(file) << size;
    EXPECT_TRUE(text_of(file->bytes()) == written) << size;
    std::string pieces;
    ASSERT_TRUE(read_in_pieces(path, [&](auto piece) { pieces += text_of(piece); }));
    EXPECT_TRUE(pieces == written) << size;
    EXPECT_EQ(*checksum_of_file(path), checksum(file->bytes())) << size;
  }
}

TEST(FileBytes, StayWhatTheyWere) {
  const ScratchFolder folder;
  const auto path = folder / "file";
  const std::string written = pattern(3 * 4096);
  std::ofstream(path, std::ios::binary) << written;
  auto read = FileBytes::read(path);
  ASSERT_TRUE(read);
  std::fstream(path, std::ios::in | std::ios::out | std::ios::binary) << "other bytes";
  std::filesystem::resize_file(path, 5000);
  const FileBytes moved = std::move(*read);
  EXPECT_TRUE(text_of(moved.bytes()) == written);
  std::filesystem::resize_file(path, 0);
  std::filesystem::remove(path);
  EXPECT_TRUE(text_of(moved.bytes()) == written);
}

TEST(FileBytesDeathTest, AreReadOnly) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const ScratchFolder folder;
  std::ofstream(folder / "file", std::ios::binary) << pattern(100);
  const auto file = FileBytes::read(folder / "file");
  ASSERT_TRUE(file);
  EXPECT_DEATH(const_cast<volatile std::byte&>(file->bytes()[50]) = std::byte{1}, "");
}

TEST(FileBytes, WhatIsNoFileIsRefused) {
  const ScratchFolder folder;
  EXPECT_EQ(FileBytes::read(folder / "none").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(FileBytes::read("").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(FileBytes::read(folder.path()).error().code, ErrorCode::kFileNotFound);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(FileBytes::read(folder / "pipe").error().what, "is not a regular file");
  const auto nothing = [](std::span<const std::byte>) {};
  EXPECT_EQ(read_in_pieces(folder / "none", nothing).error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_in_pieces(folder / "pipe", nothing).error().what, "is not a regular file");
}

// The system says that this file has a page, and gives fewer bytes: as of one that is cut short
// between the two.
TEST(FileBytes, AFileWithFewerBytesThanItsSizeIsRefused) {
  constexpr const char* kShort = "/sys/devices/system/cpu/online";
  if (!std::filesystem::exists(kShort)) GTEST_SKIP() << kShort << " is missing";
  const auto file = FileBytes::read(kShort);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, ErrorCode::kReadFailed);
  EXPECT_EQ(file.error().what, "was cut short while it was being read");
  EXPECT_FALSE(read_in_pieces(kShort, [](auto) {}));
}

}  // namespace
}  // namespace forcelayer::test
