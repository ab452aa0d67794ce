// A command destroys none of its inputs, and no file of another kind.
#include "formats/command/output_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "formats/file/named_file.h"
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

// Whichever "#" of an input stands before the node.
TEST_F(OutputFiles, AnInputIsTheFileBeforeTheFirstSignThatEndsAFile) {
  const std::string mesh = file("odd#1.mesh", "solid");
  EXPECT_TRUE(holds(refusal(mesh, FileKind::kReport, {mesh + "#pin#3"}), "is an input"));
  EXPECT_EQ(named_file(mesh + "#pin#3").path, mesh);
  EXPECT_EQ(named_file(mesh + "#pin#3").nodes, std::vector<std::string>{"pin#3"});
  EXPECT_TRUE(named_file(mesh).nodes.empty());
  EXPECT_EQ(named_file(mesh + "#").nodes, std::vector<std::string>{""});
  EXPECT_EQ(named_file(at("none#1.mesh#pin")).path, at("none#1.mesh"));
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
  EXPECT_EQ(refusal(file("old.txt", "{\n  \"schema_version\": 1,\n"), FileKind::kReport), "");
  const std::string wrong[][2] = {{"magica.vox", "VOX \226"}, {"shell.vox", shell}};
  for (const auto& [name, bytes] : wrong) {
    const std::string text = refusal(file(name, bytes), FileKind::kVoxmap);
    EXPECT_TRUE(holds(text, "already exists and is not a voxmap that Forcelayer wrote; choose"))
        << text;
  }
  EXPECT_TRUE(holds(refusal(file("map", voxmap), FileKind::kReport), "is not a report"));
  EXPECT_TRUE(holds(refusal(file("cube", "glTF"), FileKind::kTable), "is not a table"));
}

// Text is known by its beginning, too: the work of a day may have the same ending.
TEST_F(OutputFiles, OnlyAFileThatACommandWroteIsReplaced) {
  const std::pair<FileKind, std::string> written[] = {
      {FileKind::kReport, "[]\n"},
      {FileKind::kReport, "[\n  {\n    \"description\": \"\""},
      {FileKind::kTable, "t_s,handle_x_m,handle_y_m\n"},
      {FileKind::kTable, "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n"},
      {FileKind::kTable, "from_s,to_s,clearance_m,from_m,to_m\n"},
      {FileKind::kAnimation, std::string("glTF\2\0\0\0....size....", 20) +
                                 R"({"asset":{"version":"2.0","generator":"Forcelayer 1.0"}})"},
      {FileKind::kExport, "i,j,k,value\n"},
      {FileKind::kExport, std::string(" BDV\0\0\0\0\xe0", 9)},
      {FileKind::kExport,
       "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"voxcheck\" tests=\"1\""}};
  for (const auto& [kind, bytes] : written) {
    EXPECT_EQ(refusal(file("ours", bytes), kind), "") << bytes;
    const std::string first_byte_off = "#" + bytes;
    EXPECT_TRUE(holds(refusal(file("ours", first_byte_off), kind), "that Forcelayer wrote"));
  }
  for (const FileKind kind :
       {FileKind::kVoxmap, FileKind::kPshell, FileKind::kReport, FileKind::kTable,
        FileKind::kRecording, FileKind::kAnimation, FileKind::kExport}) {
    for (const char* bytes : {"# my path, a day of work\nt_s,x_m,y_m,z_m\n", "v 0 0 0\n", "{}\n",
                              "ply\nformat ascii 1.0\n", "<?xml version=\"1.0\"?>", "glTF",
                              "glTF....size........{\"asset\":{\"version\":\"2.0\"}}", " "}) {
      EXPECT_TRUE(holds(refusal(file("mine", bytes), kind), "already exists")) << bytes;
    }
    EXPECT_EQ(refusal(file("mine", ""), kind), "");
  }
}

TEST_F(OutputFiles, TwoOutputsNeedTwoNames) {
  std::string report = at("same"), trace = report;
  const OutputFile outputs[] = {{"--json", &report, FileKind::kReport},
                                {"--trace", &trace, FileKind::kTable}};
  const Status status = prepare_outputs(outputs, {});
  ASSERT_FALSE(status);
  EXPECT_EQ(to_line(status.error()),
            trace + ": --trace: is also the output of --json; use two different names");
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

// Before the work, and by the words of the writer. Nothing that can be written to is refused.
TEST_F(OutputFiles, AnOutputThatCannotBeWrittenIsRefused) {
  const auto refused = [](std::string path) {
    const OutputFile output[] = {{"--json", &path, FileKind::kReport}};
    const Status status = prepare_outputs(output, {});
    if (status) return std::string();
    EXPECT_EQ(status.error().code, ErrorCode::kWriteFailed);
    return to_line(status.error());
  };
  const std::string lost = at("none") + "/a.json", below = file("file", "x") + "/a.json";
  EXPECT_EQ(refused(lost),
            lost + ": cannot be written: No such file or directory; create the folder first");
  EXPECT_EQ(refused(below), below + ": cannot be written: Not a directory");
  fs::create_directory(at("folder"));
  EXPECT_TRUE(holds(refused(at("folder")), "Is a directory"));
  EXPECT_TRUE(holds(refused(at(std::string(300, 'x'))), "File name too long"));

  const std::string pipe = at("pipe");  // that nobody reads yet: opening it would wait
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const std::string read_only = file("old.json", ""), dangling = at("link.json");
  fs::permissions(read_only, fs::perms::owner_read);
  fs::create_symlink(at("target.json"), dangling);
  for (const std::string& path : {std::string("/dev/null"), std::string("/dev/full"),
                                  std::string("/dev/stdout"), pipe, read_only, dangling}) {
    EXPECT_EQ(refused(path), "") << path;
  }
  EXPECT_EQ(test::entries_of(folder_.path()), 5);  // as before: nothing is left
  EXPECT_FALSE(fs::exists(at("target.json")));
}

// A reader that waits at a pipe does not take the look at it for the end.
TEST_F(OutputFiles, APipeIsNotOpenedBeforeItIsWrittenTo) {
  std::string pipe = at("pipe");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_GE(reader, 0);
  const OutputFile output[] = {{"--json", &pipe, FileKind::kReport}};
  EXPECT_TRUE(prepare_outputs(output, {}));
  pollfd at_end{reader, POLLIN, 0};
  ::poll(&at_end, 1, 0);
  EXPECT_EQ(at_end.revents & POLLHUP, 0);
  ::close(reader);
}

}  // namespace
}  // namespace forcelayer::command
