// A file mapped read-only into memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "formats/file/descriptor.h"
#include "formats/result.h"

namespace forcelayer {

// The facts that the system gives of a file that is written to in place: its size, the time of its
// last writing, and the time of its last change, which nobody can set back. The latter also changes
// with names, rights and owner, which do no harm: a change that they explain is taken over.
class FileStamp {
 public:
  FileStamp() = default;

  // The stamp of an open file; its owner keeps it open.
  explicit FileStamp(int descriptor) noexcept;

  // Whether the file was written to since, or can no longer be asked. False without a file.
  // Calls the system; touches no page of the file.
  bool changed() noexcept;

 private:
  struct Facts {
    std::int64_t bytes = 0;
    std::int64_t written_s = 0, written_ns = 0;
    std::int64_t changed_s = 0, changed_ns = 0;
    std::uint64_t links = 0;
    std::uint32_t mode = 0, owner = 0, group = 0;
    std::uint64_t name = 0;  // a hash of where the descriptor now points
  };
  bool ask(Facts& facts) const noexcept;

  int descriptor_ = -1;
  bool asked_ = false;
  Facts facts_;
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
