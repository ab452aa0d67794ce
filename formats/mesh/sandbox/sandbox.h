// Reading a mesh file in a process of its own. A crash, a hang or too much memory in a reader
// (Draco, OpenMesh, OpenCASCADE or ours) is then an error about that file.
//
// The child runs the same program anew; it does not copy threads and memory. It has no terminal and
// no descriptors but its pipe, makes no files, and dies with its parent. Where the kernel has
// Landlock and seccomp, it reads only below its file's folders and the system's, and cannot reach
// the network, other processes or other programs (formats/file/confinement.h). Elsewhere it keeps
// the user's rights: the sandbox then stops accidents, not a reader that an attacker controls.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::mesh {

struct SandboxLimits {
  std::uint64_t memory_bytes = std::uint64_t{8} << 30;  // address space of a child (RLIMIT_AS)
  double time_s = 300;                                  // for one file, by the clock
};

// main() calls this first. In a child that read_in_sandbox() started, it reads the file and returns
// the exit status to end with; elsewhere it returns nothing.
std::optional<int> run_as_sandbox(int argc, char** argv);

// read_assembly() in a child. The error is kMeshUnreadable, with file and reason, where the child
// is killed, ends early, exceeds a limit or sends nonsense; kInternal where no child can be started
// or main() does not call run_as_sandbox().
Result<Assembly> read_in_sandbox(const std::string& path, const ReadOptions& options,
                                 const SandboxLimits& limits);

// How commands read without --sandbox: STEP and IGES in a child without limits, as OpenCASCADE may
// crash on a damaged file; other formats, and where no child can be started, by read_assembly().
Result<Assembly> read_guarded(const std::string& path, const ReadOptions& options);

}  // namespace forcelayer::mesh
