#include "pointshell/verify.h"

#include <vector>

namespace forcelayer {

CoveringProof verify_shell(const Pshell& shell, const Part& part) {
  const PshellView& view = shell.view();
  const auto& center_m = shell.header().center_m;
  std::vector<Vec3> points;
  points.reserve(view.point_count);
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    points.push_back({view.x[n], view.y[n], view.z[n]});
  }
  return prove_covering(relative_to(part, {center_m[0], center_m[1], center_m[2]}), points,
                        shell.header().covering_radius_m);
}

}  // namespace forcelayer
