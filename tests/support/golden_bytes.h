// Files that were committed once, and bytes that must stay theirs.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/file/atomic_file.h"
#include "formats/file/file_bytes.h"
#include "tests/support/places.h"

namespace forcelayer::testing {

inline std::filesystem::path golden_path(const std::string& name) {
  return test::source_path("tests/golden/" + name);
}

// Compares bytes with the committed file's; FORCELAYER_WRITE_GOLDEN=1 writes those that do not
// exist yet.
inline void expect_golden_bytes(const std::string& name, const std::vector<std::byte>& bytes) {
  if (std::getenv("FORCELAYER_WRITE_GOLDEN") && !std::filesystem::exists(golden_path(name))) {
    auto file = AtomicFile::create(golden_path(name));
    ASSERT_TRUE(file && file->write(bytes) && file->commit());
  }
  const auto committed = FileBytes::read(golden_path(name));
  ASSERT_TRUE(committed) << to_line(committed.error());
  ASSERT_EQ(committed->bytes().size(), bytes.size()) << name;
  const auto [ours, theirs] = std::mismatch(bytes.begin(), bytes.end(), committed->bytes().begin());
  EXPECT_EQ(ours, bytes.end()) << name << ": first difference at byte " << ours - bytes.begin();
}

}  // namespace forcelayer::testing
