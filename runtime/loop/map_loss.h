// Baked files that are cut short or written to while they are mapped. A read beyond a file's new
// end is answered by the kernel with SIGBUS, in the middle of a step; the default is that the
// process dies with a force on the hand.
#pragma once

#include <cstddef>
#include <span>

#include "formats/file/mapped_file.h"

namespace forcelayer {

// From now on a SIGBUS inside a watched mapping is answered with a page that holds nothing (every
// tree entry uniformly free, every point at the origin), and remembered: the step goes on,
// harmless, and gives zero. A SIGBUS anywhere else is handed to whoever handled it before. For the
// whole process; commands call it, a library's user may.
void contain_map_loss();

// Asks the system whether the watched files still are as they were mapped, and counts those that
// are not: so a file that is written to in place, or cut while the loop reads nothing of it (a part
// at rest), is noticed. From any thread but the loop's, as often as wanted: it calls the system, a
// microsecond a file, and touches no page.
int check_mappings() noexcept;

// Watches a mapping while it lives. Beyond 64 at once nothing is watched.
class WatchedMapping {
 public:
  // `file` is the mapping's, and outlives this; one without a descriptor: bytes in memory.
  WatchedMapping(std::span<const std::byte> bytes, const FileStamp& file) noexcept;
  WatchedMapping(const WatchedMapping&) = delete;
  WatchedMapping& operator=(const WatchedMapping&) = delete;
  ~WatchedMapping();

  // Whether it lost a page that somebody wanted to read, or its file was found changed. Stays true.
  bool lost() const noexcept;

 private:
  int slot_ = -1;
};

}  // namespace forcelayer
