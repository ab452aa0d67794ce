#include "pointshell/verify.h"

#include <optional>
#include <utility>
#include <vector>

#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/normals/orientation.h"
#include "pointshell/part/copies.h"

namespace forcelayer::pointshell {
namespace {

// A file can claim a radius so small that no machine can look at all pieces of the part. A sound
// shell has about one point a piece, and a few times as many pieces of hidden surface.
std::size_t max_holes(std::size_t points, std::size_t triangles) {
  return 1'000'000 + 100 * points + triangles;
}

std::vector<part::Vec3> stored_points(const PshellView& view) {
  std::vector<part::Vec3> points;
  points.reserve(view.point_count);
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    points.push_back({view.x[n], view.y[n], view.z[n]});
  }
  return points;
}

part::Part centered_part(const Pshell& shell, part::Part part) {
  const auto& center_m = shell.header().center_m;
  return part::relative_to(std::move(part), {center_m[0], center_m[1], center_m[2]});
}

// The part as the bake had it. The losses of a piece depend on where it is bisected, and that on
// the order of its corners.
part::Part oriented_part(const Pshell& shell, part::Part part) {
  const PshellHeader& header = shell.header();
  std::vector<part::CopiedGroup> groups;
  if (header.method != static_cast<std::uint32_t>(ShellMethod::kVoxelCenters)) {
    groups = part::find_copies(part, header.covering_radius_m);
  }
  normals::orient_outwards(part, header.covering_radius_m, groups);
  return centered_part(shell, std::move(part));
}

}  // namespace

certificate::CoveringProof verify_shell(const Pshell& shell, const part::Part& part) {
  const std::vector<part::Vec3> points = stored_points(shell.view());
  const double radius = shell.header().covering_radius_m;
  part::Part centered = centered_part(shell, part);
  const certificate::CoveringProof proof = certificate::prove_covering(
      centered, points, radius, max_holes(points.size(), part.triangles.size()));
  // A part of several bodies may be open only where one body hides another.
  if (proof.proven || proof.given_up || part.body_names.size() < 2) return proof;
  normals::orient_outwards(centered, radius);
  const certificate::HiddenSurface hidden(centered);
  return hidden.possible() ? certificate::continue_proof(centered, points, radius, proof, &hidden)
                           : proof;
}

certificate::LossProof verify_losses(const Pshell& shell, const part::Part& part) {
  const std::vector<part::Vec3> points = stored_points(shell.view());
  const PshellHeader& header = shell.header();
  const part::Part centered = oriented_part(shell, part);
  std::optional<certificate::HiddenSurface> hidden;
  if (centered.body_names.size() > 1) hidden.emplace(centered);
  return certificate::prove_losses({centered, points, header.covering_radius_m, header.voxel_size_m,
                                    hidden ? &*hidden : nullptr},
                                   shell.surface_distance_terms());
}

}  // namespace forcelayer::pointshell
