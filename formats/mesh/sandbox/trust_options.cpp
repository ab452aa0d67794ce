#include "formats/mesh/sandbox/trust_options.h"

#include "formats/command/arguments.h"
#include "formats/command/values.h"

namespace forcelayer::mesh {
namespace {

// With less memory the program itself does not load.
constexpr std::uint64_t kMinMemoryBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kMaxMemoryBytes = std::uint64_t{1} << 46;
constexpr double kLongestS = 1e6;

Status read_limits(const std::string& text, SandboxLimits& limits) {
  std::string memory, time;
  const command::ValueName names[] = {{.name = "memory", .text = &memory},
                                      {.name = "time", .text = &time}};
  if (Status read = command::read_values("--sandbox", text, names); !read) return read;
  if (!memory.empty()) {
    const auto bytes = command::parse_bytes(memory, kMinMemoryBytes, kMaxMemoryBytes);
    if (!bytes) return command::about("--sandbox memory", bytes.error());
    limits.memory_bytes = *bytes;
  }
  if (time.empty()) return {};
  const auto time_s = command::parse_duration(time);
  if (!time_s) return command::about("--sandbox time", time_s.error());
  if (!(*time_s > 0 && *time_s <= kLongestS)) {
    return Error{ErrorCode::kUsage, "", "--sandbox time", "is not between 0 and 1e6 seconds",
                 "check the number and the unit"};
  }
  limits.time_s = *time_s;
  return {};
}

}  // namespace

void TrustOptions::declare(CLI::App& app) {
  command::add_flag(app, "--sandbox", sandbox,
                    "read each mesh file in a separate process. A crash, a hang or too much memory "
                    "then becomes an error about that file. --sandbox=memory=2GiB,time=30s sets "
                    "the limits for each file (default 8GiB and 5min)");
  command::add_flag(
      app, "--allow-outside", allow_outside,
      "let manifests, glTF files and STEP files refer to files outside their own folders");
}

Result<AssemblyReader> TrustOptions::reader() const {
  SandboxLimits limits;
  const bool in_child = !sandbox.empty();
  if (in_child && sandbox != "true") {
    if (Status read = read_limits(sandbox, limits); !read) return read.error();
  }
  return AssemblyReader(
      [=, outside = allow_outside](const std::string& path, const ReadOptions& options) {
        ReadOptions own = options;
        own.allow_outside = outside;
        return in_child ? read_in_sandbox(path, own, limits) : read_guarded(path, own);
      });
}

}  // namespace forcelayer::mesh
