// The window: a scene that is turned, a run that is played or followed.
#pragma once

#include <optional>
#include <vector>

#include "forcelayer/pose_receiver.h"
#include "formats/result.h"
#include "workbench/viewer/plan/options.h"
#include "workbench/viewer/plan/picture_plan.h"
#include "workbench/viewer/plan/view_scene.h"
#include "workbench/viewer/run/trace.h"

namespace forcelayer::viewer {

// The source of the part's poses: rows of a finished run, a stream, or neither.
struct RunFeed {
  std::vector<TraceRow> rows;
  std::optional<PoseReceiver> receiver;
};

// Shows the window until it is closed, or for options.duration_s. It begins with `plan`.
Status show_window(const ViewScene& scene, const ViewOptions& options, const PicturePlan& plan,
                   RunFeed feed);

}  // namespace forcelayer::viewer
