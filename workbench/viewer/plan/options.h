// The command line of voxview.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcelayer/parameters.h"
#include "forcelayer/pose.h"
#include "formats/result.h"
#include "workbench/viewer/plan/items.h"
#include "workbench/viewer/plan/view_scene.h"
#include "workbench/viewer/surface/cut.h"

namespace CLI {
class App;
}

namespace forcelayer::viewer {

enum class Focus { kAuto, kPart, kScene };

// A distance that is drawn, from the part to an object of the scene.
struct Measure {
  glm::dvec3 part_m{0}, object_m{0};  // its ends, world
  std::string object;                 // by name; empty: not known
  std::string words;                  // beside the line
};

struct ViewOptions {
  ViewInputs inputs;
  std::string screenshot, turntable, json, frame_times;
  int width = 1600, height = 1000;  // pixels
  std::optional<double> scale;      // of words and marks; empty: the screen's
  std::string run;                  // trace or recording
  std::optional<double> at_s;
  std::string path;                     // of the part, to draw; empty: none
  std::string listen;                   // [ADDRESS:]PORT of a pose stream
  std::optional<double> duration_s;     // of the window, or of listening before a picture
  std::optional<Pose> world_from_part;  // --part-pose
  std::optional<glm::dvec3> to_eye;
  Focus focus = Focus::kAuto;
  std::optional<int> pixels_per_voxel;
  std::optional<Cut> cut;
  std::optional<ItemSet> shown;
  bool color_objects = false;           // the meshes, each in a color of its own
  std::vector<std::string> hide, only;  // names of objects, as after --without of voxelize
  std::optional<Measure> measure;
  std::vector<std::string> title;  // lines in place of those that say what is shown
  bool plain = false, quiet = false;
};

// Who asks: a user, or another program of this project and its tests (`voxview draw`), which set
// the words, marks and scales of a picture themselves.
enum class Program { kView, kDraw };

// Holds the texts that CLI11 fills in. finish() turns them into ViewOptions and finds
// contradictions.
class ViewOptionParser {
 public:
  ViewOptionParser(CLI::App& app, Program program);

  // Errors: kUsage.
  Result<ViewOptions> finish() const;

 private:
  struct Texts {
    std::string units, part_units, size = "1600x1000", at, duration, part_pose;
    std::string view_from, focus = "auto", cut, shown, color = "one";
    std::string measure, measure_object, measure_words;
    int pixels_per_voxel = 0;
  };
  void add_draw_options(CLI::App& app);
  Status read_units(ViewOptions& options) const;
  Status read_moment(ViewOptions& options) const;
  Status read_camera(ViewOptions& options) const;
  Status read_measure(ViewOptions& options) const;

  ViewOptions options_;
  Texts texts_;
};

}  // namespace forcelayer::viewer
