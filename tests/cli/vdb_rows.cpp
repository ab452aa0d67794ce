// Prints every active voxel of a .vdb that voxinfo exported, `i,j,k,value`, and checks its
// transform:
//   vdb_rows FILE.vdb VOXEL_SIZE_M
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  using Tree = openvdb::tree::Tree4<std::uint8_t, 5, 4, 3>::Type;
  openvdb::initialize();
  openvdb::Grid<Tree>::registerGrid();
  openvdb::io::File file(argv[1]);
  file.open();
  const auto grid = openvdb::gridPtrCast<openvdb::Grid<Tree>>(file.readGrid("voxmap"));
  const double s = std::atof(argv[2]);
  const openvdb::Vec3d center = grid->indexToWorld(openvdb::Vec3d(-3, 0, 10));
  const openvdb::Vec3d expected(-2.5 * s, 0.5 * s, 10.5 * s);
  if ((center - expected).length() > 1e-12 * s) return 1;  // a few roundings of numbers near 10 s
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    const openvdb::CoordBBox box = value.getBoundingBox();
    for (auto voxel = box.begin(); voxel; ++voxel) {
      const openvdb::Coord v = *voxel;
      std::printf("%d,%d,%d,%d\n", v.x(), v.y(), v.z(), *value);
    }
  }
  return 0;
}
