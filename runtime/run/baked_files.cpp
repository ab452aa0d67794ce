#include "runtime/run/baked_files.h"

#include "formats/audit/voxmap_audit.h"
#include "formats/digest/file_digest.h"

namespace forcelayer {
namespace {

Status audit(const Voxmap& map, std::string_view name) { return audit_voxmap(map, name); }
Status audit(const Pshell&, std::string_view) { return {}; }  // reading it has proven all of it

template <typename Baked>
Result<Baked> open(const std::filesystem::path& path, std::span<const std::string> expected) {
  auto file = FileBytes::read(path);
  if (!file) return file.error();
  if (Status s = digest::check_expected(file->bytes(), expected, path.string()); !s) {
    return s.error();
  }
  auto baked = Baked::from_file(std::move(*file), path.string(), Verify::kStructureAndChecksums);
  if (!baked) return baked;
  if (Status s = audit(*baked, path.string()); !s) return s.error();
  return baked;
}

}  // namespace

Result<Voxmap> open_scene(const std::filesystem::path& path,
                          std::span<const std::string> expected) {
  return open<Voxmap>(path, expected);
}

Result<Pshell> open_part(const std::filesystem::path& path, std::span<const std::string> expected) {
  return open<Pshell>(path, expected);
}

}  // namespace forcelayer
