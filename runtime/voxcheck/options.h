// The command line of voxcheck.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/result.h"

namespace CLI {
class App;
}  // namespace CLI

namespace forcelayer::voxcheck {

struct Options {
  std::string scene, part, path;
  double clearance_m = 0;
  std::optional<Pose> world_from_seat;  // of the part
  std::vector<std::string> allow;       // names of objects
  unsigned threads = 1;
  // The inputs of the two bakes, for --exact and --picture.
  std::vector<std::string> meshes, part_meshes, without;
  std::string units, part_units;              // as typed,
  std::optional<double> unit_m, part_unit_m;  // and in meters
  bool allow_outside = false;
  std::string sandbox;                 // as typed; empty: not given
  bool felt_seat = false;              // where shell points feel nothing the seat is clear
  std::optional<double> seat_depth_m;  // into objects of the seat, deeper than installed
  std::string fail_on;                 // "far", or empty
  std::string picture, json, csv, junit, code_quality;
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
  std::string clearance_, seat_, seat_depth_, reports_;
};

}  // namespace forcelayer::voxcheck
