// Reading mesh files of others in a process of its own, so that what crashes, hangs or eats memory
// in a reader (Draco, OpenMesh, OpenCASCADE or ours) is an error about that file.
//
// The child runs the same program anew, not a copy of its threads and memory. It has no terminal,
// no descriptors but its pipe, makes no files, and dies with its parent. It keeps the user's
// rights: it is a fence against accidents, and no jail for a reader that was taken over.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer {

struct SandboxLimits {
  std::uint64_t memory_bytes = std::uint64_t{8} << 30;  // address space of a child
  double time_s = 300;                                  // for one file, by the clock
};

// To be called first in main(). In a child that read_in_sandbox() started it reads the file and
// gives the exit status to end with; else nothing.
std::optional<int> run_as_sandbox(int argc, char** argv);

// read_assembly() in a child. A child that is killed, ends early, exceeds a limit or sends nonsense
// is kMeshUnreadable, with the file and the reason. kInternal where no child can be started, or
// where main() does not call run_as_sandbox().
Result<Assembly> read_in_sandbox(const std::string& path, const ReadOptions& options,
                                 const SandboxLimits& limits);

}  // namespace forcelayer
