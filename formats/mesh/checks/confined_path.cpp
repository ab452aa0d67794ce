#include "formats/mesh/checks/confined_path.h"

#include <algorithm>
#include <system_error>

namespace forcelayer::mesh {

namespace fs = std::filesystem;

bool lies_under(const fs::path& file, const fs::path& folder) {
  std::error_code failure;
  const fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, failure);
  if (failure) return false;
  const fs::path real = fs::weakly_canonical(fs::absolute(file, failure), failure);
  if (failure) return false;
  return std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first == root.end();
}

}  // namespace forcelayer::mesh
