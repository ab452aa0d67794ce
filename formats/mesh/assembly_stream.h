// An assembly, or the error in its place, as bytes from one process to another of the same machine
// and program. The receiver trusts nothing: what comes may have been written by a crashed reader.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer {

// False where the descriptor refuses.
bool send_assembly(int descriptor, const Result<Assembly>& assembly);

// How receiving went wrong.
enum class BrokenStream { kEnded, kTooLate, kTooLong, kNonsense };

// What was sent: keeps the promises of Assembly (indices in range, coordinates finite) whatever
// comes. Waits until `deadline` at most, and takes `max_bytes` at most; memory is taken as bytes
// arrive, not as they are announced.
struct ReceivedAssembly {
  std::optional<Result<Assembly>> assembly;  // absent where the stream is broken
  BrokenStream broken = BrokenStream::kEnded;
};
ReceivedAssembly receive_assembly(int descriptor, std::uint64_t max_bytes,
                                  std::chrono::steady_clock::time_point deadline);

}  // namespace forcelayer
