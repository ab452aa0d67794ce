// Survives the loss of a mapped baked file. When a file is cut short while it is mapped, the kernel
// answers a read beyond the new end with SIGBUS. By default that ends the process in the middle of
// a step, with a force on the hand.
#pragma once

#include <cstddef>
#include <span>

#include "formats/file/mapped_file.h"

namespace forcelayer::machine {

// Installs the SIGBUS handler of the process. A SIGBUS inside a watched mapping is answered with an
// empty page (every tree entry uniformly free, every point at the origin) and marks the mapping as
// lost: the step ends harmlessly with zero force. Any other SIGBUS goes to the earlier handler.
// The commands call this; users of the library may.
void contain_map_loss();

// Asks the system whether the watched files are unchanged (FileStamp::changed), marks the changed
// ones as lost, and returns how many are lost. This finds files that are written to in place, and
// files that are cut while the loop reads nothing of them (a part at rest). Call it from any thread
// but the loop's: it makes one system call a file (about a microsecond) and touches no page.
int check_mappings() noexcept;

// Watches a mapping for its own lifetime. At most 64 are watched at once; more stay unwatched.
class WatchedMapping {
 public:
  // `file` is the mapped file and must outlive this; without a descriptor the bytes are in memory
  // and cannot change.
  WatchedMapping(std::span<const std::byte> bytes, const FileStamp& file) noexcept;
  WatchedMapping(const WatchedMapping&) = delete;
  WatchedMapping& operator=(const WatchedMapping&) = delete;
  ~WatchedMapping();

  // True once a read met a lost page or check_mappings() found the file changed. Stays true.
  bool lost() const noexcept;

 private:
  int slot_ = -1;
};

}  // namespace forcelayer::machine
