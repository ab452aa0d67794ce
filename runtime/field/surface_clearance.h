// From the contacts of one pose to the clearance of the exact surfaces of part and scene.
#pragma once

#include "forcelayer/step.h"
#include "runtime/field/contact_set.h"
#include "runtime/query/contact_query.h"

namespace forcelayer::field {

// A lower bound of a distance at one pose, and where it is.
struct PoseClearance {
  ClearanceKind kind = ClearanceKind::kNone;
  double clearance_m = 0;            // 0 where nothing is proven
  glm::dvec3 nearest_point_m{0};     // kProven: the shell point nearest to the scene, world
  std::uint32_t nearest_object = 0;  // kProven: the object nearest to that point; 0: not known
};

// The least distance of a shell point from the static mesh. `set`: what `probe` found with the
// part's centroid at `center_m`. Nothing where a point lies beyond a cropped side, is seated, or
// has no proven distance.
PoseClearance point_clearance(const ContactSet& set, const glm::dvec3& center_m,
                              const ContactProbe& probe) noexcept;

// From there to the exact surfaces: the shell's part of the proof (pshell_format.md, section 4),
// and what scene, part and pose may deviate by.
class SurfaceClearance {
 public:
  // The query's files must outlive this.
  explicit SurfaceClearance(const query::ContactQuery& query);

  // Makes the surfaces' clearance of that of the points. Nothing where it is not positive.
  void prove(ClearanceKind& kind, double& clearance_m) const noexcept;

 private:
  SurfaceDistanceTerms shell_;
  double deviations_m_;
};

}  // namespace forcelayer::field
