#include "voxelize/scan/spill_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <new>
#include <string>

namespace forcelayer::scan {
namespace {

constexpr std::size_t kSegmentBytes = std::size_t{64} << 20, kAlignment = 64;
constexpr std::size_t kPageBytes = 4096;
// Pages in memory before they go. To map one again takes a microsecond. A triangle brings pages
// that hold little else that is wanted, and the system maps 16 where one is read, so that bytes
// that were touched are not the measure: after so many, the pages are counted.
constexpr std::size_t kResidentBytes = std::size_t{256} << 20;
constexpr std::size_t kCountedBytes = std::size_t{256} << 10;

std::size_t rounded_up(std::size_t bytes, std::size_t to) { return (bytes + to - 1) / to * to; }

// Pages of mapped files, ours and others, that are in the process's memory, in bytes.
std::size_t resident_file_bytes() {
  std::size_t all = 0, resident = 0, of_files = 0;
  std::ifstream("/proc/self/statm") >> all >> resident >> of_files;
  return of_files * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

int nameless_file() {
  const char* const given = std::getenv("TMPDIR");
  const std::string folder = given != nullptr && *given != '\0' ? given : "/var/tmp";
  const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0) return file;
  std::string name = folder + "/voxelize-XXXXXX";  // file systems without O_TMPFILE
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

}  // namespace

SpillFile::SpillFile() : file_(nameless_file()), of_others_(resident_file_bytes()) {}

SpillFile::~SpillFile() {
  for (const Segment& segment : segments_) munmap(segment.begin, segment.bytes);
  if (file_ >= 0) close(file_);
}

SpillFile::Segment SpillFile::new_segment(std::size_t bytes) {
  const auto map = [&](int file, int flags, std::size_t offset) {
    return mmap(nullptr, bytes, PROT_READ | PROT_WRITE, flags, file, static_cast<off_t>(offset));
  };
  // The blocks are taken now: a page that no disk holds would end the process.
  if (file_ >= 0 &&
      posix_fallocate(file_, static_cast<off_t>(file_bytes_), static_cast<off_t>(bytes)) == 0) {
    void* const at = map(file_, MAP_SHARED, file_bytes_);
    if (at != MAP_FAILED) {
      file_bytes_ += bytes;
      return {static_cast<std::byte*>(at), bytes, true};
    }
  }
  void* const at = map(-1, MAP_PRIVATE | MAP_ANONYMOUS, 0);
  if (at == MAP_FAILED) throw std::bad_alloc();
  return {static_cast<std::byte*>(at), bytes, false};
}

void* SpillFile::bytes(std::size_t count) {
  const std::lock_guard lock(mutex_);
  if (segments_.empty() || segments_.back().bytes - used_ < count) {
    segments_.push_back(new_segment(std::max(kSegmentBytes, rounded_up(count, kPageBytes))));
    used_ = 0;
  }
  void* const at = segments_.back().begin + used_;
  used_ = std::min(segments_.back().bytes, used_ + rounded_up(count, kAlignment));
  return at;
}

void SpillFile::touched(std::size_t bytes) const {
  if (touched_.fetch_add(bytes, std::memory_order_relaxed) + bytes < kCountedBytes) return;
  touched_.store(0, std::memory_order_relaxed);
  if (resident_file_bytes() >= of_others_ + kResidentBytes) let_go();
}

void SpillFile::let_go() const {
  const std::lock_guard lock(mutex_);
  for (const Segment& segment : segments_) {
    // Pages of a shared file keep what was written.
    if (segment.on_disk) madvise(segment.begin, segment.bytes, MADV_DONTNEED);
  }
  of_others_ = resident_file_bytes();
}

}  // namespace forcelayer::scan
