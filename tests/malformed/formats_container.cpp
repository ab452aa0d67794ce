// Damage that both formats refuse in the same way: cut files, longer files, other files, flipped
// bits.
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/address_limit.h"
#include "tests/support/file_surgery.h"
#include "tests/support/golden_content.h"

namespace forcelayer::testing {
namespace {

// A format's golden content and its reader.
struct Format {
  const char* name;
  std::function<AlignedBytes()> make;
  std::function<Status(std::span<const std::byte>, Verify)> open;
};

template <typename File>
Status open_as(std::span<const std::byte> bytes, Verify verify) {
  const auto file = File::from_bytes(bytes, "damaged", verify);
  return file ? Status() : Status(file.error());
}

const Format kFormats[] = {
    {"vox", [] { return golden_file_bytes("v2.vox"); }, open_as<Voxmap>},
    {"vox with distances", [] { return golden_file_bytes("v2_distances.vox"); }, open_as<Voxmap>},
    {"pshell", [] { return golden_file_bytes("v2.pshell"); }, open_as<Pshell>}};

class DamagedFile : public ::testing::TestWithParam<Format> {
 protected:
  AlignedBytes whole_ = GetParam().make();

  // Opens the bytes, which must be refused with one clear line.
  Error refused(std::span<const std::byte> bytes, Verify verify = Verify::kStructureAndChecksums) {
    const Status status = GetParam().open(bytes, verify);
    EXPECT_FALSE(status);
    if (status) return {};
    EXPECT_EQ(exit_status(status.error().code), 4) << to_line(status.error());
    EXPECT_EQ(status.error().file, "damaged");
    EXPECT_FALSE(status.error().where.empty()) << to_line(status.error());
    EXPECT_FALSE(status.error().what.empty());
    return status.error();
  }

  template <typename T>
  AlignedBytes with_field(std::size_t offset, T value, bool resigned = true) {
    AlignedBytes bytes(whole_.bytes());
    write_at(bytes.bytes(), offset, value);
    if (resigned) resign(bytes.bytes());
    return bytes;
  }
};

TEST_P(DamagedFile, TheWholeFileIsAccepted) {
  const Status status = GetParam().open(whole_.bytes(), Verify::kStructureAndChecksums);
  EXPECT_TRUE(status) << to_line(status.error());
}

TEST_P(DamagedFile, EveryTruncatedPrefixIsRefused) {
  for (std::size_t size = 0; size < whole_.bytes().size(); ++size) {
    const AlignedBytes cut(whole_.bytes().first(size));  // exact size: over-reads show under asan
    const Error error = refused(cut.bytes(), Verify::kStructure);
    ASSERT_EQ(error.code, ErrorCode::kTruncated) << "at " << size << ": " << to_line(error);
  }
}

// A header that agrees with the cut size only moves the complaint to the section table.
TEST_P(DamagedFile, EveryTruncatedPrefixIsRefusedWithAgreeingHeader) {
  const auto header = read_at<FileHeader>(whole_.bytes(), 0);
  const std::size_t table_end = table_entry_at(whole_.bytes(), header.section_count);
  for (std::size_t size = table_end; size < whole_.bytes().size(); ++size) {
    AlignedBytes cut(whole_.bytes().first(size));
    write_at(cut.bytes(), offsetof(FileHeader, file_bytes), std::uint64_t{size});
    resign(cut.bytes());
    const Error error = refused(cut.bytes(), Verify::kStructure);
    ASSERT_EQ(error.code, ErrorCode::kSectionInvalid) << "at " << size << ": " << to_line(error);
  }
}

TEST_P(DamagedFile, TrailingBytesAreRefused) {
  for (const std::size_t extra : {1u, 8u, 64u, 4096u}) {
    std::vector<std::byte> longer(whole_.bytes().begin(), whole_.bytes().end());
    longer.insert(longer.end(), extra, std::byte{0});
    EXPECT_EQ(refused(AlignedBytes(longer).bytes()).code, ErrorCode::kTrailingBytes);
    AlignedBytes agreeing(longer);
    write_at(agreeing.bytes(), offsetof(FileHeader, file_bytes), std::uint64_t{longer.size()});
    resign(agreeing.bytes());
    EXPECT_EQ(refused(agreeing.bytes()).code, ErrorCode::kSectionInvalid);
  }
}

TEST_P(DamagedFile, EveryFlippedBitIsNoticed) {
  for (std::size_t at = 0; at < whole_.bytes().size(); ++at) {
    for (const unsigned bit : {static_cast<unsigned>(at % 8), static_cast<unsigned>(at / 8 % 8)}) {
      AlignedBytes bytes(whole_.bytes());
      bytes.bytes()[at] ^= static_cast<std::byte>(1u << bit);
      const Status status = GetParam().open(bytes.bytes(), Verify::kStructureAndChecksums);
      ASSERT_FALSE(status) << "byte " << at << " bit " << bit;
    }
  }
}

TEST_P(DamagedFile, HeaderDamageIsNoticedWithoutReadingSections) {
  const auto header = read_at<FileHeader>(whole_.bytes(), 0);
  for (std::size_t at = 0; at < table_entry_at(whole_.bytes(), header.section_count); ++at) {
    AlignedBytes bytes(whole_.bytes());
    bytes.bytes()[at] ^= std::byte{0x10};
    refused(bytes.bytes(), Verify::kStructure);
  }
}

TEST_P(DamagedFile, OtherMagicsAreNamed) {
  EXPECT_EQ(refused(with_field(0, std::uint8_t{0x09}).bytes()).code, ErrorCode::kNotThisFormat);
  const auto stl = with_field(0, std::array<char, 8>{'s', 'o', 'l', 'i', 'd', ' ', 'a', '\n'});
  EXPECT_EQ(refused(stl.bytes()).code, ErrorCode::kNotThisFormat);
  const auto magica = with_field(0, std::array<char, 8>{'V', 'O', 'X', ' ', '\x64', 0, 0, 0});
  EXPECT_NE(refused(magica.bytes()).what.find("MagicaVoxel"), std::string::npos);
  // A transfer that turns CRLF into LF.
  std::vector<std::byte> text(whole_.bytes().begin(), whole_.bytes().end());
  text.erase(text.begin() + 4);
  EXPECT_NE(refused(AlignedBytes(text).bytes()).mend.find("binary"), std::string::npos);
}

TEST_P(DamagedFile, VersionsAndFeatures) {
  EXPECT_EQ(refused(with_field(8, std::uint32_t{0x04030201}).bytes()).code,
            ErrorCode::kWrongEndianness);
  EXPECT_EQ(refused(with_field(8, std::uint32_t{7}).bytes()).code, ErrorCode::kFieldInvalid);
  const int own = read_at<FileHeader>(whole_.bytes(), 0).major;
  for (const int major : {0, own - 1, own + 1, 65535}) {
    const Error error = refused(with_field(12, static_cast<std::uint16_t>(major)).bytes());
    EXPECT_EQ(error.code, ErrorCode::kUnknownVersion);
  }
  for (int bit = 0; bit < 64; ++bit) {
    EXPECT_EQ(refused(with_field(32, std::uint64_t{1} << bit).bytes()).code,
              ErrorCode::kUnknownFeature);
    EXPECT_TRUE(GetParam().open(with_field(40, std::uint64_t{1} << bit).bytes(),
                                Verify::kStructureAndChecksums));
  }
}

// A later minor version may give meaning to reserved bytes; a known one may not.
TEST_P(DamagedFile, ReservedBytesBelongToLaterMinorVersions) {
  const auto header = read_at<FileHeader>(whole_.bytes(), 0);
  for (const std::size_t at : {std::size_t{56}, std::size_t{header.header_bytes} - 1}) {
    AlignedBytes bytes = with_field(at, std::uint8_t{1});
    EXPECT_EQ(refused(bytes.bytes()).code, ErrorCode::kFieldInvalid);
    write_at(bytes.bytes(), offsetof(FileHeader, minor), std::uint16_t{7});
    resign(bytes.bytes());
    EXPECT_TRUE(GetParam().open(bytes.bytes(), Verify::kStructureAndChecksums));
  }
}

// A later minor version may append to the header and bring a section of its own.
TEST_P(DamagedFile, LongerHeaderAndUnknownSectionOfALaterMinorVersion) {
  const auto old = read_at<FileHeader>(whole_.bytes(), 0);
  const std::size_t table_bytes = old.section_count * sizeof(SectionEntry);
  const auto whole = whole_.bytes();
  const std::uint64_t first = read_at<SectionEntry>(whole, table_entry_at(whole, 0)).offset;
  const std::uint64_t new_table_end = old.header_bytes + 64 + table_bytes + sizeof(SectionEntry);
  const std::uint64_t shift = aligned_offset(new_table_end) - first;

  std::vector<std::byte> bytes(aligned_offset(whole.size() + shift) + 5);
  std::copy(whole.begin() + first, whole.end(), bytes.begin() + first + shift);
  auto header = old;
  header.minor = 7;
  header.header_bytes += 64;
  header.section_count += 1;
  header.file_bytes = bytes.size();
  std::copy_n(whole.begin(), old.header_bytes, bytes.begin());
  write_at(bytes, 0, header);
  for (std::size_t index = 0; index < old.section_count; ++index) {
    auto entry = read_at<SectionEntry>(whole, table_entry_at(whole, index));
    entry.offset += shift;
    write_at(bytes, table_entry_at(bytes, index), entry);
  }
  write_at(bytes, table_entry_at(bytes, old.section_count),
           SectionEntry{1000, 5, bytes.size() - 5, 5, 0});
  resign(bytes);

  const Status status =
      GetParam().open(AlignedBytes(bytes).bytes(), Verify::kStructureAndChecksums);
  EXPECT_TRUE(status) << to_line(status.error());
  write_at(bytes, offsetof(FileHeader, minor), std::uint16_t{0});
  resign(bytes);
  EXPECT_EQ(refused(AlignedBytes(bytes).bytes()).code, ErrorCode::kFieldInvalid);
}

TEST_P(DamagedFile, SectionTable) {
  const auto header = read_at<FileHeader>(whole_.bytes(), 0);
  for (std::size_t index = 0; index < header.section_count; ++index) {
    const std::size_t at = table_entry_at(whole_.bytes(), index);
    const auto entry = read_at<SectionEntry>(whole_.bytes(), at);
    const std::size_t fields[] = {at + 8, at + 16};  // offset, bytes
    for (const std::size_t field : fields) {
      const auto value = read_at<std::uint64_t>(whole_.bytes(), field);
      for (const std::uint64_t wrong :
           {value + 1, value - 1, value + 64, value - 64, value ^ (std::uint64_t{1} << 63),
            ~std::uint64_t{0}, ~std::uint64_t{63}, std::uint64_t{0}}) {
        if (wrong == value) continue;
        EXPECT_EQ(refused(with_field(field, wrong).bytes(), Verify::kStructure).code,
                  ErrorCode::kSectionInvalid);
      }
    }
    for (const std::uint32_t id : {0u, entry.id + 1, 999u, ~0u}) {
      EXPECT_EQ(refused(with_field(at, id).bytes(), Verify::kStructure).code,
                ErrorCode::kSectionInvalid);
    }
    for (const std::uint32_t size : {0u, entry.element_bytes + 1, ~0u}) {
      EXPECT_EQ(refused(with_field(at + 4, size).bytes(), Verify::kStructure).code,
                ErrorCode::kSectionInvalid);
    }
  }
  for (const std::uint32_t count :
       {0u, header.section_count - 1, header.section_count + 1, 64u, 65u, ~0u}) {
    refused(with_field(offsetof(FileHeader, section_count), count).bytes(), Verify::kStructure);
  }
  for (const std::uint32_t size : {0u, 64u, header.header_bytes + 64, 4096u, ~0u, ~63u}) {
    refused(with_field(offsetof(FileHeader, header_bytes), size).bytes(), Verify::kStructure);
  }
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedFile, ::testing::ValuesIn(kFormats),
                         [](const auto& tested) {
                           std::string name = tested.param.name;
                           std::erase(name, ' ');
                           return name;
                         });

// Whatever number stands in a header or a table, no memory is asked for that the file does not
// have.
TEST_P(DamagedFile, NoCountAsksForMemory) {
  const auto header = read_at<FileHeader>(whole_.bytes(), 0);
  const std::size_t end = header.header_bytes + header.section_count * sizeof(SectionEntry);
  constexpr std::uint64_t kNumbers[] = {0x7fffffff,         0xffffffff,         0x100000000,
                                        0x7fffffffffffffff, 0xfffffffffffffff8, 0xffffffffffffffff};
  for (std::size_t at = 0; at + 8 <= end; at += 4) {
    for (const std::uint64_t number : kNumbers) {
      const AlignedBytes bytes = with_field(at, number);
      const test::AddressLimit limit(std::uint64_t{16} << 20);
      const Status status = GetParam().open(bytes.bytes(), Verify::kStructureAndChecksums);
      EXPECT_TRUE(status || exit_status(status.error().code) == 4)
          << "byte " << at << ": " << to_line(status.error());
    }
  }
}

TEST(OtherFormat, APshellGivenAsVoxAndTheOtherWayRound) {
  const AlignedBytes shell = golden_file_bytes("v2.pshell");
  const AlignedBytes scene = golden_file_bytes("v2.vox");
  const auto as_scene = Voxmap::from_bytes(shell.bytes(), "part.pshell");
  ASSERT_FALSE(as_scene);
  EXPECT_EQ(as_scene.error().code, ErrorCode::kNotThisFormat);
  EXPECT_NE(as_scene.error().what.find("this is a .pshell"), std::string::npos);
  const auto as_shell = Pshell::from_bytes(scene.bytes(), "scene.vox");
  ASSERT_FALSE(as_shell);
  EXPECT_EQ(as_shell.error().code, ErrorCode::kNotThisFormat);
  EXPECT_NE(as_shell.error().what.find("this is a .vox"), std::string::npos);
}

TEST(OtherFormat, MissingFolderAndEmptyFile) {
  EXPECT_EQ(Voxmap::open("/nowhere/scene.vox").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(Voxmap::open("/").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(Voxmap::open("/dev/null").error().code, ErrorCode::kReadFailed);
  EXPECT_EQ(Voxmap::open("").error().code, ErrorCode::kFileNotFound);
  const auto empty = std::filesystem::temp_directory_path() / "forcelayer_empty.vox";
  std::fclose(std::fopen(empty.c_str(), "w"));
  EXPECT_EQ(Voxmap::open(empty).error().code, ErrorCode::kTruncated);
  EXPECT_EQ(Pshell::open(empty).error().code, ErrorCode::kTruncated);
  std::filesystem::remove(empty);
}

TEST(OtherFormat, UnalignedMemoryIsRefused) {
  AlignedBytes scene = golden_file_bytes("v2.vox");
  std::vector<std::byte> shifted(scene.bytes().size() + 8);
  std::copy(scene.bytes().begin(), scene.bytes().end(), shifted.begin() + 8);
  AlignedBytes moved(shifted);
  EXPECT_FALSE(Voxmap::from_bytes(std::as_const(moved).bytes().subspan(8), "shifted"));
}

}  // namespace
}  // namespace forcelayer::testing
