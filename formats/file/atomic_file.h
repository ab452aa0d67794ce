// Writing a file so that a reader sees the old bytes or all the new ones, never a part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "formats/result.h"

namespace forcelayer {

// A temporary file in the target's folder, renamed over the target by commit(). Without commit()
// the temporary is removed and the target left as it was; so it is where exit_cleanly_on_signals()
// is in force and SIGINT, SIGTERM or SIGHUP ends the process. A target that is a symbolic link
// stays one: the file it points to is replaced. A target that is a device, a pipe or an open
// descriptor (/dev/stdout) is written to directly.
class AtomicFile {
 public:
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;
  ~AtomicFile();

  static Result<AtomicFile> create(const std::filesystem::path& target);

  Status write(std::span<const std::byte> bytes);  // appends
  Status commit();                                 // flush to disk, rename, flush the folder

 private:
  AtomicFile() = default;
  Status open_temporary();
  void discard() noexcept;
  Error write_error(int number) const;

  int descriptor_ = -1;
  std::filesystem::path temporary_;  // empty where the target is written to directly
  std::filesystem::path target_;     // with symbolic links followed
  std::filesystem::path shown_;      // as the caller gave it, for errors
  std::size_t slot_ = 0;             // of temporary_ in the registry
};

}  // namespace forcelayer
