// The options that name the meshes of the two bakes: --exact, and all that goes with it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"

namespace CLI {
class App;
}  // namespace CLI

namespace forcelayer::voxcheck {

struct MeshOptions {
  std::vector<std::string> meshes, part_meshes, without;
  std::string units, part_units;              // as typed,
  std::optional<double> unit_m, part_unit_m;  // and in meters
  bool allow_outside = false;
  std::string sandbox;                 // as typed; empty: not given
  std::optional<double> seat_depth_m;  // into objects of the seat, deeper than installed
};

class MeshOptionParser {
 public:
  // Declares the options to CLI11; they are read into `options`, which outlives this. `exact_help`
  // describes --exact.
  void declare(CLI::App& app, MeshOptions& options, const std::string& exact_help);

  // Reads units and depth into `options`. Errors: kUsage.
  Status finish(MeshOptions& options) const;

 private:
  std::string seat_depth_;
};

}  // namespace forcelayer::voxcheck
