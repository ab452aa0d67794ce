// Damaging baked files on purpose: fields, checksums and bytes of a file in memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <stdexcept>
#include <vector>

#include "formats/section_table.h"
#include "formats/voxmap.h"
#include "formats/voxmap_format.h"
#include "tests/support/aligned_bytes.h"

namespace forcelayer::testing {

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

// Changes the clearance of one free box of a .vox file by `by`, down to 0 at most. False if no box
// has one to change.
inline bool change_clearance(std::span<std::byte> bytes, int by, std::mt19937_64& random) {
  for (int tries = 0; tries < 1000; ++tries) {
    const auto id = static_cast<std::uint32_t>(VoxmapSection::kUpperNodes) +
                    static_cast<std::uint32_t>(random() % 2);
    const auto section = read_at<SectionEntry>(bytes, table_entry_of(bytes, id));
    if (section.bytes == 0) continue;
    const std::size_t at = section.offset + 4 * (random() % (section.bytes / 4));
    const auto entry = read_at<std::uint32_t>(bytes, at);
    if (!is_uniform(entry) || uniform_value(entry) != 0) continue;
    const int from = static_cast<int>(uniform_clearance(entry)), to = std::max(0, from + by);
    if (to == from) continue;
    write_at(bytes, at, uniform_entry(0, static_cast<std::uint32_t>(to)));
    return true;
  }
  return false;
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

}  // namespace forcelayer::testing
