#include "formats/file/file_bytes.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "formats/file/descriptor.h"

namespace forcelayer {
namespace {

Error read_error(const std::filesystem::path& path, int number) {
  const bool missing = number == ENOENT || number == ENOTDIR || path.empty();
  return {missing ? ErrorCode::kFileNotFound : ErrorCode::kReadFailed, path.string(), "",
          missing ? "no such file" : std::generic_category().message(number),
          missing ? "check the path" : ""};
}

// O_NONBLOCK: a named pipe must be refused, not waited for.
Descriptor open_for_reading(const std::filesystem::path& path) {
  return Descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
}

Result<std::uint64_t> size_of(int descriptor, const std::filesystem::path& path) {
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) return read_error(path, errno);
  if (S_ISDIR(status.st_mode)) {
    return Error{ErrorCode::kFileNotFound, path.string(), "", "is a folder, not a file", ""};
  }
  if (!S_ISREG(status.st_mode)) {
    return Error{ErrorCode::kReadFailed, path.string(), "", "is not a regular file",
                 "save the stream to a file first"};
  }
  return static_cast<std::uint64_t>(status.st_size);
}

// Fills `into` with the bytes from `offset` on.
Status read_at(int descriptor, std::uint64_t offset, std::span<std::byte> into,
               const std::filesystem::path& path) {
  while (!into.empty()) {
    const ssize_t got = ::pread(descriptor, into.data(), into.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return read_error(path, errno);
    if (got == 0) {
      return Error{ErrorCode::kReadFailed, path.string(), "",
                   "was cut short while it was being read", "start again"};
    }
    offset += static_cast<std::uint64_t>(got);
    into = into.subspan(static_cast<std::size_t>(got));
  }
  return {};
}

}  // namespace

FileBytes::FileBytes(FileBytes&& other) noexcept { *this = std::move(other); }

FileBytes& FileBytes::operator=(FileBytes&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

FileBytes::~FileBytes() {
  if (!bytes_.empty()) ::munmap(bytes_.data(), bytes_.size());
}

Result<FileBytes> FileBytes::read(const std::filesystem::path& path) {
  const Descriptor descriptor = open_for_reading(path);
  return read(descriptor.number(), path);
}

Result<FileBytes> FileBytes::read(int descriptor, const std::filesystem::path& path) {
  const auto size = size_of(descriptor, path);
  if (!size) return size.error();
  FileBytes file;
  if (*size == 0) return file;
  void* const memory =
      ::mmap(nullptr, *size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) {
    return Error{ErrorCode::kOutOfMemory, path.string(), "",
                 "not enough memory for its " + std::to_string(*size) + " bytes",
                 "use a machine with more memory"};
  }
  file.bytes_ = {static_cast<std::byte*>(memory), static_cast<std::size_t>(*size)};
  if (Status filled = read_at(descriptor, 0, file.bytes_, path); !filled) return filled.error();
  // A stray write of this process ends it, as one to a mapped file would.
  if (::mprotect(memory, *size, PROT_READ) != 0) return read_error(path, errno);
  return file;
}

Status read_in_pieces(const std::filesystem::path& path,
                      const std::function<void(std::span<const std::byte>)>& take) {
  constexpr std::uint64_t kPieceBytes = 256 * 1024;
  const Descriptor descriptor = open_for_reading(path);
  const auto size = size_of(descriptor.number(), path);
  if (!size) return size.error();
  std::vector<std::byte> buffer(std::min(*size, kPieceBytes));
  for (std::uint64_t at = 0; at < *size;) {
    const auto piece = std::span(buffer).first(std::min(*size - at, kPieceBytes));
    if (Status got = read_at(descriptor.number(), at, piece, path); !got) return got;
    take(piece);
    at += piece.size();
  }
  return {};
}

}  // namespace forcelayer
