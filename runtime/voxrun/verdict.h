// The verdict of a run: the last line of its report, and --fail-on.
#pragma once

#include <optional>
#include <string>

#include "formats/command/verdict/verdict.h"
#include "runtime/loop/loop_statistics.h"
#include "runtime/voxrun/motion_watch.h"
#include "runtime/voxrun/options.h"
#include "runtime/voxrun/scenes.h"

namespace forcelayer::voxrun {

// A pull that was carried out to its end.
struct Pull {
  double led_m = 0;   // displacement of the hand
  double went_m = 0;  // of the part along that, by its center
  bool short_of_end() const;
};

// The outcome of a run, beside its statistics.
struct Outcome {
  std::optional<Pull> pull;        // none without one, or where it was not carried out
  std::optional<Followed> motion;  // of --motion and --pull
  bool scene_missed = false;       // of --scene-next
};

// The objects of the part's seat, escaped, the first few by name; empty without a seat. An overlap
// of more than `min_overlap_m` is said.
std::string seat_text(const Scenes& scenes, double min_overlap_m);

// The verdict of a run, which checks no clearance that was asked for. --fail-on says which answers
// end with status 6.
command::Verdict verdict_of(const Scenes& scenes, const Outcome& outcome,
                            const loop::LoopStatistics& statistics);

// `proven`, `penetrated` (a penetration frame), `seated` (the seat was not left), `held` (off its
// motion, or short of the end of its pull), or `unknown` (a premise failed, a scene was missed, a
// pull was not followed although nothing blocks the part, or no frame was run).
const char* run_word(const command::Verdict& verdict);

// Its sentence, and the same with figures, times and names: two lines, escaped.
std::string verdict_text(const Scenes& scenes, const Outcome& outcome,
                         const loop::LoopStatistics& statistics);

// An error where the run did what --fail-on names, or where the part comes out, but not without
// force. Errors: kAnswerIsNo, kNeedsForce.
Status check_verdict(const Options& options, const Scenes& scenes, const Outcome& outcome,
                     const loop::LoopStatistics& statistics);

}  // namespace forcelayer::voxrun
