#include "formats/file/temporary_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>

namespace forcelayer {
namespace {

// Far more than any command writes at once. Only the one who takes a pointer out of its slot owns
// it, so a handler on one thread and a commit on another never touch freed memory.
constexpr std::size_t kSlots = 256;
std::array<std::atomic<char*>, kSlots> slots{};
static_assert(std::atomic<char*>::is_always_lock_free, "needed in a signal handler");

}  // namespace

std::size_t register_temporary_file(const char* path) {
  char* copy = ::strdup(path);
  if (copy == nullptr) return kNoSlot;
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    char* empty = nullptr;
    if (slots[slot].compare_exchange_strong(empty, copy)) return slot;
  }
  std::free(copy);
  return kNoSlot;
}

void unregister_temporary_file(std::size_t slot) noexcept {
  if (slot < kSlots) std::free(slots[slot].exchange(nullptr));
}

bool remove_temporary_files() noexcept {
  bool removed = false;
  for (auto& slot : slots) {
    const char* path = slot.exchange(nullptr);  // not freed: free() is not async-signal-safe
    if (path != nullptr && ::unlink(path) == 0) removed = true;
  }
  return removed;
}

}  // namespace forcelayer
