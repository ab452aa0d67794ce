// A picture into a PNG file, without a window.
#pragma once

#include <filesystem>

#include "formats/result.h"
#include "workbench/viewer/plan/picture_plan.h"
#include "workbench/viewer/plan/view_scene.h"

namespace forcelayer::viewer {

// Renders and writes the file atomically. Errors: kWriteFailed.
Status write_picture(const std::filesystem::path& path, const ViewScene& scene,
                     const PicturePlan& plan);

// Writes an animated PNG in which the eye goes once about z, from where the plan has it.
Status write_turntable(const std::filesystem::path& path, const ViewScene& scene,
                       const PicturePlan& plan);

}  // namespace forcelayer::viewer
