// A shell in an OpenVDB level set as people use it: every point looked up through a value accessor,
// interpolated trilinearly by OpenVDB's box sampler, none skipped.
#pragma once

#include <openvdb/openvdb.h>

#include "forcelayer/pose.h"
#include "tests/bench/wrench_bench_dense.h"
#include "tests/bench/wrench_bench_shell.h"

namespace forcelayer::bench {

class LevelSetFrame {
 public:
  // Holds the same distances as the dense array. The shell must outlive this. Points nearer than
  // `offset_m` press along the gradient, by their area over its mean.
  LevelSetFrame(const DenseDistances& distances, const AnalyticShell& shell, double voxel_size_m,
                double offset_m);

  Wrench at(const Pose& world_from_center) const;

 private:
  openvdb::FloatGrid::Ptr distance_m_;
  const AnalyticShell& shell_;
  double s_, offset_m_, mean_area_m2_;
};

}  // namespace forcelayer::bench
