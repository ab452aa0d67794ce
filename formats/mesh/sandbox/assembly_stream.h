// An assembly, or an error in its place, as bytes between two processes of the same program on one
// machine. The receiver trusts nothing, because a damaged reader may have written the bytes.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::mesh {

// False where the descriptor refuses.
bool send_assembly(int descriptor, const Result<Assembly>& assembly);

// The reason why receiving failed.
enum class BrokenStream { kEnded, kTooLate, kTooLong, kNonsense };

// The received assembly keeps the promises of Assembly (indices in range, coordinates finite),
// whatever bytes arrive. Waits until `deadline` at most and takes `max_bytes` at most. Memory grows
// with the bytes that arrive, not with those that are announced.
struct ReceivedAssembly {
  std::optional<Result<Assembly>> assembly;  // absent where the stream is broken
  BrokenStream broken = BrokenStream::kEnded;
};
ReceivedAssembly receive_assembly(int descriptor, std::uint64_t max_bytes,
                                  std::chrono::steady_clock::time_point deadline);

}  // namespace forcelayer::mesh
