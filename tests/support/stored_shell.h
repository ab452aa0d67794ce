// Baked shells as files hold them, and with a point taken out.
#pragma once

#include <vector>

#include "formats/pshell.h"
#include "formats/pshell_writer.h"
#include "pointshell/bake.h"
#include "pointshell/sample/order.h"
#include "tests/support/aligned_bytes.h"

namespace forcelayer::testing {

// Relative to the shell's center.
inline std::vector<part::Vec3> positions_of(const pointshell::BakedShell& shell) {
  std::vector<part::Vec3> points;
  for (std::size_t n = 0; n < shell.x.size(); ++n) {
    points.push_back({shell.x[n], shell.y[n], shell.z[n]});
  }
  return points;
}

// The same shell without point `removed`, its blocks made anew: a valid file in every other way.
inline pointshell::BakedShell without_point(pointshell::BakedShell shell, std::size_t removed) {
  for (std::vector<float>* values : {&shell.x, &shell.y, &shell.z, &shell.nx, &shell.ny, &shell.nz,
                                     &shell.weight_m2, &shell.cone_cos}) {
    values->erase(values->begin() + static_cast<std::ptrdiff_t>(removed));
  }
  const std::vector<part::Vec3> points = positions_of(shell);
  const std::size_t block = shell.header.block_points;
  shell.blocks = sample::bounding_spheres(points, block);
  shell.super_blocks = sample::bounding_spheres(points, block * shell.header.super_block_blocks);
  shell.header.point_count = points.size();
  shell.header.block_count = shell.blocks.size();
  shell.header.super_block_count = shell.super_blocks.size();
  return shell;
}

// Reads back what would be written. The bytes live as long as the program.
inline Pshell stored(const pointshell::BakedShell& shell) {
  static std::vector<AlignedBytes> kept;
  kept.push_back(AlignedBytes(pshell_bytes(shell.content())));
  return std::move(Pshell::from_bytes(kept.back().bytes(), "test")).value();
}

}  // namespace forcelayer::testing
