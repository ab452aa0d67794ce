// A study: does a part come out of an assembly, and how near does it come to what?
#pragma once

#include "formats/result.h"
#include "workbench/study/options.h"

namespace forcelayer::study {

// Bakes, runs or takes the path, checks, draws and writes the page. Errors: kAnswerIsNo where the
// path is not clear or the part does not come out; kWriteFailed where another study writes to the
// folder; those of the commands that it calls, by their
// status.
Status make_study(const Options& options);

}  // namespace forcelayer::study
