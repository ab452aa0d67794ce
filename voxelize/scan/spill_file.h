// Arrays that wait on disk: the triangles of scenes that are too large for memory.
//
// An array is mapped from a temporary file. Its pages are the system's to write out and to read
// back, so a bake holds only those that it works on: let_go() gives the others back.
#pragma once

#include <atomic>
#include <cstddef>
#include <mutex>
#include <span>
#include <type_traits>
#include <vector>

namespace forcelayer::scan {

class SpillFile {
 public:
  // The file lies in $TMPDIR, or in /var/tmp, has no name and ends with the process.
  SpillFile();
  ~SpillFile();
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;

  // An array of zeros that lives as long as this. It is in memory where the file cannot hold it.
  // Any thread may call.
  template <class T>
  std::span<T> array(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    return {static_cast<T*>(bytes(count * sizeof(T))), count};
  }

  // Says that so many bytes of the arrays were read or written: after many, their pages go. Any
  // thread may call, at any time: what it reads comes back.
  void touched(std::size_t bytes) const;
  void let_go() const;

  std::size_t bytes_on_disk() const { return file_bytes_; }

 private:
  struct Segment {
    std::byte* begin;
    std::size_t bytes;
    bool on_disk;
  };

  void* bytes(std::size_t count);
  Segment new_segment(std::size_t bytes);

  int file_ = -1;
  std::size_t file_bytes_ = 0;
  mutable std::mutex mutex_;
  std::vector<Segment> segments_;
  std::size_t used_ = 0;  // bytes of the last segment
  mutable std::atomic<std::size_t> touched_ = 0;
  mutable std::atomic<std::size_t> of_others_;  // bytes of files in memory that are not of this
};

}  // namespace forcelayer::scan
