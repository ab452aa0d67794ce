#include "runtime/run/baked_files.h"

#include "runtime/machine/map_loss.h"

namespace forcelayer {
namespace {

template <typename Baked>
Result<Baked> open(const std::filesystem::path& path) {
  auto file = MappedFile::open_for_long(path);
  if (!file) return file.error();
  FileStamp stamp = file->stamp();
  const machine::WatchedMapping watch(file->bytes(), stamp);
  auto baked = Baked::from_file(std::move(*file), path.string(), Verify::kStructureAndChecksums);
  if (baked && (watch.lost() || stamp.changed())) {
    return Error{ErrorCode::kTruncated, path.string(), "",
                 "was cut short or written to while it was being read",
                 "bake it again, into a new file"};
  }
  return baked;
}

}  // namespace

Result<Voxmap> open_scene(const std::filesystem::path& path) { return open<Voxmap>(path); }

Result<Pshell> open_part(const std::filesystem::path& path) { return open<Pshell>(path); }

}  // namespace forcelayer
