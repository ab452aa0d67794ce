// A cut across a world axis.
#pragma once

#include <string_view>

#include "formats/result.h"

namespace forcelayer::viewer {

// Takes away everything beyond `at_m`, on the side of growing (`keep_low`) or falling coordinates,
// and shows the voxels at the cut by value.
struct Cut {
  int axis = 0;     // 0 x, 1 y, 2 z
  double at_m = 0;  // world
  bool keep_low = true;
};

// Reads "z<0.3" or "z<300mm" (the lower side stays) or "x>0". Error: kUsage.
Result<Cut> parse_cut(std::string_view text);

}  // namespace forcelayer::viewer
