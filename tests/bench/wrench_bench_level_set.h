// A shell in a trilinear OpenVDB level set, every point looked up: what a distance field instead of
// the voxmap would give.
#pragma once

#include <openvdb/openvdb.h>

#include "forcelayer/pose.h"
#include "tests/bench/force_bench_shell.h"

namespace forcelayer::bench {

class LevelSetFrame {
 public:
  // `distance_m`: at the centers of world voxels. The shell must outlive this. Points nearer than
  // `offset_m` press along the gradient, by their area.
  LevelSetFrame(openvdb::FloatGrid::Ptr distance_m, const AnalyticShell& shell, double voxel_size_m,
                double offset_m);

  Wrench at(const Pose& world_from_center) const;

 private:
  openvdb::FloatGrid::Ptr distance_m_;
  const AnalyticShell& shell_;
  double s_, offset_m_;
};

}  // namespace forcelayer::bench
