// Writing a file so that a reader sees the old bytes or all the new ones, never a part.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "formats/result.h"

namespace forcelayer {

// A temporary file in the target's folder, renamed over the target by commit(). Without commit()
// the temporary is removed and the target left as it was.
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

  int descriptor_ = -1;
  std::filesystem::path temporary_;
  std::filesystem::path target_;
};

}  // namespace forcelayer
