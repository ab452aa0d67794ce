// The command line of voxrun.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "formats/result.h"
#include "runtime/parameters.h"
#include "runtime/pose.h"

namespace CLI {
class App;
}

namespace forcelayer::voxrun {

struct Options {
  std::string scene, part;
  std::string device = "sim";
  std::optional<double> duration_s;
  double rate_hz = 1000;
  unsigned threads = 1;  // of the contact query
  Model model = kDefaultModel;
  std::optional<ForceKind> force;  // none: the model's own
  bool braking = true;
  bool as_fast_as_possible = false;
  bool without_guarantee = false;
  bool quiet = false;
  std::string motion, json, trace, record, replay, udp;
  std::optional<Pose> world_from_part;   // --start
  std::optional<Pose> handle_from_part;  // --grip
  Pose world_from_device;
  double motion_scale = 1;
  std::map<std::string, double> settings;  // parameters by ParameterInfo::name
};

// What CLI11 fills in; finish() turns it into Options and finds what contradicts itself.
class OptionParser {
 public:
  explicit OptionParser(CLI::App& app);

  // Errors: kUsage.
  Result<Options> finish() const;

 private:
  struct Texts {
    std::string duration, model, force, start, grip, world_from_device;
    bool no_braking = false;
  };
  Status read_texts(Options& options) const;
  Status check(const Options& options) const;

  CLI::App& app_;
  Options options_;
  Texts texts_;
  std::map<std::string, double> settings_;  // by option
};

}  // namespace forcelayer::voxrun
