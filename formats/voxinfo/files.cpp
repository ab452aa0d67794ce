#include "formats/voxinfo/files.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace forcelayer::voxinfo {
namespace {

bool is_pshell(std::span<const std::byte> bytes, const std::filesystem::path& path) {
  const std::size_t present = std::min(bytes.size(), kPshellMagic.size());
  if (present == kPshellMagic.size() &&
      std::memcmp(bytes.data(), kVoxmapMagic.data(), present) == 0) {
    return false;
  }
  return (present == kPshellMagic.size() &&
          std::memcmp(bytes.data(), kPshellMagic.data(), present) == 0) ||
         path.extension() == ".pshell";
}

template <typename File>
Result<BakedFile> as_baked_file(Result<File> file) {
  if (!file) return file.error();
  return BakedFile(std::move(*file));
}

}  // namespace

Result<BakedFile> open_baked_file(const std::string& path, Verify verify) {
  auto file = FileBytes::read(path);
  if (!file) return file.error();
  return is_pshell(file->bytes(), path)
             ? as_baked_file(Pshell::from_file(std::move(*file), path, verify))
             : as_baked_file(Voxmap::from_file(std::move(*file), path, verify));
}

}  // namespace forcelayer::voxinfo
