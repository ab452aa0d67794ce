// The options that say how far a command trusts its mesh files and manifests.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "formats/mesh/mesh.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "formats/result.h"

namespace CLI {
class App;
}

namespace forcelayer::mesh {

using AssemblyReader =
    std::function<Result<Assembly>(const std::string& path, const ReadOptions& options)>;

struct TrustOptions {
  bool sandbox = false;
  std::uint64_t sandbox_memory_bytes = 0;  // 0: not given
  std::string sandbox_time;                // as typed; empty: not given
  bool allow_outside = false;

  void declare(CLI::App& app);

  // read_guarded(), or read_in_sandbox() where the sandbox or a limit of it was asked for. kUsage
  // where the time cannot be parsed.
  Result<AssemblyReader> reader() const;
};

}  // namespace forcelayer::mesh
