// The distance that two parts of an assembly must keep.
#pragma once

#include <string>

#include "formats/result.h"

namespace forcelayer::pairs {

// The requirement for a pair of parts.
struct Requirement {
  enum class Kind {
    kTouch,      // they may touch, but not overlap
    kClearance,  // they are `clearance_m` apart or more
    kIgnore,     // anything is allowed
  };
  Kind kind = Kind::kTouch;
  double clearance_m = 0;  // above 0 with kClearance, else 0
};

// "touch", "ignore" or a length such as "1mm"; a length of 0 is the same as touch. Errors: kUsage.
Result<Requirement> parse_requirement(const std::string& text);

}  // namespace forcelayer::pairs
