// The command line of `forcelayer study`.
#pragma once

#include <string>
#include <vector>

#include "formats/result.h"

namespace CLI {
class App;
}  // namespace CLI

namespace forcelayer::study {

// As typed. Numbers were read, so that a wrong one is refused before the first command runs.
struct Options {
  std::string assembly;  // before "#": the file, or manifest
  std::string node;      // behind it: the part
  std::string voxel_size, clearance, units, up, path, center, pull, time, seat, seat_depth, folder,
      missing_faces, rules;
  std::vector<std::string> allow, without;
  bool searches() const { return path.empty() && pull.empty(); }
  bool no_pictures = false;
  bool files_alone = false;  // the meshes do not settle what the files leave open
  bool sandbox = false;      // meshes are read in processes of their own
  bool plan = false;         // only a first look: which voxel sizes there are, and what they cost
  bool is_auto() const { return voxel_size == "auto"; }
  std::string json;
  bool quiet = false;
  std::vector<std::string> names;  // of all options: "--seat"
};

// Declares the options to CLI11. finish() reads what was parsed.
class OptionParser {
 public:
  explicit OptionParser(CLI::App& study);

  // Errors: kUsage.
  Result<Options> finish() const;

 private:
  Options options_;
  std::string input_;
  unsigned missing_faces_ = 0;
};

}  // namespace forcelayer::study
