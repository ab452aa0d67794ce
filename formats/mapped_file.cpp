#include "formats/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
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

// Closes a descriptor at the end of a scope.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }

 private:
  int number_;
};

}  // namespace

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  // O_NONBLOCK: a named pipe must be refused, not waited for.
  const Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (descriptor.number() < 0) return open_error(path, errno);
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
  if (status.st_size == 0) return file;
  const auto size = static_cast<std::size_t>(status.st_size);
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor.number(), 0);
  if (address == MAP_FAILED) return open_error(path, errno);
  file.bytes_ = {static_cast<const std::byte*>(address), size};
  return file;
}

}  // namespace forcelayer
