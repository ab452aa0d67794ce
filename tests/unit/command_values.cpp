// Options of NAME=VALUE pairs, and the options that have another name now.
#include "formats/command/values.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "formats/command/arguments.h"
#include "formats/command/spelling/old_options.h"

namespace forcelayer::command {
namespace {

// "library[VALUE] args[VALUE] trust number" of what was read, or the error.
std::string read(std::string_view text) {
  std::string library, args;
  double number = -1;
  bool trust = false;
  const ValueName names[] = {{.name = "library", .text = &library},
                             {.name = "args", .text = &args},
                             {.name = "trust", .is_given = &trust},
                             {.name = "speed", .number = &number, .bounds = {0.5, 2}}};
  if (Status done = read_values("--device", text, names); !done) return to_line(done.error());
  std::string all = "library[" + library + "] args[" + args + "]" + (trust ? " trust" : "");
  if (number >= 0) all += " " + std::to_string(number);
  return all;
}

TEST(Values, AreRead) {
  EXPECT_EQ(read(""), "library[] args[]");
  EXPECT_EQ(read("trust"), "library[] args[] trust");
  EXPECT_EQ(read("library=/a:b.so,trust,args=log=x y,speed=0.5"),
            "library[/a:b.so] args[log=x y] trust 0.500000");
  EXPECT_EQ(read("trust,"), "library[] args[] trust");
}

TEST(Values, HoldCommasThatAreWrittenTwice) {
  EXPECT_EQ(read("library=a,,b,trust"), "library[a,b] args[] trust");
  EXPECT_EQ(read("args=,,,,,trust"), "library[] args[,,] trust");
  EXPECT_EQ(read("library=a,,"), "library[a,] args[]");
}

TEST(Values, WrongNamesHaveTheNearest) {
  EXPECT_EQ(read("libary=x"),
            "--device: 'libary' is not a known name; the nearest known name is library; --help "
            "lists all names");
  EXPECT_EQ(read("trust,,args=x"),
            "--device: 'trust,args' is not a known name; the nearest known name is trust; --help "
            "lists all names");
  EXPECT_EQ(read(",trust").find("--device: '' is not a known name"), 0u);
  EXPECT_EQ(to_line(read_values("--device", "id=x", {}).error()),
            "--device: 'id' is not a known name; leave it out");
}

TEST(Values, NeedTheirValueOnce) {
  EXPECT_EQ(read("library"), "--device: 'library' needs a value; write library=VALUE");
  EXPECT_EQ(read("library="), "--device: 'library' needs a value; write library=VALUE");
  EXPECT_EQ(read("trust=1"), "--device: 'trust' takes no value; write it without =");
  EXPECT_EQ(read("trust="), "--device: 'trust' takes no value; write it without =");
  EXPECT_EQ(read("trust,trust"), "--device: 'trust' is given more than once; give it once");
  EXPECT_EQ(read("speed=1,speed=2"), "--device: 'speed' is given more than once; give it once");
}

TEST(Values, AreNumbersWithinTheirBounds) {
  EXPECT_EQ(read("speed=2"), "library[] args[] 2.000000");
  EXPECT_EQ(read("speed=2.5").find("--device speed: '2.5' is outside"), 0u);
  EXPECT_EQ(read("speed=0.4").find("--device speed: '0.4' is outside"), 0u);
  EXPECT_EQ(read("speed=nan").find("--device speed: 'nan' is not a finite number"), 0u);
  EXPECT_EQ(read("speed=1m").find("--device speed: "), 0u);
}

TEST(Flags, MayHaveAValueBehindAnEqualsSign) {
  const auto sandbox_of = [](std::vector<std::string> typed) {
    auto app = make_app("Bakes", "voxelize", "");
    std::string sandbox, mesh;
    add_flag(*app, "--sandbox", sandbox, "a process of its own");
    add_required(*app, "mesh", mesh, "the mesh");
    typed.insert(typed.begin(), "voxelize");
    std::vector<char*> argv;
    for (std::string& word : typed) argv.push_back(word.data());
    int status = 0;
    EXPECT_TRUE(parse_arguments(*app, static_cast<int>(argv.size()), argv.data(), status));
    EXPECT_EQ(mesh, "a.stl");
    return sandbox;
  };
  EXPECT_EQ(sandbox_of({"a.stl"}), "");
  EXPECT_EQ(sandbox_of({"--sandbox", "a.stl"}), "true");
  EXPECT_EQ(sandbox_of({"--sandbox=memory=2GiB,time=30s", "a.stl"}), "memory=2GiB,time=30s");
  EXPECT_EQ(sandbox_of({"--sandbox", "--sandbox=time=1s", "a.stl"}), "time=1s");
}

TEST(Bytes, HaveUnitsAndBounds) {
  EXPECT_EQ(*parse_bytes("2GiB", 1, std::uint64_t{1} << 40), std::uint64_t{2} << 30);
  EXPECT_EQ(*parse_bytes("256", 256, 1024), 256u);
  EXPECT_EQ(*parse_bytes("1KiB", 256, 1024), 1024u);
  for (const char* const wrong : {"255", "1025", "2KiB", "-1", "x", "", "1.5.2", "1e300GiB"}) {
    EXPECT_FALSE(parse_bytes(wrong, 256, 1024)) << wrong;
  }
}

// "csv[FILE] github" of what was read, or the error.
std::string reports(std::string_view text) {
  std::string csv;
  bool github = false;
  const ValueName kinds[] = {{.name = "csv", .text = &csv},
                             {.name = "github", .is_given = &github}};
  if (Status done = read_reports(text, kinds); !done) return to_line(done.error());
  return "csv[" + csv + "]" + (github ? " github" : "");
}

TEST(Reports, AreKindsWithTheirFiles) {
  EXPECT_EQ(reports(""), "csv[]");
  EXPECT_EQ(reports("github\ncsv:a,b:c.csv"), "csv[a,b:c.csv] github");
  EXPECT_EQ(reports("csv:-"), "csv[-]");
  EXPECT_EQ(reports("cvs:a"), "--report: 'cvs' is not a kind of report; known kinds: csv, github");
  EXPECT_EQ(reports("csv"), "--report: 'csv' needs a file; write csv:FILE once");
  EXPECT_EQ(reports("csv:"), "--report: 'csv' needs a file; write csv:FILE once");
  EXPECT_EQ(reports("csv:a\ncsv:a"),
            "--report: 'csv' is given more than once; write csv:FILE once");
  EXPECT_EQ(reports("github:a"),
            "--report: 'github' takes no file, because this report is printed; write github alone");
}

// A new spelling that is an option itself would be refused.
TEST(OldOptions, AreNotAmongTheNewOnes) {
  for (const char* const command : {"voxrun", "voxcheck", "voxelize", "pointshell", "voxplan"}) {
    for (const char* const option : {"--set", "--device", "--udp", "--report", "--sandbox",
                                     "--kind", "--method", "--replay"}) {
      EXPECT_EQ(new_spelling(command, option), "") << command << ' ' << option;
    }
  }
}

TEST(OldOptions, AreErrorsThatNameTheNewSpelling) {
  EXPECT_EQ(new_spelling("voxrun", "--mass"), "--set mass_kg=VALUE");
  EXPECT_EQ(new_spelling("voxview", "--focus"), "voxview draw ... --focus");
  EXPECT_EQ(new_spelling("voxelize", "--mass"), "");
  EXPECT_EQ(new_spelling("voxrun", "--mas"), "");
  for (const std::string old : {"--mass", "--mass=5"}) {
    auto app = make_app("Runs", "voxrun", "");
    std::string scene;
    add_required(*app, "scene", scene, "the scene");
    std::string typed[] = {"voxrun", old, "a.vox", "7"};
    char* argv[] = {typed[0].data(), typed[1].data(), typed[2].data(), typed[3].data()};
    int status = 0;
    testing::internal::CaptureStderr();
    EXPECT_FALSE(parse_arguments(*app, 4, argv, status));
    EXPECT_EQ(testing::internal::GetCapturedStderr(),
              "voxrun: --mass: is an option of an earlier version; write --set mass_kg=VALUE\n");
    EXPECT_EQ(status, 2);
  }
}

}  // namespace
}  // namespace forcelayer::command
