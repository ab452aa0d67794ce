// Writing a file so that a reader sees all of the old bytes or all of the new ones.
#pragma once

#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "formats/result.h"

namespace forcelayer {

// The verdict of a file's reader on what was written; `name` is for errors.
using ReaderCheck = Status (*)(std::span<const std::byte> bytes, std::string_view name);

// A temporary file in the target's folder, renamed over the target by commit(). Without commit()
// the temporary is removed and the target stays as it was. The same holds when SIGINT, SIGTERM or
// SIGHUP ends the process, after a call of exit_cleanly_on_signals(). A target that is a symbolic
// link stays one: the file that it points to is replaced. The new file has the old one's owner,
// group and mode, as far as the user may give them. A device, a pipe or an open descriptor
// (/dev/stdout) is written to directly.
class AtomicFile {
 public:
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  ~AtomicFile();

  static Result<AtomicFile> create(const std::filesystem::path& target);
  // The error that create() would end with, before there is anything to write. A pipe or a device
  // is not opened, since its reader would take that for the end: whether it may be is asked.
  static Status can_create(const std::filesystem::path& target);

  Status write(std::span<const std::byte> bytes);  // appends
  Status commit();                                 // flush to disk, rename, flush the folder
  // The same, once the reader takes what was written. Else the target stays as it was: kInternal,
  // with the reader's words.
  Status commit(ReaderCheck check);
  // The error of content that the reader would refuse for `why`.
  Error refused(std::string_view why) const;

 private:
  AtomicFile() = default;
  static Result<AtomicFile> open(const std::filesystem::path& target, bool opens_streams);
  Status open_temporary();
  void take_over(const struct stat& old) noexcept;  // owner, group and mode, where we may
  void discard() noexcept;
  Error write_error(int number) const;

  int descriptor_ = -1;
  std::filesystem::path temporary_;  // empty where the target is written to directly
  std::filesystem::path target_;     // with symbolic links followed
  std::filesystem::path shown_;      // as the caller gave it, for errors
  std::size_t slot_ = 0;             // of temporary_ in the registry
};

}  // namespace forcelayer
