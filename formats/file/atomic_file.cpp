#include "formats/file/atomic_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "formats/file/descriptor.h"
#include "formats/file/temporary_files.h"

namespace forcelayer {
namespace {

namespace fs = std::filesystem;

// The number N of a path like /dev/fd/N, which names an open descriptor of this process. Such a
// target is written to through the descriptor: its file must be neither opened anew nor replaced.
std::optional<int> descriptor_number(const fs::path& path) {
  const fs::path folder = path.parent_path();
  if (folder != "/proc/self/fd" && folder != "/dev/fd") return std::nullopt;
  const std::string name = path.filename().string();
  int number = -1;
  const auto [end, failure] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (failure != std::errc{} || end != name.data() + name.size()) return std::nullopt;
  return number;
}

// The end of a chain of symbolic links, whether or not a file exists there; /dev/stdout ends at
// /proc/self/fd/1.
fs::path follow_links(fs::path path) {
  constexpr int kMaxLinks = 40;  // as the kernel
  std::error_code failure;
  for (int i = 0; i < kMaxLinks && !descriptor_number(path); ++i) {
    if (!fs::is_symlink(path, failure)) break;
    const fs::path next = fs::read_symlink(path, failure);
    if (failure) break;
    path = path.parent_path() / next;  // an absolute `next` replaces the folder
  }
  return path;
}

// ".NAME.RANDOM.tmp" beside the target: random, so that two machines on one share never collide.
fs::path temporary_name(const fs::path& target) {
  std::uint64_t random = 0;
  if (::getrandom(&random, sizeof random, 0) != sizeof random) {
    random = static_cast<std::uint64_t>(::getpid());
  }
  char suffix[32];
  std::snprintf(suffix, sizeof suffix, ".%016" PRIx64 ".tmp", random);
  constexpr std::size_t kMaxStem = 200;  // names end at 255 bytes
  const std::string stem = target.filename().string().substr(0, kMaxStem);
  return target.parent_path() / ("." + stem + suffix);
}

}  // namespace

AtomicFile::AtomicFile(AtomicFile&& other) noexcept { *this = std::move(other); }

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(temporary_, other.temporary_);
  std::swap(target_, other.target_);
  std::swap(shown_, other.shown_);
  std::swap(slot_, other.slot_);
  return *this;
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::discard() noexcept {
  if (descriptor_ < 0) return;
  ::close(std::exchange(descriptor_, -1));
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  unregister_temporary_file(slot_);
}

Error AtomicFile::write_error(int number) const {
  const char* mend = number == ENOSPC || number == EDQUOT ? "free some space, or write elsewhere"
                     : number == ENOENT                   ? "create the folder first"
                                                          : "";
  return {ErrorCode::kWriteFailed, shown_.string(), "",
          "cannot be written: " + std::generic_category().message(number), mend};
}

Result<AtomicFile> AtomicFile::open(const fs::path& target, bool opens_streams) {
  AtomicFile file;
  file.shown_ = target;
  if (target.empty()) return file.write_error(ENOENT);
  file.target_ = follow_links(target);
  if (const auto number = descriptor_number(file.target_)) {
    file.descriptor_ = ::fcntl(*number, F_DUPFD_CLOEXEC, 0);
    if (file.descriptor_ < 0) return file.write_error(errno);
    return file;
  }
  struct stat status {};
  const bool exists = ::stat(file.target_.c_str(), &status) == 0;
  if (!exists && errno != ENOENT) return file.write_error(errno);
  if (exists && S_ISDIR(status.st_mode)) return file.write_error(EISDIR);
  if (exists && !S_ISREG(status.st_mode)) {
    const char* const stream = file.target_.c_str();
    if (opens_streams) file.descriptor_ = ::open(stream, O_WRONLY | O_CLOEXEC);
    const bool is_ours = opens_streams ? file.descriptor_ >= 0
                                       : ::faccessat(AT_FDCWD, stream, W_OK, AT_EACCESS) == 0;
    if (!is_ours) return file.write_error(errno);
    return file;
  }
  if (Status opened = file.open_temporary(); !opened) return opened.error();
  if (exists) file.take_over(status);
  return file;
}

Result<AtomicFile> AtomicFile::create(const fs::path& target) { return open(target, true); }

Status AtomicFile::can_create(const fs::path& target) {
  const auto opened = open(target, false);
  return opened ? Status() : opened.error();
}

Status AtomicFile::open_temporary() {
  temporary_ = temporary_name(target_);
  // Registered before it exists: there is no moment at which a signal would leave it behind.
  slot_ = register_temporary_file(temporary_.c_str());
  if (slot_ == kNoSlot) {
    return Error{ErrorCode::kInternal, shown_.string(), "",
                 "too many files are being written at once", ""};
  }
  int number = 0;
  {
    const TemporaryFileCreation creation;
    descriptor_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    number = errno;
  }
  if (descriptor_ < 0) {
    unregister_temporary_file(slot_);
    return write_error(number);
  }
  return {};
}

// Only root may give a file away; a member of a group may give it to the group.
void AtomicFile::take_over(const struct stat& old) noexcept {
  struct stat own {};
  if (::fstat(descriptor_, &own) != 0) return;
  const bool same_owner = own.st_uid == old.st_uid && own.st_gid == old.st_gid;
  if (!same_owner && ::fchown(descriptor_, old.st_uid, old.st_gid) != 0 &&
      ::fchown(descriptor_, own.st_uid, old.st_gid) != 0) {
    ::fchmod(descriptor_, own.st_mode & old.st_mode & 0777);
    return;  // another group's rights are not for ours
  }
  ::fchmod(descriptor_, old.st_mode & 0777);
}

Status AtomicFile::write(std::span<const std::byte> bytes) {
  const int failed = write_all(descriptor_, bytes);
  if (failed != 0) return write_error(failed);
  return {};
}

Status AtomicFile::commit(ReaderCheck check) {
  if (temporary_.empty()) return commit();  // written to directly: it cannot be read back
  // Mapped, where files of others are read: what is being written may fill the memory already, and
  // nobody else knows this file's name.
  const off_t end = ::lseek(descriptor_, 0, SEEK_END);
  if (end < 0) return write_error(errno);
  const auto size = static_cast<std::size_t>(end);
  void* const address =
      size > 0 ? ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor_, 0) : nullptr;
  if (address == MAP_FAILED) return write_error(errno);
  const auto unmap = [size](void* written) { ::munmap(written, size); };
  const std::unique_ptr<void, decltype(unmap)> written(address, unmap);
  const std::span bytes(static_cast<const std::byte*>(address), size);
  if (Status sound = check(bytes, shown_.string()); !sound) {
    return refused(to_line(sound.error()));
  }
  return commit();
}

Error AtomicFile::refused(std::string_view why) const {
  return {ErrorCode::kInternal, shown_.string(), "",
          "was not written, because its new content would not be a valid file: " + std::string(why),
          "report this error with the input file"};
}

Status AtomicFile::commit() {
  if (temporary_.empty()) {
    if (::close(std::exchange(descriptor_, -1)) != 0) return write_error(errno);
    return {};
  }
  if (::fsync(descriptor_) != 0) return write_error(errno);
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) return write_error(errno);
  unregister_temporary_file(slot_);
  const int closed = ::close(std::exchange(descriptor_, -1));
  if (closed != 0) return write_error(errno);
  // The rename itself must survive a power cut. Some file systems cannot flush a folder: then the
  // rename is as durable as they make it.
  const fs::path parent = target_.parent_path();
  const int folder = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_CLOEXEC);
  if (folder >= 0) {
    ::fsync(folder);
    ::close(folder);
  }
  return {};
}

}  // namespace forcelayer
