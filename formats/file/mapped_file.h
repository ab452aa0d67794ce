// A file mapped read-only into memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "formats/file/descriptor.h"
#include "formats/result.h"

namespace forcelayer {

// A file's size and the time of its last writing, which change when it is written to in place. (Its
// ctime would also change when it is renamed or replaced, which does no harm.)
struct FileStamp {
  int descriptor = -1;  // of the file; its owner keeps it open
  std::int64_t bytes = 0;
  std::int64_t written_s = 0, written_ns = 0;

  // Whether the file has changed since, or can no longer be asked. False without a file.
  // Calls the system; touches no page of the file.
  bool changed() const noexcept;
};

class MappedFile {
 public:
  MappedFile() = default;
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  // Maps the regular file `path` privately and read-only. Empty files give an empty span.
  static Result<MappedFile> open(const std::filesystem::path& path);

  // The same, with the file kept open, for read() and stamp().
  static Result<MappedFile> open_for_long(const std::filesystem::path& path);

  std::span<const std::byte> bytes() const { return bytes_; }

  // The stamp of the mapping; one that never changes where the file was not kept open.
  const FileStamp& stamp() const { return stamp_; }

  // Reads from the file itself, not through the mapping: a disk that fails gives an error and no
  // signal. A file that ends before `into` is full is kTruncated.
  Status read(std::uint64_t offset, std::span<std::byte> into) const;

 private:
  static Result<MappedFile> map(const std::filesystem::path& path, bool keep);

  std::span<const std::byte> bytes_;
  Descriptor descriptor_;
  FileStamp stamp_;
  std::filesystem::path path_;  // for errors
};

}  // namespace forcelayer
