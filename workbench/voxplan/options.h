// The command line of voxplan.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/result.h"
#include "runtime/voxcheck/mesh_options.h"

namespace forcelayer::voxplan {

struct Options : voxcheck::MeshOptions {
  std::string scene, part, path;
  Pose world_from_seat;                 // of the part: where it starts
  std::optional<Pose> world_from_goal;  // of the part; none: anywhere outside of the scene
  double clearance_m = 0;
  std::vector<std::string> allow;  // names of objects
  double max_s = 0;
  std::uint64_t seed = 1;
  unsigned threads = 1;
  std::string json;
  bool quiet = false;
};

// Declares the options to CLI11. finish() reads what was parsed.
class OptionParser {
 public:
  explicit OptionParser(CLI::App& app);

  // Errors: kUsage.
  Result<Options> finish() const;

 private:
  Options options_;
  voxcheck::MeshOptionParser meshes_;
  std::string clearance_, seat_, goal_, time_;
};

}  // namespace forcelayer::voxplan
