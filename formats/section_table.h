// The first 64 bytes and the section table of both formats: checks for readers, layout for writers.
// Internal to formats/.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/file/atomic_file.h"
#include "formats/file_format.h"
#include "formats/result.h"

namespace forcelayer {

// XXH3-64 with seed 0.
std::uint64_t checksum(std::span<const std::byte> bytes);

// The same for a file, which is read in small pieces.
Result<std::uint64_t> checksum_of_file(const std::filesystem::path& path);

// The smallest multiple of kSectionAlignment that is not below `offset`.
constexpr std::uint64_t aligned_offset(std::uint64_t offset) {
  return (offset + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
}

// The magic, the version and the size of a format's header.
struct HeaderRule {
  std::array<std::uint8_t, 8> magic;
  std::uint16_t major;         // another is refused
  std::uint16_t minor;         // the highest that is known; a higher one is read
  std::uint32_t header_bytes;  // of this minor version
};

// The id, element size and presence that a format requires of one section.
struct SectionRule {
  std::uint32_t id;
  const char* name;             // for errors
  std::uint32_t element_bytes;  // exact
  bool required;                // must stand in the table, if only with zero bytes
  std::uint16_t minor = 0;      // the minor version that brought it; unknown in files of lower ones
};

// Checks the first 64 bytes, the header's checksum, the exact size of the file, version and feature
// flags, and that `bytes` are 64-byte aligned. Afterwards `rule.header_bytes` bytes of header and
// the section table may be read. `name` is the file's, for errors.
Status check_file_header(std::span<const std::byte> bytes, std::string_view name,
                         const HeaderRule& rule);

// Checks the section table against a format's rules and returns the sections' bytes: one span for
// each rule, in the rules' order (ascending ids), empty where an optional section is absent. The
// file header has been checked before.
Result<std::vector<std::span<const std::byte>>> check_sections(std::span<const std::byte> bytes,
                                                               std::string_view name,
                                                               const HeaderRule& header_rule,
                                                               std::span<const SectionRule> rules);

// Checks every section's checksum against the table; the table has been checked.
Status check_section_checksums(std::span<const std::byte> bytes, std::string_view name,
                               std::span<const SectionRule> rules);

// Whether the file has a minor version that this reader does not know. Such a file may give meaning
// to bytes that are reserved here, lengthen the header and add sections.
bool is_newer_minor(const FileHeader& header, const HeaderRule& rule);

// The elements of a checked section.
template <typename T>
std::span<const T> elements_of(std::span<const std::byte> section) {
  return {reinterpret_cast<const T*>(section.data()), section.size() / sizeof(T)};
}

// A file laid out for writing, as pieces that follow each other without gaps. `front` owns header
// and table; the other pieces are the caller's sections and the zeros between them.
struct FileLayout {
  std::vector<std::byte> front;
  std::vector<std::span<const std::byte>> pieces;  // after `front`
  std::uint64_t file_bytes = 0;
};

struct SectionContent {
  std::uint32_t id;
  std::uint32_t element_bytes;
  std::span<const std::byte> bytes;
  std::uint16_t minor = 0;  // SectionRule::minor
};

// Lays out a file whose format header is `header` (a FileHeader first; its other fields are filled
// in here) and whose sections, in ascending order of id, are `sections`. Its minor version is the
// lowest that has them all.
FileLayout lay_out_file(std::span<const std::byte> header, const HeaderRule& rule,
                        std::span<const SectionContent> sections);

// All bytes of `layout`, one after the other.
std::vector<std::byte> bytes_of(const FileLayout& layout);

// Writes `layout` to `path` atomically; returns the file's size. What its reader would refuse is
// not written: kInternal.
Result<std::uint64_t> write_layout(const std::filesystem::path& path, const FileLayout& layout,
                                   ReaderCheck check);

}  // namespace forcelayer
