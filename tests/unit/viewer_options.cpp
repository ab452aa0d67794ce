// The command line of voxview, and the lists and cuts in it.
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "workbench/viewer/plan/options.h"

namespace forcelayer {
namespace {

Result<viewer::ViewOptions> parsed(const std::string& line) {
  CLI::App app{"", "voxview"};
  const viewer::ViewOptionParser parser(app, viewer::Program::kDraw);
  try {
    app.parse(line);
  } catch (const CLI::ParseError& error) {
    return Error{ErrorCode::kUsage, "", "", error.what(), ""};
  }
  return parser.finish();
}

TEST(ViewOptions, ReadsAPictureOfARun) {
  const auto options = parsed(
      "bay.json bay.vox part.pshell --trace run.csv --at 2500ms --size 640x480 "
      "--units mm --view-from 1,2,3 --focus scene --cut y>-5mm --show meshes,shell");
  ASSERT_TRUE(options) << to_line(options.error());
  EXPECT_EQ(options->inputs.inputs.size(), 3u);
  EXPECT_EQ(options->run, "run.csv");
  EXPECT_EQ(options->at_s, 2.5);
  EXPECT_EQ(options->width, 640);
  EXPECT_EQ(options->height, 480);
  EXPECT_EQ(options->inputs.unit_m, 0.001);
  EXPECT_EQ(options->to_eye, glm::dvec3(1, 2, 3));
  EXPECT_EQ(options->focus, viewer::Focus::kScene);
  EXPECT_EQ(options->cut->axis, 1);
  EXPECT_EQ(options->cut->at_m, -0.005);
  EXPECT_FALSE(options->cut->keep_low);
  EXPECT_TRUE((*options->shown)[viewer::Item::kMeshes]);
  EXPECT_TRUE((*options->shown)[viewer::Item::kShell]);
  EXPECT_FALSE((*options->shown)[viewer::Item::kForceLayer]);
}

TEST(ViewOptions, RefusesWhatMakesNoSense) {
  for (const char* line : {"",
                           "a.vox --size 1600",
                           "a.vox --size 1600x",
                           "a.vox --size 9000x100",
                           "a.vox --size 100x100x100",
                           "a.vox --at 2s",
                           "a.vox --trace t.csv --at 2",
                           "a.vox --trace t.csv --part-pose 0,0,0",
                           "a.vox --part-pose 0,0",
                           "a.vox --cut z",
                           "a.vox --cut w<1mm",
                           "a.vox --cut z=1mm",
                           "a.vox --cut z<",
                           "a.vox --show",
                           "a.vox --show meshes,",
                           "a.vox --show none",
                           "a.vox --view-from 0,0,0",
                           "a.vox --pixels-per-voxel -1",
                           "a.vox --units parsec",
                           "a.vox --json x.json",
                           "a.vox --focus sky"}) {
    const auto options = parsed(line);
    ASSERT_FALSE(options) << line;
    EXPECT_EQ(options.error().code, ErrorCode::kUsage) << line;
  }
}

TEST(ViewOptions, ANumberThatIsNoneIsRefusedByName) {
  const struct {
    const char* line;
    const char* option;
  } cases[] = {{"a.vox --part-pose nan,0,0", "--part-pose"},
               {"a.vox --part-pose 1e300m,0,0", "--part-pose"},
               {"a.vox --trace t.csv --at nans", "--at"},
               {"a.vox --listen 9000 --duration 1e300s", "--duration"},
               {"a.vox --view-from nan,0,1", "--view-from"}};
  for (const auto& c : cases) {
    const auto options = parsed(c.line);
    ASSERT_FALSE(options) << c.line;
    EXPECT_EQ(options.error().where, c.option) << to_line(options.error());
  }
}

}  // namespace
}  // namespace forcelayer
