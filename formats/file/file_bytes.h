// A file read whole into memory of this process.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

#include "formats/result.h"

namespace forcelayer {

// The bytes that a file had while it was read. They stay, whatever becomes of the file: it can be
// written to, cut short or removed. Page-aligned, and read-only from the moment they are there.
class FileBytes {
 public:
  FileBytes() = default;
  FileBytes(FileBytes&& other) noexcept;
  FileBytes& operator=(FileBytes&& other) noexcept;
  ~FileBytes();

  // Reads the regular file `path`. An empty file gives an empty span. Errors: kFileNotFound;
  // kReadFailed, also where the file was cut short meanwhile; kOutOfMemory.
  static Result<FileBytes> read(const std::filesystem::path& path);

  // The same of an open file, from its beginning; `path` is for errors.
  static Result<FileBytes> read(int descriptor, const std::filesystem::path& path);

  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<std::byte> bytes_;
};

// Hands the bytes of the regular file `path` to `take`, one small piece after the other, for those
// who need no more than a sum of them. Errors: as FileBytes::read().
Status read_in_pieces(const std::filesystem::path& path,
                      const std::function<void(std::span<const std::byte>)>& take);

}  // namespace forcelayer
