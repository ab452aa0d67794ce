#include "formats/mesh/sandbox/trust_options.h"

#include "formats/command/arguments.h"

namespace forcelayer::mesh {

void TrustOptions::declare(CLI::App& app) {
  // With less memory the program itself does not load.
  constexpr std::uint64_t kLeastMemoryBytes = std::uint64_t{256} << 20;
  command::add_flag(app, "--sandbox", sandbox,
                    "read each mesh file in a process of its own: a crash, a hang or too much "
                    "memory is an error about that file");
  command::add_bytes(app, "--sandbox-memory", sandbox_memory_bytes,
                     "memory of that process, such as 2GiB (default 8GiB); implies --sandbox",
                     kLeastMemoryBytes, std::uint64_t{1} << 46);
  command::add_text(app, "--sandbox-time", sandbox_time,
                    "time for one file, such as 30s (default 5min); implies --sandbox");
  command::add_flag(app, "--allow-outside", allow_outside,
                    "let a manifest, a glTF or a STEP file name files outside its own folder");
}

Result<AssemblyReader> TrustOptions::reader() const {
  SandboxLimits limits;
  if (sandbox_memory_bytes > 0) limits.memory_bytes = sandbox_memory_bytes;
  if (!sandbox_time.empty()) {
    const auto time_s = command::parse_duration(sandbox_time);
    if (!time_s) {
      return Error{ErrorCode::kUsage, "", "--sandbox-time", time_s.error().what,
                   time_s.error().mend};
    }
    constexpr double kLongestS = 1e6;
    if (!(*time_s > 0 && *time_s <= kLongestS)) {
      return Error{ErrorCode::kUsage, "", "--sandbox-time", "is not between 0 and 1e6 seconds",
                   "write it like 30s"};
    }
    limits.time_s = *time_s;
  }
  const bool outside = allow_outside;
  const bool in_child = sandbox || sandbox_memory_bytes > 0 || !sandbox_time.empty();
  return AssemblyReader([=](const std::string& path, const ReadOptions& options) {
    ReadOptions own = options;
    own.allow_outside = outside;
    return in_child ? read_in_sandbox(path, own, limits) : read_guarded(path, own);
  });
}

}  // namespace forcelayer::mesh
