// The temporary files that this process is writing, so that a signal handler can remove them.
#pragma once

#include <cstddef>

namespace forcelayer {

// Notes that `path` is to be removed if the process is ended by a signal, and returns its slot, or
// kNoSlot where all are taken. The path is copied.
inline constexpr std::size_t kNoSlot = static_cast<std::size_t>(-1);
std::size_t register_temporary_file(const char* path);

// Forgets the file of `slot`: it was renamed or removed.
void unregister_temporary_file(std::size_t slot) noexcept;

// Removes all registered files; whether there were any. Async-signal-safe; for a handler that ends
// the process.
bool remove_temporary_files() noexcept;

}  // namespace forcelayer
