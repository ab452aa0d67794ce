// A folder of results, each named by the digest of everything that it was made from. Any number of
// processes and machines may share it.
//
//   DIR/ab/abcdef....KIND   an entry: a header of 64 bytes, then its content
//   DIR/tmp/                entries that are being written
//
// An entry appears whole, by a rename, and is never changed. A damaged, truncated or foreign entry
// is as good as none. No symbolic link inside the folder is followed. Writers to the folder are
// trusted: checksums find accidents, not forgeries.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/file/file_bytes.h"
#include "formats/result.h"
#include "voxelize/cache/digest.h"

namespace forcelayer::cache {

// The content of an entry, in memory.
class CacheEntry {
 public:
  // It begins `header_bytes` behind the beginning of `file`.
  CacheEntry(FileBytes file, std::size_t header_bytes)
      : file_(std::move(file)), header_bytes_(header_bytes) {}

  std::span<const std::byte> bytes() const {  // 8-byte aligned
    return file_.bytes().subspan(header_bytes_);
  }

 private:
  FileBytes file_;
  std::size_t header_bytes_ = 0;
};

class CacheFolder {
 public:
  // Makes a missing folder; kWriteFailed where that is impossible. Removes files that killed
  // writers left.
  static Result<CacheFolder> open(const std::string& path);
  CacheFolder(CacheFolder&& other) noexcept;
  CacheFolder& operator=(CacheFolder&&) = delete;
  ~CacheFolder();

  // `kind` has at most eight letters. Any thread may call find() and keep().
  std::optional<CacheEntry> find(const char* kind, const Digest& key) const;
  // A failure to write is no error: the next bake does the work again.
  void keep(const char* kind, const Digest& key, std::span<const std::byte> content) const;

  // The first failure to write, for a warning.
  std::optional<std::string> trouble() const;

 private:
  CacheFolder(std::string path, int descriptor) : path_(std::move(path)), folder_(descriptor) {}
  void remove_leftovers() const;
  void note_trouble(int number) const;

  std::string path_;
  int folder_ = -1;  // descriptor
  mutable std::mutex mutex_;
  mutable std::optional<std::string> trouble_;
};

}  // namespace forcelayer::cache
