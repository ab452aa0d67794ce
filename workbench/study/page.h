// The page of a study: all that a reviewer needs, in one file without references.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/command/verdict/verdict.h"
#include "formats/result.h"

namespace forcelayer::study {

// A picture of the page.
struct Picture {
  std::string file, words;
};

struct Page {
  std::string part, assembly;
  command::VerdictKind kind = command::VerdictKind::kUndecided;
  std::string heading;          // the first words of the sentence
  std::string text;             // the sentence and the lines that follow it
  nlohmann::json report;        // of voxcheck; null where no path was found
  nlohmann::json scene, shell;  // reports of voxelize and pointshell
  std::string curve_svg;
  std::string curve, motion, map;  // files of voxcheck; no motion and map without meshes
  std::vector<Picture> pictures;
  std::vector<std::string> commands;
  std::vector<std::string> files;  // that stand beside the page
};

// Errors: kReadFailed, kFileNotFound for a picture.
Result<std::string> html_of(const Page& page);

}  // namespace forcelayer::study
