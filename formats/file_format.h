// The first 64 bytes, the section table and the limits that .vox and .pshell share.
// The normative text is voxmap_format.md and pshell_format.md. All numbers are little-endian.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace forcelayer {

// The first byte has its high bit set and a CRLF follows, so that a transfer that strips bits or
// translates line ends is seen at once (as PNG does).
inline constexpr std::array<std::uint8_t, 8> kVoxmapMagic = {0x89, 'F',  'L',  'V',
                                                             '\r', '\n', 0x1a, '\n'};
inline constexpr std::array<std::uint8_t, 8> kPshellMagic = {0x89, 'F',  'L',  'P',
                                                             '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kEndianTag = 0x01020304;
inline constexpr std::uint64_t kSectionAlignment = 64;  // bytes, of every section's offset

struct FileHeader {                   // offset
  std::array<std::uint8_t, 8> magic;  //  0
  std::uint32_t endian_tag;           //  8
  std::uint16_t major;                // 12  another major is refused
  std::uint16_t minor;                // 14  a higher minor is read
  std::uint32_t header_bytes;         // 16  this struct and the format's own part
  std::uint32_t section_count;        // 20  entries of the table that follows the header
  std::uint64_t file_bytes;           // 24  exact size of the file
  std::uint64_t required_features;    // 32  an unknown bit is refused
  std::uint64_t optional_features;    // 40  an unknown bit is ignored
  std::uint64_t header_checksum;      // 48  XXH3-64 of header and table, this field as zero
  std::uint64_t reserved;             // 56  zero
};
static_assert(sizeof(FileHeader) == 64);
static_assert(offsetof(FileHeader, file_bytes) == 24);
static_assert(offsetof(FileHeader, header_checksum) == 48);

struct SectionEntry {           // offset
  std::uint32_t id;             //  0  one of the format's section ids, each at most once
  std::uint32_t element_bytes;  //  4
  std::uint64_t offset;         //  8  from the start of the file, 64-byte aligned, ascending
  std::uint64_t bytes;          // 16  a multiple of element_bytes
  std::uint64_t checksum;       // 24  XXH3-64 of the section's bytes
};
static_assert(sizeof(SectionEntry) == 32);

}  // namespace forcelayer
