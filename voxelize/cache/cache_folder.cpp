#include "voxelize/cache/cache_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include "formats/file/descriptor.h"
#include "formats/file/temporary_files.h"

namespace forcelayer::cache {
namespace {

constexpr std::array<unsigned char, 8> kMagic = {0x89, 'F', 'L', 'C', '\r', '\n', 0x1a, '\n'};
constexpr const char* kTemporaryFolder = "tmp";
constexpr std::time_t kLeftoverAgeS = 3600;    // a writer takes seconds
constexpr std::time_t kTouchAgeS = 24 * 3600;  // used entries get a new time once a day

struct EntryHeader {
  std::array<unsigned char, 8> magic = kMagic;
  std::uint32_t endian_tag = 0x01020304;
  std::uint32_t version = 1;
  std::array<char, 8> kind{};  // zero-padded
  Digest key;
  std::uint64_t content_bytes = 0;
  Digest content;

  bool operator==(const EntryHeader&) const = default;
};
static_assert(sizeof(EntryHeader) == 64);

EntryHeader header_of(const char* kind, const Digest& key, std::span<const std::byte> content) {
  EntryHeader header;
  std::memcpy(header.kind.data(), kind, std::min(std::strlen(kind), header.kind.size()));
  header.key = key;
  header.content_bytes = content.size();
  header.content = digest_of(content);
  return header;
}

std::string sub_folder(const Digest& key) { return key.hex().substr(0, 2); }

// A folder inside the cache, itself no link.
int open_folder(int parent, const char* name) {
  return ::openat(parent, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

// Entries in use look young, so that old ones can be removed by their time.
void touch(int descriptor, const struct stat& status) {
  if (std::time(nullptr) - status.st_mtime > kTouchAgeS) ::futimens(descriptor, nullptr);
}

std::string random_name() {
  Digest random;
  if (::getrandom(&random, sizeof random, 0) != sizeof random) {
    random = {static_cast<std::uint64_t>(::getpid()),
              static_cast<std::uint64_t>(std::time(nullptr))};
  }
  return random.hex();
}

}  // namespace

CacheFolder::CacheFolder(CacheFolder&& other) noexcept
    : path_(std::move(other.path_)),
      folder_(std::exchange(other.folder_, -1)),
      trouble_(std::move(other.trouble_)) {}

CacheFolder::~CacheFolder() {
  if (folder_ >= 0) ::close(folder_);
}

Result<CacheFolder> CacheFolder::open(const std::string& path) {
  const auto failure = [&](int number) {
    return Error{ErrorCode::kWriteFailed, path, "",
                 "cannot be used as a cache: " + std::generic_category().message(number),
                 "name a folder that can be written to"};
  };
  std::error_code made;
  std::filesystem::create_directories(path, made);
  if (made) return failure(made.value());
  // The path itself is the user's: a link there is followed.
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return failure(errno);
  CacheFolder cache(path, folder);
  if (::mkdirat(folder, kTemporaryFolder, 0777) != 0 && errno != EEXIST && errno != EROFS &&
      errno != EACCES) {
    return failure(errno);
  }
  cache.remove_leftovers();
  return cache;
}

void CacheFolder::remove_leftovers() const {
  const int descriptor = open_folder(folder_, kTemporaryFolder);
  if (descriptor < 0) return;
  DIR* files = ::fdopendir(descriptor);
  if (files == nullptr) {
    ::close(descriptor);
    return;
  }
  while (const dirent* file = ::readdir(files)) {
    struct stat status {};
    if (::fstatat(descriptor, file->d_name, &status, AT_SYMLINK_NOFOLLOW) != 0) continue;
    if (!S_ISREG(status.st_mode) || std::time(nullptr) - status.st_mtime < kLeftoverAgeS) continue;
    ::unlinkat(descriptor, file->d_name, 0);
  }
  ::closedir(files);
}

std::optional<CacheEntry> CacheFolder::find(const char* kind, const Digest& key) const {
  const Descriptor sub(open_folder(folder_, sub_folder(key).c_str()));
  if (!sub.valid()) return std::nullopt;
  const std::string name = key.hex() + "." + kind;
  // O_NONBLOCK: a named pipe is not waited for.
  const Descriptor file(
      ::openat(sub.number(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status {};
  if (!file.valid() || ::fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return std::nullopt;
  }
  auto bytes = FileBytes::read(file.number(), name);
  if (!bytes || bytes->bytes().size() < sizeof(EntryHeader)) return std::nullopt;
  EntryHeader header;
  std::memcpy(&header, bytes->bytes().data(), sizeof header);
  CacheEntry entry(std::move(*bytes), sizeof header);
  if (header != header_of(kind, key, entry.bytes())) return std::nullopt;
  touch(file.number(), status);
  return entry;
}

void CacheFolder::keep(const char* kind, const Digest& key,
                       std::span<const std::byte> content) const {
  const std::string temporary = random_name();
  const std::string full_path = path_ + "/" + kTemporaryFolder + "/" + temporary;
  // Not flushed to the disk: an entry that a power cut damages is found by its checksum.
  const std::size_t slot = register_temporary_file(full_path.c_str());
  const Descriptor folder(open_folder(folder_, kTemporaryFolder));
  const Descriptor file = [&] {
    const TemporaryFileCreation creation;
    return Descriptor(::openat(folder.number(), temporary.c_str(),
                               O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
  }();
  const EntryHeader header = header_of(kind, key, content);
  bool done = file.valid() && write_all(file.number(), std::as_bytes(std::span(&header, 1))) == 0 &&
              write_all(file.number(), content) == 0;
  if (done) {
    const std::string sub_name = sub_folder(key);
    ::mkdirat(folder_, sub_name.c_str(), 0777);
    const Descriptor sub(open_folder(folder_, sub_name.c_str()));
    const std::string name = key.hex() + "." + kind;
    done = sub.valid() &&
           ::renameat(folder.number(), temporary.c_str(), sub.number(), name.c_str()) == 0;
  }
  if (!done) note_trouble(errno);
  if (!done && file.valid()) ::unlinkat(folder.number(), temporary.c_str(), 0);
  unregister_temporary_file(slot);
}

void CacheFolder::note_trouble(int number) const {
  const std::lock_guard lock(mutex_);
  if (!trouble_) trouble_ = path_ + ": " + std::generic_category().message(number);
}

std::optional<std::string> CacheFolder::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

}  // namespace forcelayer::cache
