// An outside program: opens both files, asks what a point's voxel is and runs one contact query.
#include <cstdio>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/query/contact_query.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: consumer SCENE.vox PART.pshell\n");
    return 2;
  }
  const auto voxmap = forcelayer::Voxmap::open(argv[1]);
  const auto shell = forcelayer::Pshell::open(argv[2]);
  for (const auto* error : {voxmap ? nullptr : &voxmap.error(), shell ? nullptr : &shell.error()}) {
    if (error == nullptr) continue;
    std::fprintf(stderr, "consumer: %s\n", forcelayer::to_line(*error).c_str());
    return forcelayer::exit_status(error->code);
  }
  forcelayer::CollectedPoints points;
  points.reserve(shell->header().point_count);
  forcelayer::ContactQuery query(*voxmap, *shell);
  forcelayer::Pose world_from_center;
  for (int axis = 0; axis < 3; ++axis) {
    world_from_center.position_m[axis] = (double(voxmap->header().origin_voxel[axis]) +
                                          0.5 * double(voxmap->header().dims_voxels[axis])) *
                                         voxmap->voxel_size_m();
  }
  query.run(world_from_center, points);
  std::printf("%llu points, %u in the map's values 1-3\n",
              static_cast<unsigned long long>(shell->header().point_count), points.count);
  return 0;
}
