// An atomic file that is written through a buffer.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/file/atomic_file.h"

namespace forcelayer::voxinfo {

// The first failure of a write is kept and returned by finish(); writes after it do nothing.
class BufferedOutput {
 public:
  static Result<BufferedOutput> create(const std::filesystem::path& path) {
    auto file = AtomicFile::create(path);
    if (!file) return file.error();
    return BufferedOutput(std::move(*file));
  }

  void append(const void* data, std::size_t bytes) {
    if (buffer_.size() + bytes > kCapacity) flush();
    const auto* first = static_cast<const std::byte*>(data);
    buffer_.insert(buffer_.end(), first, first + bytes);
  }
  void append(std::string_view text) { append(text.data(), text.size()); }
  template <typename Number>
  void append_number(Number number) {  // little-endian, as the machine is
    append(&number, sizeof number);
  }

  bool failed() const { return !status_; }

  Status finish() {
    flush();
    return status_ ? file_.commit() : status_;
  }

 private:
  static constexpr std::size_t kCapacity = std::size_t{1} << 20;

  explicit BufferedOutput(AtomicFile file) : file_(std::move(file)) { buffer_.reserve(kCapacity); }

  void flush() {
    if (status_) status_ = file_.write(buffer_);
    buffer_.clear();
  }

  AtomicFile file_;
  std::vector<std::byte> buffer_;
  Status status_;
};

}  // namespace forcelayer::voxinfo
