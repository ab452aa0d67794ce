// The 3D view of the page: the motion that voxcheck wrote, and the scripts that show it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "formats/result.h"

namespace forcelayer::study {

struct View {
  std::string motion;  // GLB file of voxcheck --report animation
  std::string map;     // of --report map, if any: shown instead where all of it fits a page
  std::string curve;   // CSV file of voxcheck
  // Moments that have a button, the worst one first: name, words, along_m, t_s, value_m (the
  // distance) and, where it is known, point_m.
  nlohmann::json moments = nlohmann::json::array();
  nlohmann::json near = nlohmann::json::array();  // names of the objects to point out
};

// Whether the program has the scripts that a view needs.
bool can_show();

// Styles of the view, for the head of the page.
std::string view_style();

// The view, with all that it needs. Objects that are too many for a page are left out, and named.
// Errors: kReadFailed, kFileNotFound.
Result<std::string> view_html(const View& view);

}  // namespace forcelayer::study
