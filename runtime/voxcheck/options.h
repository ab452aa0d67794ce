// The command line of voxcheck.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/result.h"
#include "runtime/voxcheck/mesh_options.h"
#include "runtime/voxcheck/path_source.h"

namespace forcelayer::voxcheck {

struct Options : MeshOptions, PathSource {
  double clearance_m = 0;
  std::optional<Pose> world_from_seat;  // of the part
  std::vector<std::string> allow;       // names of objects
  std::string rules;                    // a file of clearances between parts; empty: none
  unsigned threads = 1;
  bool felt_seat = false;       // where shell points feel nothing the seat is clear
  std::string fail_on;          // "far", "nothing" or empty
  std::optional<double> max_s;  // for the meshes
  std::string animation, map, picture, json, csv, junit, code_quality;
  bool github = false, quiet = false;
};

// Declares the options to CLI11. finish() reads what was parsed.
class OptionParser {
 public:
  explicit OptionParser(CLI::App& app);

  // Errors: kUsage.
  Result<Options> finish() const;

  // Texts as typed, of what was parsed so far.
  const Options& typed() const { return options_; }

 private:
  Options options_;
  MeshOptionParser meshes_;
  std::string clearance_, center_, seat_, time_, reports_;
};

}  // namespace forcelayer::voxcheck
