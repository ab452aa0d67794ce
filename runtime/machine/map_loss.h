// Survives the loss of a mapped baked file. When a file is cut short while it is mapped, the kernel
// answers a read beyond the new end with SIGBUS. When it is written to in place, an index that was
// checked at opening may lead anywhere, and the kernel answers with SIGSEGV. By default either ends
// the process in the middle of a step, with a force on the hand.
#pragma once

#include <setjmp.h>

#include <cstddef>
#include <span>

#include "formats/file/mapped_file.h"

namespace forcelayer::machine {

// Installs the handlers of SIGBUS and SIGSEGV of the process. A SIGBUS inside a watched mapping is
// answered with an empty page (every tree entry uniformly free, every point at the origin) and
// marks the mapping as lost: the step ends harmlessly with zero force. Any other of the two, in a
// thread with a Landing and while some watched file has changed, is answered by going on there. All
// others go to the earlier handlers. The commands call this; users of the library may.
void contain_map_loss();

// Where a thread goes on that a changed file led astray: at sigsetjmp(landing.here, 0), which then
// gives 1. For the landing's own lifetime; what lies between is abandoned, so it must hold nothing
// that is to be given back.
class Landing {
 public:
  Landing() noexcept;
  Landing(const Landing&) = delete;
  Landing& operator=(const Landing&) = delete;
  ~Landing();

  sigjmp_buf here;

 private:
  Landing* outer_;
};

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
