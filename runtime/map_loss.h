// Files that are cut short while they are mapped. The kernel answers a read beyond the new end with
// SIGBUS, in the middle of a step; the default is that the process dies with a force on the hand.
#pragma once

#include <cstddef>
#include <span>

namespace forcelayer {

// From now on a SIGBUS inside a watched mapping is answered with a page that holds nothing (every
// tree entry uniformly free, every point at the origin), and remembered: the step goes on,
// harmless, and gives zero. A SIGBUS anywhere else is handed to whoever handled it before. For the
// whole process; commands call it, a library's user may.
void contain_map_loss();

// Whether a watched mapping lost a page that somebody wanted to read. Stays true.
bool map_lost() noexcept;

// Reads the last byte of every watched mapping, so that a cut is noticed while the loop reads
// nothing of it (a part at rest). Not for the loop's thread, and not while a mapping is being
// closed.
void probe_mappings() noexcept;

// Watches a mapping while it lives. Beyond 64 at once nothing is watched.
class WatchedMapping {
 public:
  explicit WatchedMapping(std::span<const std::byte> bytes) noexcept;
  WatchedMapping(const WatchedMapping&) = delete;
  WatchedMapping& operator=(const WatchedMapping&) = delete;
  ~WatchedMapping();

 private:
  int slot_ = -1;
};

}  // namespace forcelayer
