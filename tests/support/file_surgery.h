// Damaging baked files on purpose: fields, checksums and bytes of a file in memory.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "formats/section_table.h"
#include "formats/voxmap.h"
#include "tests/support/aligned_bytes.h"

namespace forcelayer::testing {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename T>
T read_at(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

template <typename T>
void write_at(std::span<std::byte> bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

// Offset in the file of entry `index` of the section table.
inline std::size_t table_entry_at(std::span<const std::byte> bytes, std::size_t index) {
  return read_at<FileHeader>(bytes, 0).header_bytes + index * sizeof(SectionEntry);
}

// The table entry of the section with this id; throws where there is none.
inline std::size_t table_entry_of(std::span<const std::byte> bytes, std::uint32_t id) {
  const std::uint32_t count = read_at<FileHeader>(bytes, 0).section_count;
  for (std::size_t index = 0; index < count; ++index) {
    const std::size_t at = table_entry_at(bytes, index);
    if (read_at<SectionEntry>(bytes, at).id == id) return at;
  }
  throw std::out_of_range("no such section");
}

inline std::size_t section_offset(std::span<const std::byte> bytes, std::uint32_t id) {
  return read_at<SectionEntry>(bytes, table_entry_of(bytes, id)).offset;
}

// Makes all checksums right again, as far as header and table still make sense.
inline void resign(std::span<std::byte> bytes) {
  if (bytes.size() < sizeof(FileHeader)) return;
  const auto header = read_at<FileHeader>(bytes, 0);
  const std::uint64_t table_end =
      header.header_bytes + std::uint64_t{header.section_count} * sizeof(SectionEntry);
  if (table_end > bytes.size() || header.header_bytes < sizeof(FileHeader)) return;
  for (std::size_t index = 0; index < header.section_count; ++index) {
    const std::size_t at = table_entry_at(bytes, index);
    auto entry = read_at<SectionEntry>(bytes, at);
    if (entry.offset > bytes.size() || entry.bytes > bytes.size() - entry.offset) continue;
    entry.checksum = checksum(bytes.subspan(entry.offset, entry.bytes));
    write_at(bytes, at, entry);
  }
  write_at(bytes, offsetof(FileHeader, header_checksum), std::uint64_t{0});
  write_at(bytes, offsetof(FileHeader, header_checksum), checksum(bytes.first(table_end)));
}

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
