// From a clearance of the exact surfaces to the distance of shell points that proves it, and back
// (voxmap_format.md, section 7; pshell_format.md, section 4).
#pragma once

#include "formats/pshell.h"
#include "formats/surface_distance.h"
#include "formats/voxmap.h"

namespace forcelayer::clearance {

class RequiredDistance {
 public:
  RequiredDistance(const Voxmap& voxmap, const Pshell& shell, double required_m);

  // No shell point may be proven nearer to the static mesh than this.
  double voxels() const { return voxels_; }

  // The surfaces' clearance that is proven where no shell point is nearer than `voxels`, m.
  double clearance_m(double voxels) const;

  // By how much scene, part and arithmetic together may be off, m.
  double deviations_m() const { return deviations_m_; }

  // How far a shell point may be from the part's surface, m: voxel centers are not on it.
  double point_off_surface_m() const { return point_off_surface_m_; }

 private:
  SurfaceDistanceTerms terms_;
  double voxel_size_m_, deviations_m_, point_off_surface_m_, voxels_;
};

}  // namespace forcelayer::clearance
