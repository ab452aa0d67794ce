#include "formats/file/temporary_files.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace forcelayer {
namespace {

// Far more than any command writes at once. Only the one who takes a pointer out of its slot owns
// it, so a handler on one thread and a commit on another never touch freed memory.
constexpr std::size_t kSlots = 256;
std::array<std::atomic<char*>, kSlots> slots{};
static_assert(std::atomic<char*>::is_always_lock_free, "needed in a signal handler");

std::atomic<int> creating{0};
std::atomic<bool> is_ending{false};
constexpr int kWaits = 100;
constexpr timespec kWait{0, 1'000'000};

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

// Either this sees that the process ends, or remove_temporary_files() sees that a file is created.
TemporaryFileCreation::TemporaryFileCreation() noexcept {
  creating.fetch_add(1);
  if (!is_ending.load()) return;
  creating.fetch_sub(1);
  while (true) ::pause();
}

TemporaryFileCreation::~TemporaryFileCreation() { creating.fetch_sub(1); }

bool remove_temporary_files() noexcept {
  is_ending.store(true);
  for (int n = 0; n < kWaits && creating.load() > 0; ++n) ::nanosleep(&kWait, nullptr);
  bool removed = false;
  for (auto& slot : slots) {
    const char* path = slot.exchange(nullptr);  // not freed: free() is not async-signal-safe
    if (path != nullptr && ::unlink(path) == 0) removed = true;
  }
  return removed;
}

}  // namespace forcelayer
