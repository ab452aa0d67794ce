#include "runtime/machine/map_loss.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

#include "formats/voxmap_format.h"

namespace forcelayer::machine {
namespace {

// Read by the signal handler: plain atomics, no locks. `file` is for check_mappings() alone.
struct Slot {
  std::atomic<std::uintptr_t> begin{0}, end{0};
  std::atomic<bool> lost{false};
  std::optional<FileStamp> file;  // of a slot that is taken
};

constexpr std::size_t kSlots = 64;
std::array<Slot, kSlots> slots;
std::mutex slots_mutex;  // of `file`; never taken by the handler or by a step
struct sigaction before_bus_error {
}, before_bad_read{};
// siglongjmp() without the check of _FORTIFY_SOURCE, which asks for the stack that a handler is on.
extern "C" [[noreturn]] void go_on_at(sigjmp_buf, int) noexcept __asm__("siglongjmp");

// In the library's own piece of each thread's memory, which a handler reaches without asking.
constinit thread_local Landing* landing __attribute__((tls_model("initial-exec"))) = nullptr;
std::uintptr_t page_bytes = 4096;
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free);

Slot* slot_of(std::uintptr_t address) {
  for (Slot& slot : slots) {
    if (address >= slot.begin.load(std::memory_order_acquire) &&
        address < slot.end.load(std::memory_order_acquire)) {
      return &slot;
    }
  }
  return nullptr;
}

// Replaces the lost page with one full of "uniformly free" entries. Read as tree entries they name
// no child; read as coordinates or radii they are -0.0f. The page is filled elsewhere and then
// moved into place, because a thread that read it half made would take its zeros for children and
// bricks.
bool replace_page(std::uintptr_t address) {
  void* const made =
      mmap(nullptr, page_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (made == MAP_FAILED) return false;
  auto* const words = static_cast<std::uint32_t*>(made);
  for (std::size_t i = 0; i < page_bytes / sizeof *words; ++i) words[i] = kUniformBit;
  void* const page = reinterpret_cast<void*>(address & ~(page_bytes - 1));
  return mremap(made, page_bytes, page_bytes, MREMAP_MAYMOVE | MREMAP_FIXED, page) != MAP_FAILED;
}

// How many of the watched files have changed; marks them as lost.
int look() noexcept {
  int lost = 0;
  for (Slot& slot : slots) {
    if (!slot.file) continue;
    if (slot.file->changed()) slot.lost.store(true, std::memory_order_relaxed);
    lost += slot.lost.load(std::memory_order_relaxed) ? 1 : 0;
  }
  return lost;
}

// Without the lock: its owner may be the thread that was led astray, or one that this one ran
// before. What a look beside another finds is at worst found again.
void land() noexcept {
  if (landing != nullptr && look() > 0) go_on_at(landing->here, 1);
}

extern "C" void on_bad_read(int, siginfo_t*, void*) {
  land();
  sigaction(SIGSEGV, &before_bad_read, nullptr);  // the read is repeated and reaches that handler
}

extern "C" void on_bus_error(int, siginfo_t* info, void*) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  Slot* const slot = slot_of(address);
  if (slot != nullptr) {
    // Set before the page is there: a step that reads the page then sees the loss at its end.
    slot->lost.store(true);
    if (replace_page(address)) return;
  }
  land();
  sigaction(SIGBUS, &before_bus_error, nullptr);
}

void install(int number, void (*handler)(int, siginfo_t*, void*), struct sigaction& previous) {
  struct sigaction action {};
  action.sa_sigaction = handler;
  action.sa_flags = SA_SIGINFO | SA_NODEFER | SA_ONSTACK;
  struct sigaction before {};
  sigaction(number, &action, &before);
  const bool ours = (before.sa_flags & SA_SIGINFO) != 0 && before.sa_sigaction == handler;
  if (!ours) previous = before;
}

}  // namespace

void contain_map_loss() {
  page_bytes = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  install(SIGBUS, on_bus_error, before_bus_error);
  install(SIGSEGV, on_bad_read, before_bad_read);
}

Landing::Landing() noexcept : outer_(std::exchange(landing, this)) {}
Landing::~Landing() { landing = outer_; }

int check_mappings() noexcept {
  const std::lock_guard lock(slots_mutex);
  return look();
}

WatchedMapping::WatchedMapping(std::span<const std::byte> bytes, const FileStamp& file) noexcept {
  const std::lock_guard lock(slots_mutex);
  for (std::size_t i = 0; i < kSlots; ++i) {
    Slot& slot = slots[i];
    if (slot.file) continue;
    slot.file = file;
    slot.lost.store(false, std::memory_order_relaxed);
    const auto begin = reinterpret_cast<std::uintptr_t>(bytes.data());
    slot.begin.store(begin, std::memory_order_release);
    slot.end.store(begin + bytes.size(), std::memory_order_release);
    slot_ = static_cast<int>(i);
    return;
  }
}

WatchedMapping::~WatchedMapping() {
  if (slot_ < 0) return;
  const std::lock_guard lock(slots_mutex);
  Slot& slot = slots[static_cast<std::size_t>(slot_)];
  slot.end.store(0, std::memory_order_release);
  slot.begin.store(0, std::memory_order_release);
  slot.file.reset();
}

bool WatchedMapping::lost() const noexcept {
  return slot_ >= 0 && slots[static_cast<std::size_t>(slot_)].lost.load(std::memory_order_relaxed);
}

}  // namespace forcelayer::machine
