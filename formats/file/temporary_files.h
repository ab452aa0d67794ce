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

// Alive while a registered file is created. Once remove_temporary_files() has begun, no thread
// creates one any more: the constructor does not return then.
class TemporaryFileCreation {
 public:
  TemporaryFileCreation() noexcept;
  ~TemporaryFileCreation();
  TemporaryFileCreation(const TemporaryFileCreation&) = delete;
  TemporaryFileCreation& operator=(const TemporaryFileCreation&) = delete;
};

// Removes all registered files; whether there were any. Waits up to a tenth of a second for files
// that are being created: the signal may have come on the thread that creates one, which then never
// does. Async-signal-safe; for a handler that ends the process.
bool remove_temporary_files() noexcept;

}  // namespace forcelayer
