#include "formats/file/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>
#include <utility>

namespace forcelayer {
namespace {

Error open_error(const std::filesystem::path& path, int number) {
  const bool missing = number == ENOENT || number == ENOTDIR || path.empty();
  return {missing ? ErrorCode::kFileNotFound : ErrorCode::kReadFailed, path.string(), "",
          missing ? "no such file" : std::generic_category().message(number),
          missing ? "check the path" : ""};
}

}  // namespace

bool FileStamp::changed() const noexcept {
  if (descriptor < 0) return false;
  struct stat now {};
  return ::fstat(descriptor, &now) != 0 || now.st_size != bytes ||
         now.st_mtim.tv_sec != written_s || now.st_mtim.tv_nsec != written_ns;
}

MappedFile::MappedFile(MappedFile&& other) noexcept { *this = std::move(other); }

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(stamp_, other.stamp_);
  std::swap(path_, other.path_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) { return map(path, false); }

Result<MappedFile> MappedFile::open_for_long(const std::filesystem::path& path) {
  return map(path, true);
}

Result<MappedFile> MappedFile::map(const std::filesystem::path& path, bool keep) {
  // O_NONBLOCK: a named pipe must be refused, not waited for.
  Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (!descriptor.valid()) return open_error(path, errno);
  struct stat status {};
  if (::fstat(descriptor.number(), &status) != 0) return open_error(path, errno);
  if (S_ISDIR(status.st_mode)) {
    return Error{ErrorCode::kFileNotFound, path.string(), "", "is a folder, not a file", ""};
  }
  if (!S_ISREG(status.st_mode)) {
    return Error{ErrorCode::kReadFailed, path.string(), "", "is not a regular file",
                 "files are mapped into memory: save the stream to a file first"};
  }
  MappedFile file;
  if (status.st_size > 0) {
    const auto size = static_cast<std::size_t>(status.st_size);
    void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor.number(), 0);
    if (address == MAP_FAILED) return open_error(path, errno);
    file.bytes_ = {static_cast<const std::byte*>(address), size};
  }
  if (!keep) return file;
  file.path_ = path;
  file.stamp_ = {descriptor.number(), status.st_size, status.st_mtim.tv_sec,
                 status.st_mtim.tv_nsec};
  file.descriptor_ = std::move(descriptor);
  return file;
}

Status MappedFile::read(std::uint64_t offset, std::span<std::byte> into) const {
  while (!into.empty()) {
    const auto got =
        ::pread(descriptor_.number(), into.data(), into.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return open_error(path_, errno);
    if (got == 0) {
      return Error{ErrorCode::kTruncated, path_.string(), "byte " + std::to_string(offset),
                   "the file was cut short while it was being read", "bake or copy it again"};
    }
    offset += static_cast<std::uint64_t>(got);
    into = into.subspan(static_cast<std::size_t>(got));
  }
  return {};
}

}  // namespace forcelayer
