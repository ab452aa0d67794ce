// The one file of formats/ that includes OpenVDB; no_vdb.cpp replaces it in a build without.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <ostream>
#include <streambuf>

#include "formats/voxinfo/export.h"
#include "formats/voxinfo/output.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxinfo {
namespace {

using ValueTree = openvdb::tree::Tree4<std::uint8_t, 5, 4, 3>::Type;
using ValueGrid = openvdb::Grid<ValueTree>;

// A stream that ends in a BufferedOutput.
class OutputBuffer : public std::streambuf {
 public:
  explicit OutputBuffer(BufferedOutput& output) : output_(output) {}

 protected:
  std::streamsize xsputn(const char* text, std::streamsize count) override {
    output_.append(text, static_cast<std::size_t>(count));
    return count;
  }
  int_type overflow(int_type c) override {
    if (c == traits_type::eof()) return 0;
    const char byte = traits_type::to_char_type(c);
    output_.append(&byte, 1);
    return c;
  }

 private:
  BufferedOutput& output_;
};

bool fits_int32(const VoxmapHeader& h) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = h.directory_origin[axis];
    const std::int64_t high = low + std::int64_t{h.directory_dims[axis]} * kUpperNodeEdge;
    if (low < INT32_MIN || high > INT32_MAX) return false;
  }
  return true;
}

openvdb::Coord coord(const std::array<std::int64_t, 3>& voxel) {
  return {static_cast<std::int32_t>(voxel[0]), static_cast<std::int32_t>(voxel[1]),
          static_cast<std::int32_t>(voxel[2])};
}

void add_brick(const Voxmap& map, const VoxmapRegion& region, ValueTree& tree) {
  ValueTree::LeafNodeType* leaf = nullptr;
  for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
    const VoxelValue value = voxel_value(map.header(), brick_code(map.view(), region.entry, n));
    if (value == VoxelValue::kFree) continue;
    if (!leaf) leaf = tree.touchLeaf(coord(region.low));
    leaf->setValueOn(n, static_cast<std::uint8_t>(value));  // a leaf numbers voxels as a brick does
  }
}

ValueGrid::Ptr make_grid(const Voxmap& map) {
  auto grid = ValueGrid::create(0);
  grid->setName("voxmap");
  const double s = map.voxel_size_m();
  auto transform = openvdb::math::Transform::createLinearTransform(s);
  transform->postTranslate(openvdb::Vec3d(0.5 * s));  // OpenVDB's index is a voxel's center
  grid->setTransform(transform);
  for_each_region(map.view(), [&](const VoxmapRegion& region) {
    if (region.is_brick) {
      add_brick(map, region, grid->tree());
      return;
    }
    const VoxelValue value = voxel_value(map.header(), uniform_value(region.entry));
    if (value == VoxelValue::kFree) return;
    const openvdb::Coord low = coord(region.low);
    const auto last = static_cast<std::int32_t>(region.edge_voxels) - 1;
    grid->tree().sparseFill({low, low.offsetBy(last)}, static_cast<std::uint8_t>(value), true);
  });
  return grid;
}

}  // namespace

Status export_voxmap_vdb(const Voxmap& map, const std::string& out) {
  if (!fits_int32(map.header())) {
    return Error{ErrorCode::kUsage, out, "", "the scene's voxel indices do not fit a .vdb",
                 "export a .csv or bake nearer to the origin"};
  }
  openvdb::initialize();
  if (!ValueGrid::isRegistered()) ValueGrid::registerGrid();
  auto vdb = BufferedOutput::create(out);
  if (!vdb) return vdb.error();
  OutputBuffer buffer(*vdb);
  std::ostream stream(&buffer);
  openvdb::GridPtrVec grids{make_grid(map)};
  openvdb::io::Stream(stream).write(grids);
  return vdb->finish();
}

}  // namespace forcelayer::voxinfo
