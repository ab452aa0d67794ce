// The plan of a picture: its contents and its camera, before anything is drawn.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"
#include "workbench/viewer/plan/camera.h"
#include "workbench/viewer/plan/options.h"
#include "workbench/viewer/plan/view_scene.h"
#include "workbench/viewer/run/moment.h"
#include "workbench/viewer/surface/layer_change.h"

namespace forcelayer::viewer {

struct PicturePlan {
  int width = 0, height = 0;  // pixels
  double scale = 1;           // of words and marks
  std::vector<std::string> title;
  bool own_title = false;  // the user's: nothing else is said of the moment
  CameraView camera;
  ItemSet shown;
  std::optional<Cut> cut;
  std::optional<Moment> moment;
  std::optional<LayerChange> change;  // of the force layer
  bool color_objects = false;         // the meshes of the scene
  std::vector<std::string> hidden;    // objects, by name
  std::optional<Measure> measure;
  std::vector<glm::dvec3> path_m;  // of the part's middle
  bool plain = false;

  double meters_per_pixel() const { return 2 * camera.half_height_m / height; }
};

inline constexpr double kPartFocus = 2.2;  // half of a picture's height, in radii of the part

// The scene's box, or the part's at its own origin where there is nothing else.
WorldBox box_of(const ViewScene& scene);

// Computes the moment, its contacts, the change and the camera that `options` ask for; `rows` are
// those of options.run, if there is one.
Result<PicturePlan> plan_picture(const ViewOptions& options, const ViewScene& scene,
                                 const std::vector<TraceRow>& rows);

// Sets the moment of `plan`, of a run of these rows, with its contacts, words and camera.
Status add_moment(const ViewOptions& options, const ViewScene& scene,
                  const std::vector<TraceRow>& rows, Moment moment, PicturePlan& plan);

// Cameras that go once about z, from the plan's own, none of which cuts off a scene that is shown
// whole.
std::vector<CameraView> turntable_of(const PicturePlan& plan, const ViewScene& scene, int cameras);

// The contacts of `scene`, which must have both a voxmap and a shell, in a run of these rows, or at
// the pose that `options` give: with the seat that voxrun would find at its start.
Result<std::unique_ptr<ContactViewSource>> make_contact_source(const ViewOptions& options,
                                                               const ViewScene& scene,
                                                               const std::vector<TraceRow>& rows);

// One line on the files that are shown.
std::string describe(const ViewScene& scene);

// The plan in numbers, for scripts.
nlohmann::ordered_json report_of(const PicturePlan& plan, const ViewScene& scene);

}  // namespace forcelayer::viewer
