#include "pointshell/verify.h"

#include <vector>

#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/normals/orientation.h"

namespace forcelayer {
namespace {

// A file can claim a radius so small that the part has more pieces than any machine can look at. A
// shell that is whole has about a point per piece, and hidden surface of a few times that.
std::size_t most_holes(std::size_t points, std::size_t triangles) {
  return 1'000'000 + 100 * points + triangles;
}

}  // namespace

CoveringProof verify_shell(const Pshell& shell, const Part& part) {
  const PshellView& view = shell.view();
  const auto& center_m = shell.header().center_m;
  std::vector<Vec3> points;
  points.reserve(view.point_count);
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    points.push_back({view.x[n], view.y[n], view.z[n]});
  }
  const double radius = shell.header().covering_radius_m;
  Part centered = relative_to(part, {center_m[0], center_m[1], center_m[2]});
  const CoveringProof proof =
      prove_covering(centered, points, radius, most_holes(points.size(), part.triangles.size()));
  // What is not covered may still be hidden, where there is more than one body.
  if (proof.proven || proof.given_up || part.body_names.size() < 2 ||
      !orient_outwards(centered, radius)) {
    return proof;
  }
  const HiddenSurface hidden(centered);
  return hidden.possible() ? continue_proof(centered, points, radius, proof, &hidden) : proof;
}

}  // namespace forcelayer
