// A forecast of a bake's time, memory and points.
#pragma once

#include "pointshell/bake.h"
#include "pointshell/part/part.h"

namespace forcelayer::pointshell {

struct BakeCost {
  double points = 0;
  double thread_s = 0;  // of processor time, on a core of 2025
  double seconds = 0;   // on as many threads as the bake has
  double bytes = 0;     // at the peak
};
BakeCost expected_cost(const part::Part& part, const ShellOptions& options);

}  // namespace forcelayer::pointshell
