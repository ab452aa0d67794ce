// make_runtime_files FOLDER: writes floor.vox (a slab, 5 mm voxels, two layers: the force layer is
// z in [10, 15) mm), unlayered.vox (the same without layers), ball.pshell (a sphere of 20 mm),
// coarse.pshell (the same, a covering radius of two voxels), press.csv (a hand that comes down on
// the slab, slides and leaves), repeated.vox (a brick that stands in 29 billion positions) in
// FOLDER.
#include <cstdio>
#include <fstream>

#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kVoxelSizeM = 0.005;

void write_motion(const std::filesystem::path& path) {
  std::ofstream file(path);
  file << "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n"
          "0,0.1,0.1,0.06,1,0,0,0\n"
          "0.2,0.1,0.1,0.03,1,0,0,0\n"
          "0.5,0.14,0.1,0.03,0.98,0,0,0.2\n"
          "0.7,0.14,0.1,0.07,1,0,0,0\n";
}

// One brick with a voxel of force layer, in every entry of every node.
void write_repeated(const std::filesystem::path& path) {
  constexpr std::uint32_t kCells = 60, kLongBrick = 16 * kObjectBits;
  const std::vector<std::uint32_t> directory(kCells * kCells * kCells, 0), node(kNodeEntries, 0);
  std::vector<std::uint32_t> values(16 * kValueBits, 0);
  values[5] = static_cast<std::uint32_t>(VoxelValue::kSurface);
  const std::vector<std::uint32_t> codes(16 * kDistanceBits, 0x32323232), objects(kLongBrick, 1);
  VoxmapContent content;
  VoxmapHeader& h = content.header;
  h.voxel_size_m = 0.001;
  h.offset_layers = 1;
  h.metric = static_cast<std::uint32_t>(Metric::kEuclidean);
  h.zero_force_m = 0.002;
  h.force_depth_m = 0.001;
  h.distance_quantum_m = 0.00001;
  h.distance_zero_code = 100;
  h.object_count = 1;
  h.directory_dims = {kCells, kCells, kCells};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    h.dims_voxels[axis] = 512 * kCells;
    h.valid_max_voxel[axis] = 512 * kCells;
  }
  h.surface_voxels = 1;
  content.values = {directory, node, node, values};
  content.distances = {directory, node, node, codes};
  content.objects = {directory, node, node, objects};
  content.object_names = std::string_view("\0", 1);
  save_bytes(path, voxmap_bytes(content));
}

int run(const std::filesystem::path& folder) {
  const auto slab = [](Voxel v) { return v[2] <= 0; };
  VoxelScene floor = offset_scene(kVoxelSizeM, {0, 0, -2}, {48, 40, 8}, 2, slab);
  save_voxmap(folder / "floor.vox", closed(floor));
  save_voxmap(folder / "unlayered.vox",
              closed(offset_scene(kVoxelSizeM, {0, 0, -2}, {48, 40, 8}, 0, slab)));
  PointPart ball = sphere_part(0.02, 400, kVoxelSizeM);
  save_pshell(folder / "ball.pshell", ball);
  ball.covering_radius_m = 2 * kVoxelSizeM;
  save_pshell(folder / "coarse.pshell", ball);
  write_motion(folder / "press.csv");
  write_repeated(folder / "repeated.vox");
  return 0;
}

}  // namespace
}  // namespace forcelayer::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: make_runtime_files FOLDER\n");
    return 2;
  }
  return forcelayer::test::run(argv[1]);
}
