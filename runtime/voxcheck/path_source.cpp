#include "runtime/voxcheck/path_source.h"

namespace forcelayer::voxcheck {

Result<std::vector<PathRow>> read_part_path(const std::string& path) {
  return read_path(path, PathOf::kPart);
}

}  // namespace forcelayer::voxcheck
