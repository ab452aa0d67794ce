#include "runtime/run/baked_files.h"

#include "formats/audit/voxmap_audit.h"
#include "formats/digest/file_digest.h"
#include "runtime/machine/map_loss.h"

namespace forcelayer {
namespace {

Status audit(const Voxmap& map, std::string_view name) { return audit_voxmap(map, name); }
Status audit(const Pshell&, std::string_view) { return {}; }  // reading it has proven all of it

template <typename Baked>
Result<Baked> open(const std::filesystem::path& path, std::span<const std::string> expected) {
  auto file = MappedFile::open_for_long(path);
  if (!file) return file.error();
  FileStamp stamp = file->stamp();
  const machine::WatchedMapping watch(file->bytes(), stamp);
  if (Status s = digest::check_expected(*file, expected, path.string()); !s) return s.error();
  auto baked = Baked::from_file(std::move(*file), path.string(), Verify::kStructureAndChecksums);
  if (baked) {
    if (Status s = audit(*baked, path.string()); !s && !watch.lost()) return s.error();
  }
  if (baked && (watch.lost() || stamp.changed())) {
    return Error{ErrorCode::kTruncated, path.string(), "",
                 "was cut short or written to while it was being read",
                 "bake it again, into a new file"};
  }
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
