#include "pointshell/verify.h"

#include <vector>

#include "pointshell/hidden_surface.h"
#include "pointshell/orientation.h"

namespace forcelayer {

CoveringProof verify_shell(const Pshell& shell, const Part& part) {
  const PshellView& view = shell.view();
  const auto& center_m = shell.header().center_m;
  std::vector<Vec3> points;
  points.reserve(view.point_count);
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    points.push_back({view.x[n], view.y[n], view.z[n]});
  }
  const double radius = shell.header().covering_radius_m;
  Part centred = relative_to(part, {center_m[0], center_m[1], center_m[2]});
  const CoveringProof proof = prove_covering(centred, points, radius);
  // What is not covered may still be hidden, where there is more than one body.
  if (proof.proven || part.body_names.size() < 2 || !orient_outwards(centred, radius)) return proof;
  const HiddenSurface hidden(centred);
  return hidden.possible() ? continue_proof(centred, points, radius, proof, &hidden) : proof;
}

}  // namespace forcelayer
