// Prints every active voxel of a grid that voxinfo exported, `i,j,k,value`, and checks its
// transform; OpenVDB's own types alone are read:
//   vdb_rows FILE.vdb VOXEL_SIZE_M GRID
#include <openvdb/openvdb.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

template <typename Grid>
void print_rows(const Grid& grid) {
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    const openvdb::CoordBBox box = value.getBoundingBox();
    for (auto voxel = box.begin(); voxel; ++voxel) {
      const openvdb::Coord v = *voxel;
      std::printf("%d,%d,%d,%.9g\n", v.x(), v.y(), v.z(), static_cast<double>(*value));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  openvdb::initialize();
  openvdb::io::File file(argv[1]);
  file.open();
  if (!file.hasGrid(argv[3])) return 3;
  const openvdb::GridBase::Ptr grid = file.readGrid(argv[3]);
  const double s = std::atof(argv[2]);
  const openvdb::Vec3d center = grid->transform().indexToWorld(openvdb::Vec3d(-3, 0, 10));
  const openvdb::Vec3d expected(-2.5 * s, 0.5 * s, 10.5 * s);
  if ((center - expected).length() > 1e-12 * s) return 1;  // a few roundings of numbers near 10 s
  if (const auto integers = openvdb::gridPtrCast<openvdb::Int32Grid>(grid)) {
    print_rows(*integers);
  } else if (const auto numbers = openvdb::gridPtrCast<openvdb::FloatGrid>(grid)) {
    print_rows(*numbers);
  } else {
    return 4;
  }
  return 0;
}
