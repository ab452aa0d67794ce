#include "formats/file/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
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

// A hash (FNV-1a) of the name under which the descriptor's file now stands; one of nothing where
// the system does not tell.
std::uint64_t name_of(int descriptor) noexcept {
  char link[32], name[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = ::readlink(link, name, sizeof name);
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (ssize_t i = 0; i < length; ++i) {
    hash = (hash ^ static_cast<unsigned char>(name[i])) * 0x100000001b3u;
  }
  return hash;
}

}  // namespace

FileStamp::FileStamp(int descriptor) noexcept : descriptor_(descriptor) {
  asked_ = ask(facts_);
  facts_.name = name_of(descriptor_);
}

bool FileStamp::ask(Facts& facts) const noexcept {
  struct stat now {};
  if (::fstat(descriptor_, &now) != 0) return false;
  facts.bytes = now.st_size;
  facts.written_s = now.st_mtim.tv_sec;
  facts.written_ns = now.st_mtim.tv_nsec;
  facts.changed_s = now.st_ctim.tv_sec;
  facts.changed_ns = now.st_ctim.tv_nsec;
  facts.links = now.st_nlink;
  facts.mode = now.st_mode;
  facts.owner = now.st_uid;
  facts.group = now.st_gid;
  return true;
}

bool FileStamp::changed() noexcept {
  if (descriptor_ < 0) return false;
  Facts now;
  if (!asked_ || !ask(now)) return true;
  if (now.bytes != facts_.bytes || now.written_s != facts_.written_s ||
      now.written_ns != facts_.written_ns) {
    return true;
  }
  if (now.changed_s == facts_.changed_s && now.changed_ns == facts_.changed_ns) return false;
  now.name = name_of(descriptor_);
  const bool explained = now.links != facts_.links || now.mode != facts_.mode ||
                         now.owner != facts_.owner || now.group != facts_.group ||
                         now.name != facts_.name;
  if (explained) facts_ = now;
  return !explained;
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
  // Before the size is known: whatever changes from here on is found.
  const FileStamp stamp = keep ? FileStamp(descriptor.number()) : FileStamp();
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
  file.stamp_ = stamp;
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
