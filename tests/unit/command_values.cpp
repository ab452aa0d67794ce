// Options of NAME=VALUE pairs, and the options that have another name now.
#include "formats/command/values.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "formats/command/arguments.h"
#include "formats/command/old_options.h"

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
            "lists all");
  EXPECT_EQ(read("trust,,args=x"),
            "--device: 'trust,args' is not a known name; the nearest known name is trust; --help "
            "lists all");
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

TEST(OldOptions, AreErrorsThatNameTheNewSpelling) {
  EXPECT_EQ(new_spelling("voxrun", "--mass"), "--set mass_kg=VALUE");
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
              "voxrun: --mass: is an old spelling; write --set mass_kg=VALUE\n");
    EXPECT_EQ(status, 2);
  }
}

}  // namespace
}  // namespace forcelayer::command
