// The page of a study: all that a reviewer needs, in one file without references.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::study {

// A picture of the page.
struct Picture {
  std::string file, words;
};

struct Page {
  std::string part, assembly;
  bool clear = false;
  std::string word, sentence;   // the verdict
  nlohmann::json verdict;       // report of voxcheck; null where no path was found
  nlohmann::json scene, shell;  // reports of voxelize and pointshell
  std::string curve_svg;
  std::vector<Picture> pictures;
  std::vector<std::string> commands;
  std::vector<std::string> files;  // that stand beside the page
};

// A JUnit file of one test that failed, for a study without a path to check.
std::string junit_of(const std::string& part, const std::string& failure);

// Errors: kReadFailed, kFileNotFound for a picture.
Result<std::string> html_of(const Page& page);

}  // namespace forcelayer::study
