// Fields of a baked file that lie, under right checksums.
#pragma once

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "formats/voxmap.h"
#include "tests/support/file_surgery.h"

namespace forcelayer::testing {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Opens a Voxmap or Pshell in which `value` stands at `offset`, under right checksums.
template <class File, typename T>
Result<File> open_with(AlignedBytes& bytes, std::size_t offset, T value) {
  write_at(bytes.bytes(), offset, value);
  resign(bytes.bytes());
  return File::from_bytes(bytes.bytes(), "damaged file", Verify::kStructureAndChecksums);
}

// Such a file is refused, with the field's name in the message.
template <class File, typename T>
void expect_refused(AlignedBytes bytes, std::size_t offset, T value, const char* field) {
  SCOPED_TRACE(std::string(field) + " = " + std::to_string(value));
  const Result<File> file = open_with<File>(bytes, offset, value);
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().code, ErrorCode::kFieldInvalid) << to_line(file.error());
  EXPECT_NE(file.error().where.find(field), std::string::npos) << to_line(file.error());
}

}  // namespace forcelayer::testing
