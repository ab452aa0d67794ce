// A command destroys none of its inputs, and no file of another kind.
#include "formats/command/output_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/scratch_folder.h"

namespace forcelayer::command {
namespace {

namespace fs = std::filesystem;

class OutputFiles : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& bytes) {
    const std::string path = at(name);
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  // The error's line; empty where the output may be written.
  static std::string refusal(std::string path, FileKind kind,
                             const std::vector<std::string>& inputs = {}) {
    const OutputFile output[] = {{"--output", &path, kind}};
    const Status status = prepare_outputs(output, inputs);
    if (status) return "";
    EXPECT_EQ(status.error().code, ErrorCode::kUsage);
    return to_line(status.error());
  }

  static bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  }

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  test::ScratchFolder folder_;
};

TEST_F(OutputFiles, NoInputIsReplacedByAnyNameOfIt) {
  const std::string mesh = file("skin.mesh", "solid");
  const std::string link = at("link.mesh"), hard = at("hard.mesh");
  fs::create_symlink(mesh, link);
  fs::create_hard_link(mesh, hard);
  const std::string detour = at("x") + "/../skin.mesh";
  fs::create_directory(at("x"));
  for (const std::string& name : {mesh, link, hard, detour}) {
    EXPECT_TRUE(holds(refusal(name, FileKind::kReport, {mesh}), "is an input")) << name;
    EXPECT_TRUE(holds(refusal(mesh, FileKind::kReport, {name}), "is an input")) << name;
    EXPECT_TRUE(holds(refusal(name, FileKind::kReport, {mesh + "#Node/Sub"}), "is an input"));
  }
  EXPECT_EQ(refusal(at("other.mesh"), FileKind::kReport, {mesh}), "");
  EXPECT_TRUE(holds(refusal(mesh, FileKind::kReport, {"", mesh}), "choose another name"));
}

TEST_F(OutputFiles, AnEndingOfAnotherKindIsRefused) {
  for (const char* name : {"a.stl", "a.STEP", "a.glb", "a.json", "a.csv", "a.pshell", "a.bin"}) {
    EXPECT_TRUE(holds(refusal(at(name), FileKind::kVoxmap), "ends in .vox")) << name;
  }
  EXPECT_TRUE(holds(refusal(at("a.vox"), FileKind::kPshell), "ends in .pshell"));
  EXPECT_TRUE(holds(refusal(at("a.vox"), FileKind::kReport), "ends in .json"));
  EXPECT_TRUE(holds(refusal(at("a.json"), FileKind::kTable), "ends in .csv"));
  for (const char* name : {"a.vox", "a.VOX", "a", "a.old", "a.v1.0"}) {
    EXPECT_EQ(refusal(at(name), FileKind::kVoxmap), "") << name;
  }
  for (const char* name : {"a.csv", "a.ply", "a.vdb", "a.stl"}) {
    EXPECT_EQ(refusal(at(name), FileKind::kExport), "") << name;
  }
}

TEST_F(OutputFiles, AFileOfAnotherKindIsNotReplaced) {
  const std::string voxmap = "\211FLV\r\n\032\n...", shell = "\211FLP\r\n\032\n...";
  EXPECT_EQ(refusal(file("old.vox", voxmap), FileKind::kVoxmap), "");
  EXPECT_EQ(refusal(file("empty.vox", ""), FileKind::kVoxmap), "");
  EXPECT_EQ(refusal(file("old.txt", "{}"), FileKind::kReport), "");
  const std::string wrong[][2] = {{"magica.vox", "VOX \226"}, {"shell.vox", shell}};
  for (const auto& [name, bytes] : wrong) {
    const std::string text = refusal(file(name, bytes), FileKind::kVoxmap);
    EXPECT_TRUE(holds(text, "is there already, and is not a voxmap; choose another name")) << text;
  }
  EXPECT_TRUE(holds(refusal(file("map", voxmap), FileKind::kReport), "is not a report"));
  EXPECT_TRUE(holds(refusal(file("cube", "glTF"), FileKind::kTable), "is not a table"));
}

TEST_F(OutputFiles, TwoOutputsNeedTwoNames) {
  std::string report = at("same"), trace = report;
  const OutputFile outputs[] = {{"--json", &report, FileKind::kReport},
                                {"--trace", &trace, FileKind::kTable}};
  const Status status = prepare_outputs(outputs, {});
  ASSERT_FALSE(status);
  EXPECT_EQ(to_line(status.error()),
            trace + ": --trace: is what --json writes too; give each a name of its own");
  report = trace = "-";
  EXPECT_FALSE(prepare_outputs(outputs, {}));
  report = trace = "/dev/null";
  EXPECT_TRUE(prepare_outputs(outputs, {}));
  trace.clear();
  EXPECT_TRUE(prepare_outputs(outputs, {}));
}

TEST_F(OutputFiles, ADeviceMayBeAnInputToo) {
  EXPECT_EQ(refusal("/dev/null", FileKind::kVoxmap, {"/dev/null"}), "");
}

}  // namespace
}  // namespace forcelayer::command
