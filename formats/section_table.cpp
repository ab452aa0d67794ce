#include "formats/section_table.h"

#include <algorithm>
#include <cstring>

#include "formats/file/atomic_file.h"

namespace forcelayer {
namespace {

constexpr std::uint32_t kMaxHeaderBytes = 4096;
constexpr std::uint32_t kMaxSections = 64;
constexpr std::uint64_t kKnownRequiredFeatures = 0;

std::string hex(std::uint64_t number) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  do {
    text.insert(text.begin(), kDigits[number & 15]);
    number >>= 4;
  } while (number != 0);
  return "0x" + text;
}

FileHeader read_file_header(std::span<const std::byte> bytes) {
  FileHeader header;
  std::memcpy(&header, bytes.data(), sizeof header);
  return header;
}

// The table's entries; the file header has been checked.
std::span<const SectionEntry> section_table(std::span<const std::byte> bytes) {
  const FileHeader header = read_file_header(bytes);
  return {reinterpret_cast<const SectionEntry*>(bytes.data() + header.header_bytes),
          header.section_count};
}

std::uint64_t table_end(const FileHeader& header) {
  return header.header_bytes + std::uint64_t{header.section_count} * sizeof(SectionEntry);
}

bool starts_with(std::span<const std::byte> bytes, std::string_view text) {
  return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

bool starts_with(std::span<const std::byte> bytes, const std::array<std::uint8_t, 8>& magic) {
  return starts_with(bytes, {reinterpret_cast<const char*>(magic.data()), magic.size()});
}

// The error for a file without `magic`; it names the format that the file has instead.
Error wrong_magic(std::span<const std::byte> bytes, std::string_view name,
                  const std::array<std::uint8_t, 8>& magic) {
  const bool wants_voxmap = magic == kVoxmapMagic;
  Error error{
      ErrorCode::kNotThisFormat, name, "byte 0",
      wants_voxmap ? "not a Forcelayer .vox file" : "not a Forcelayer .pshell file",
      wants_voxmap ? "make a .vox file with voxelize" : "make a .pshell file with pointshell"};
  if (starts_with(bytes, kPshellMagic)) {
    error.what = "this is a .pshell file (a moving part), but a .vox scene is needed";
    error.mend = "give the scene's .vox file here";
  } else if (starts_with(bytes, kVoxmapMagic)) {
    error.what = "this is a .vox file (a scene), but a .pshell part is needed";
    error.mend = "give the part's .pshell file here";
  } else if (starts_with(bytes, "VOX ")) {
    error.what = "this is a .vox file of MagicaVoxel, not of Forcelayer";
  } else if (bytes.size() >= 4 && std::memcmp(bytes.data() + 1, magic.data() + 1, 3) == 0) {
    error.what += ": its first bytes were changed, perhaps by a transfer in text mode";
    error.mend = "transfer the file in binary mode";
  }
  return error;
}

Status check_magic(std::span<const std::byte> bytes, std::string_view name,
                   const std::array<std::uint8_t, 8>& magic) {
  const auto present = bytes.first(std::min(bytes.size(), magic.size()));
  if (!std::equal(present.begin(), present.end(), std::as_bytes(std::span(magic)).begin())) {
    return wrong_magic(bytes, name, magic);
  }
  if (bytes.size() >= sizeof(FileHeader)) return {};
  return Error{ErrorCode::kTruncated, name, "header",
               bytes.empty() ? "the file is empty"
                             : "the file ends after " + std::to_string(bytes.size()) +
                                   " bytes, inside its header",
               "bake or copy it again"};
}

Status check_version(const FileHeader& header, std::string_view name, const HeaderRule& rule) {
  const std::string file(name);
  if (header.endian_tag == 0x04030201) {
    return Error{ErrorCode::kWrongEndianness, file, "header byte 8", "the file is big-endian",
                 "bake it on a little-endian machine"};
  }
  if (header.endian_tag != kEndianTag) {
    return Error{ErrorCode::kFieldInvalid, file, "header byte 8",
                 "endian tag " + hex(header.endian_tag) + " is not " + hex(kEndianTag),
                 "bake or copy it again"};
  }
  if (header.major != rule.major) {
    return Error{ErrorCode::kUnknownVersion, file, "header byte 12",
                 "the format version is " + std::to_string(header.major) + "." +
                     std::to_string(header.minor) + ", but this program reads version " +
                     std::to_string(rule.major),
                 "bake it again, or use a program that reads that version"};
  }
  return {};
}

// Sizes that the checksum of header and table needs, then that checksum.
Status check_header_checksum(std::span<const std::byte> bytes, std::string_view name,
                             const FileHeader& header, const HeaderRule& rule) {
  const std::string file(name);
  const bool right_size = is_newer_minor(header, rule) ? header.header_bytes >= rule.header_bytes
                                                       : header.header_bytes == rule.header_bytes;
  if (!right_size || header.header_bytes > kMaxHeaderBytes ||
      header.header_bytes % kSectionAlignment != 0) {
    return Error{ErrorCode::kFieldInvalid, file, "header byte 16",
                 "the header has " + std::to_string(header.header_bytes) + " bytes instead of " +
                     std::to_string(rule.header_bytes),
                 "bake or copy it again"};
  }
  if (header.section_count > kMaxSections) {
    return Error{ErrorCode::kFieldInvalid, file, "header byte 20",
                 "the file has " + std::to_string(header.section_count) +
                     " sections, but at most " + std::to_string(kMaxSections) + " are allowed",
                 "bake or copy it again"};
  }
  if (table_end(header) > bytes.size()) {
    return Error{ErrorCode::kTruncated, file, "section table",
                 "the file ends after " + std::to_string(bytes.size()) + " bytes, inside its " +
                     (header.header_bytes > bytes.size() ? "header" : "section table"),
                 "bake or copy it again"};
  }
  std::vector<std::byte> front(bytes.begin(),
                               bytes.begin() + static_cast<std::ptrdiff_t>(table_end(header)));
  std::fill_n(front.begin() + offsetof(FileHeader, header_checksum), 8, std::byte{0});
  if (checksum(front) != header.header_checksum) {
    return Error{ErrorCode::kChecksumMismatch, file, "header",
                 "the header or the section table is damaged: the checksum is " +
                     hex(checksum(front)) + " instead of " + hex(header.header_checksum),
                 "bake or copy it again"};
  }
  return {};
}

Status check_size_and_features(std::span<const std::byte> bytes, std::string_view name,
                               const FileHeader& header, const HeaderRule& rule) {
  const std::string file(name);
  if (bytes.size() != header.file_bytes) {
    const bool shorter = bytes.size() < header.file_bytes;
    return Error{shorter ? ErrorCode::kTruncated : ErrorCode::kTrailingBytes, file,
                 "byte " + std::to_string(std::min<std::uint64_t>(bytes.size(), header.file_bytes)),
                 "the file has " + std::to_string(bytes.size()) + " bytes, but its header says " +
                     std::to_string(header.file_bytes),
                 shorter ? "the file was cut off: bake or copy it again"
                         : "bytes were appended: bake or copy the file again"};
  }
  const std::uint64_t unknown = header.required_features & ~kKnownRequiredFeatures;
  if (unknown != 0) {
    return Error{ErrorCode::kUnknownFeature, file, "header byte 32",
                 "needs features " + hex(unknown) + " that this program does not know",
                 "use a newer version of this program"};
  }
  if (header.reserved != 0 && !is_newer_minor(header, rule)) {
    return Error{ErrorCode::kFieldInvalid, file, "header byte 56", "reserved bytes are not zero",
                 "bake or copy it again"};
  }
  return {};
}

Error table_error(std::string_view name, const std::string& section, std::size_t index,
                  std::string_view what) {
  return {ErrorCode::kSectionInvalid, name,
          "section table entry " + std::to_string(index) +
              (section.empty() ? "" : " (" + section + ")"),
          what, "bake or copy it again"};
}

// A table entry as the checks see it.
struct PlacedEntry {
  const SectionEntry& entry;
  std::size_t index;
  const SectionRule* rule;  // null where this version does not know the section

  Error error(std::string_view name, std::string_view what) const {
    return table_error(name, rule ? rule->name : "", index, what);
  }
};

Status check_identity(const PlacedEntry& placed, std::span<const SectionEntry> table, bool newer,
                      std::string_view name) {
  const SectionEntry& entry = placed.entry;
  if (!placed.rule && !newer) {
    return placed.error(name, "unknown section " + std::to_string(entry.id));
  }
  if (placed.index > 0 && entry.id <= table[placed.index - 1].id) {
    return placed.error(name, "sections are not in ascending order of id");
  }
  const std::uint32_t wanted = placed.rule ? placed.rule->element_bytes : entry.element_bytes;
  if (entry.element_bytes != wanted) {
    return placed.error(name, "has elements of " + std::to_string(entry.element_bytes) +
                                  " bytes, but must have elements of " + std::to_string(wanted) +
                                  " bytes");
  }
  if (wanted == 0 || entry.bytes % wanted != 0) {
    return placed.error(name, "has " + std::to_string(entry.bytes) +
                                  " bytes, which is not a whole number of elements of " +
                                  std::to_string(wanted) + " bytes");
  }
  return {};
}

// The section starts where the one before it ends, up to alignment, and lies in the file.
Status check_placement(const PlacedEntry& placed, std::uint64_t previous_end,
                       std::uint64_t file_bytes, std::string_view name) {
  const SectionEntry& entry = placed.entry;
  if (entry.offset != aligned_offset(previous_end)) {
    return placed.error(name, "starts at byte " + std::to_string(entry.offset) + " instead of " +
                                  std::to_string(aligned_offset(previous_end)));
  }
  if (entry.offset > file_bytes || entry.bytes > file_bytes - entry.offset) {
    return placed.error(name, "its " + std::to_string(entry.bytes) + " bytes at byte " +
                                  std::to_string(entry.offset) + " reach past the end of the file");
  }
  return {};
}

Status check_padding(std::span<const std::byte> bytes, std::uint64_t begin, std::uint64_t end,
                     std::string_view name) {
  for (std::uint64_t at = begin; at < end; ++at) {
    if (bytes[at] != std::byte{0}) {
      return Error{ErrorCode::kSectionInvalid, name, "byte " + std::to_string(at),
                   "padding between sections is not zero", "bake or copy it again"};
    }
  }
  return {};
}

// Null where files of this minor version have no such section.
const SectionRule* find_rule(std::span<const SectionRule> rules, std::uint32_t id,
                             std::uint16_t minor) {
  const auto found = std::find_if(rules.begin(), rules.end(), [&](const SectionRule& rule) {
    return rule.id == id && rule.minor <= minor;
  });
  return found == rules.end() ? nullptr : &*found;
}

Status check_required(std::span<const SectionEntry> table, std::span<const SectionRule> rules,
                      std::string_view name) {
  for (const SectionRule& rule : rules) {
    const bool present = std::any_of(
        table.begin(), table.end(), [&](const SectionEntry& entry) { return entry.id == rule.id; });
    if (present || !rule.required) continue;
    return Error{ErrorCode::kSectionInvalid, name, "section table",
                 std::string("section ") + rule.name + " is missing", "bake or copy it again"};
  }
  return {};
}

}  // namespace

bool is_newer_minor(const FileHeader& header, const HeaderRule& rule) {
  return header.minor > rule.minor;
}

Status check_file_header(std::span<const std::byte> bytes, std::string_view name,
                         const HeaderRule& rule) {
  if (Status magic = check_magic(bytes, name, rule.magic); !magic) return magic;
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % kSectionAlignment != 0) {
    return Error{ErrorCode::kInternal, name, "", "the bytes in memory are not 64-byte aligned", ""};
  }
  const FileHeader header = read_file_header(bytes);
  if (Status version = check_version(header, name, rule); !version) return version;
  if (Status sum = check_header_checksum(bytes, name, header, rule); !sum) return sum;
  return check_size_and_features(bytes, name, header, rule);
}

Result<std::vector<std::span<const std::byte>>> check_sections(std::span<const std::byte> bytes,
                                                               std::string_view name,
                                                               const HeaderRule& header_rule,
                                                               std::span<const SectionRule> rules) {
  const FileHeader header = read_file_header(bytes);
  const auto table = section_table(bytes);
  std::vector<std::span<const std::byte>> sections(rules.size());
  std::uint64_t end = table_end(header);
  for (std::size_t index = 0; index < table.size(); ++index) {
    const PlacedEntry placed{table[index], index, find_rule(rules, table[index].id, header.minor)};
    if (Status s = check_identity(placed, table, is_newer_minor(header, header_rule), name); !s) {
      return s.error();
    }
    if (Status s = check_placement(placed, end, header.file_bytes, name); !s) return s.error();
    if (Status s = check_padding(bytes, end, placed.entry.offset, name); !s) return s.error();
    end = placed.entry.offset + placed.entry.bytes;
    if (!placed.rule) continue;
    sections[static_cast<std::size_t>(placed.rule - rules.data())] =
        bytes.subspan(placed.entry.offset, placed.entry.bytes);
  }
  if (Status s = check_required(table, rules, name); !s) return s.error();
  if (end == header.file_bytes) return sections;
  return Error{ErrorCode::kSectionInvalid, name, "section table",
               "the last section ends at byte " + std::to_string(end) +
                   ", but the file ends at byte " + std::to_string(header.file_bytes),
               "bake or copy it again"};
}

Status check_section_checksums(std::span<const std::byte> bytes, std::string_view name,
                               std::span<const SectionRule> rules) {
  for (const SectionEntry& entry : section_table(bytes)) {
    const std::uint64_t actual = checksum(bytes.subspan(entry.offset, entry.bytes));
    if (actual == entry.checksum) continue;
    const SectionRule* rule = find_rule(rules, entry.id, read_file_header(bytes).minor);
    return Error{ErrorCode::kChecksumMismatch, name,
                 rule ? rule->name : "section " + std::to_string(entry.id),
                 "the section is damaged: the checksum is " + hex(actual) + " instead of " +
                     hex(entry.checksum),
                 "bake or copy it again"};
  }
  return {};
}

FileLayout lay_out_file(std::span<const std::byte> header, const HeaderRule& rule,
                        std::span<const SectionContent> sections) {
  static constexpr std::array<std::byte, kSectionAlignment> kZeros{};
  FileHeader file{};
  file.magic = rule.magic;
  file.endian_tag = kEndianTag;
  file.major = rule.major;
  for (const SectionContent& section : sections) file.minor = std::max(file.minor, section.minor);
  file.header_bytes = rule.header_bytes;
  file.section_count = static_cast<std::uint32_t>(sections.size());

  FileLayout layout;
  std::vector<SectionEntry> table;
  std::uint64_t end = table_end(file);
  const std::uint64_t front_bytes = end;
  for (const SectionContent& section : sections) {
    const std::uint64_t offset = aligned_offset(end);
    layout.pieces.push_back(std::span(kZeros).first(offset - end));
    layout.pieces.push_back(section.bytes);
    table.push_back(
        {section.id, section.element_bytes, offset, section.bytes.size(), checksum(section.bytes)});
    end = offset + section.bytes.size();
  }
  file.file_bytes = end;
  layout.file_bytes = end;
  layout.front.resize(front_bytes);
  std::memcpy(layout.front.data(), header.data(), header.size());
  std::memcpy(layout.front.data(), &file, sizeof file);
  if (!table.empty()) {
    std::memcpy(layout.front.data() + header.size(), table.data(),
                table.size() * sizeof(SectionEntry));
  }
  file.header_checksum = checksum(layout.front);
  std::memcpy(layout.front.data(), &file, sizeof file);
  return layout;
}

std::vector<std::byte> bytes_of(const FileLayout& layout) {
  std::vector<std::byte> bytes;
  bytes.reserve(layout.file_bytes);
  bytes.insert(bytes.end(), layout.front.begin(), layout.front.end());
  for (const auto& piece : layout.pieces) bytes.insert(bytes.end(), piece.begin(), piece.end());
  return bytes;
}

Result<std::uint64_t> write_layout(const std::filesystem::path& path, const FileLayout& layout,
                                   ReaderCheck check) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  if (Status written = file->write(layout.front); !written) return written.error();
  for (const auto& piece : layout.pieces) {
    if (Status written = file->write(piece); !written) return written.error();
  }
  if (Status committed = file->commit(check); !committed) return committed.error();
  return layout.file_bytes;
}

}  // namespace forcelayer
