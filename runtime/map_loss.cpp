#include "runtime/map_loss.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>

#include "formats/voxmap_format.h"

namespace forcelayer {
namespace {

// Read by the signal handler: plain atomics, no locks.
struct Slot {
  std::atomic<bool> taken{false};
  std::atomic<std::uintptr_t> begin{0}, end{0};
};

constexpr std::size_t kSlots = 64;
std::array<Slot, kSlots> slots;
std::atomic<bool> lost{false};
struct sigaction previous {};
std::uintptr_t page_bytes = 4096;
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free);

bool watched(std::uintptr_t address) {
  for (const Slot& slot : slots) {
    if (address >= slot.begin.load(std::memory_order_acquire) &&
        address < slot.end.load(std::memory_order_acquire)) {
      return true;
    }
  }
  return false;
}

// Puts a page of "uniformly free" in place of the lost one: as tree entries they name no child, as
// voxels, coordinates and radii they are next to nothing (-0.0f).
bool replace_page(std::uintptr_t address) {
  auto* const page = reinterpret_cast<std::uint32_t*>(address & ~(page_bytes - 1));
  void* const mapped = mmap(page, page_bytes, PROT_READ | PROT_WRITE,
                            MAP_FIXED | MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) return false;
  for (std::size_t i = 0; i < page_bytes / sizeof *page; ++i) page[i] = kUniformBit;
  return true;
}

extern "C" void on_bus_error(int, siginfo_t* info, void*) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  if (watched(address) && replace_page(address)) {
    lost.store(true, std::memory_order_relaxed);
    return;
  }
  sigaction(SIGBUS, &previous, nullptr);  // the read is tried again, and meets that
}

}  // namespace

void contain_map_loss() {
  page_bytes = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  struct sigaction before {};
  sigaction(SIGBUS, &action, &before);
  const bool ours = (before.sa_flags & SA_SIGINFO) != 0 && before.sa_sigaction == on_bus_error;
  if (!ours) previous = before;
}

bool map_lost() noexcept { return lost.load(std::memory_order_relaxed); }

void probe_mappings() noexcept {
  for (const Slot& slot : slots) {
    const std::uintptr_t begin = slot.begin.load(std::memory_order_acquire);
    const std::uintptr_t end = slot.end.load(std::memory_order_acquire);
    if (end > begin) static_cast<void>(*reinterpret_cast<const volatile char*>(end - 1));
  }
}

WatchedMapping::WatchedMapping(std::span<const std::byte> bytes) noexcept {
  for (std::size_t i = 0; i < kSlots; ++i) {
    if (slots[i].taken.exchange(true)) continue;
    const auto begin = reinterpret_cast<std::uintptr_t>(bytes.data());
    slots[i].begin.store(begin, std::memory_order_release);
    slots[i].end.store(begin + bytes.size(), std::memory_order_release);
    slot_ = static_cast<int>(i);
    return;
  }
}

WatchedMapping::~WatchedMapping() {
  if (slot_ < 0) return;
  Slot& slot = slots[static_cast<std::size_t>(slot_)];
  slot.end.store(0, std::memory_order_release);
  slot.begin.store(0, std::memory_order_release);
  slot.taken.store(false, std::memory_order_release);
}

}  // namespace forcelayer
