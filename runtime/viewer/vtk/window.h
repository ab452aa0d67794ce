// The window: a scene that is turned, a run that is played or followed.
#pragma once

#include <optional>
#include <vector>

#include "forcelayer/pose_receiver.h"
#include "formats/result.h"
#include "runtime/viewer/options.h"
#include "runtime/viewer/picture_plan.h"
#include "runtime/viewer/run/trace.h"
#include "runtime/viewer/view_scene.h"

namespace forcelayer {

// What moves the part: rows of a finished run, a stream, or neither.
struct RunFeed {
  std::vector<TraceRow> rows;
  std::optional<PoseReceiver> receiver;
};

// Shows the window until it is closed, or for options.duration_s. `plan` is what it shows first.
Status show_window(const ViewScene& scene, const ViewOptions& options, const PicturePlan& plan,
                   RunFeed feed);

}  // namespace forcelayer
