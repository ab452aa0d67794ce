// The writers refuse what the readers would refuse, and leave the old file.
#include <gtest/gtest.h>

#include "formats/pshell_writer.h"
#include "formats/voxmap_writer.h"
#include "tests/support/golden_content.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::testing {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

void expect_refused(const Result<std::uint64_t>& written, const test::ScratchFolder& folder,
                    const std::string& what) {
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kInternal);
  EXPECT_NE(written.error().what.find(what), std::string::npos) << to_line(written.error());
  EXPECT_EQ(text_of(folder / "old"), "old");
  EXPECT_EQ(test::entries_of(folder.path()), 1);
}

TEST(Writers, AVoxmapThatItsReaderWouldRefuseIsNotWritten) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "old") << "old";
  const GoldenDistances golden;
  VoxmapContent content = golden.content();
  content.header.distance_zero_code = 1 << 21;
  expect_refused(write_voxmap(folder / "old", content), folder, "distance_zero_code");
  content = golden.content();
  const std::vector<std::uint32_t> directory{7};  // an upper node that is not there
  content.values.directory = directory;
  expect_refused(write_voxmap(folder / "old", content), folder, "directory");
  EXPECT_TRUE(write_voxmap(folder / "old", golden.content()));
}

TEST(Writers, APshellThatItsReaderWouldRefuseIsNotWritten) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "old") << "old";
  const GoldenPoints golden = golden_points();
  TestShell shell(golden.points, golden.normals, golden_shell_options());
  const PshellHeader sound = shell.header();
  shell.header().inertia_m2[1] = -1e-9;
  expect_refused(write_pshell(folder / "old", shell.content()), folder, "inertia_m2");
  shell.header() = sound;
  shell.header().bounding_radius_m /= 2;
  expect_refused(write_pshell(folder / "old", shell.content()), folder, "bounding radius");
  shell.header() = sound;
  EXPECT_TRUE(write_pshell(folder / "old", shell.content()));
}

}  // namespace
}  // namespace forcelayer::testing
