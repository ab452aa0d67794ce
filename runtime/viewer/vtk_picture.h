// A picture into a PNG file, without a window.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"
#include "runtime/viewer/camera.h"
#include "runtime/viewer/contact_view.h"
#include "runtime/viewer/view_scene.h"
#include "runtime/viewer/vtk_stage.h"

namespace forcelayer {

// The part at one moment.
struct Moment {
  Pose world_from_part;
  std::optional<Pose> world_from_target;  // where the hand wants it
  std::optional<Wrench> on_hand;
  ContactView contacts;  // empty without a voxmap or a shell
};

struct PictureOptions {
  int width = 1600, height = 1000;  // pixels
  ShownSet shown{};
  bool plain = false;  // no words, no light, no transparency: flat colours for measuring
  CameraView camera;
  std::vector<std::string> title;
};

// Renders and writes the file atomically. Errors: kWriteFailed, kDeviceFailed (no OpenGL).
Status write_picture(const std::filesystem::path& path, const ViewScene& scene,
                     const std::optional<Moment>& moment, const PictureOptions& options);

}  // namespace forcelayer
