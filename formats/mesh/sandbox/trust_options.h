// The options that say how far a command trusts its mesh files and manifests.
#pragma once

#include <string>

#include "formats/mesh/mesh.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "formats/result.h"

namespace CLI {
class App;
}

namespace forcelayer::mesh {

struct TrustOptions {
  std::string sandbox;  // as typed behind --sandbox=; "true": without limits; empty: not given
  bool allow_outside = false;

  void declare(CLI::App& app);

  // read_guarded(), or read_in_sandbox() where the sandbox was asked for. kUsage where its limits
  // cannot be parsed.
  Result<AssemblyReader> reader() const;
};

}  // namespace forcelayer::mesh
