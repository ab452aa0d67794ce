// The one file of formats/ that includes OpenVDB; no_libraries.cpp replaces it in a build without.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <cstdio>
#include <ostream>
#include <streambuf>

#include "formats/voxinfo/export.h"
#include "formats/voxinfo/occupied_boxes.h"
#include "formats/voxinfo/output.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxinfo {
namespace {

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

// A grid of the elements that are not `background`, as value(element).
template <typename Grid, std::uint32_t kBits, typename Value>
typename Grid::Ptr make_grid(const char* name, double voxel_size_m, const TreeView<kBits>& view,
                             const OccupiedBoxes<kBits>& occupied, std::uint32_t background,
                             Value value) {
  using Stored = typename Grid::ValueType;
  const auto stored = [&](std::uint32_t element) { return static_cast<Stored>(value(element)); };
  auto grid = Grid::create(stored(background));
  grid->setName(name);
  auto transform = openvdb::math::Transform::createLinearTransform(voxel_size_m);
  // OpenVDB's index is a voxel's center.
  transform->postTranslate(openvdb::Vec3d(0.5 * voxel_size_m));
  grid->setTransform(transform);
  for_each_region_where(view, occupied, [&](const VoxmapRegion& region) {
    const openvdb::Coord low = coord(region.low);
    if (!region.is_brick) {
      const std::uint32_t element = TreeView<kBits>::uniform(region.entry, 1).code;
      if (element == background) return;
      const auto last = static_cast<std::int32_t>(region.edge_voxels) - 1;
      grid->tree().sparseFill({low, low.offsetBy(last)}, stored(element), true);
      return;
    }
    typename Grid::TreeType::LeafNodeType* leaf = nullptr;
    const auto elements = view.brick_codes(region.entry);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const std::uint32_t element = elements[n];
      if (element == background) continue;
      if (!leaf) leaf = grid->tree().touchLeaf(low);
      leaf->setValueOn(n, stored(element));  // a leaf numbers voxels as a brick does
    }
  });
  return grid;
}

OccupiedBoxes<kDistanceBits> measured_boxes(const Voxmap& map) {
  return {*map.distances(), map.distance_counts(), kMaxDistanceCode};
}
OccupiedBoxes<kObjectBits> named_boxes(const Voxmap& map) {
  return {*map.objects(), map.object_counts(), 0};
}

// Refuses grids that this machine cannot hold: each voxel of a brick is a number of its own there.
Status check_memory(const Voxmap& map, const std::string& out) {
  const auto in_tile = [](std::uint32_t, std::uint32_t) { return 0; };
  double voxels = occupied_boxes(map).steps(in_tile);
  if (map.distances() != nullptr) voxels += measured_boxes(map).steps(in_tile);
  if (map.objects() != nullptr) voxels += named_boxes(map).steps(in_tile);
  const double bytes = sizeof(float) * voxels;
  const double physical_bytes =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (bytes <= physical_bytes) return check_walk(voxels, out);
  char what[120];
  std::snprintf(what, sizeof what,
                "the grids take up to %.2g GB of memory, but this machine has %.2g GB", bytes / 1e9,
                physical_bytes / 1e9);
  return Error{ErrorCode::kUsage, out, "", what, "export a .csv, or bake a smaller region (--roi)"};
}

openvdb::GridPtrVec make_grids(const Voxmap& map) {
  const auto itself = [](std::uint32_t element) { return element; };
  const double s = map.voxel_size_m();
  openvdb::GridPtrVec grids{
      make_grid<openvdb::Int32Grid>("voxmap", s, map.view(), occupied_boxes(map), 0, itself)};
  if (map.distances() != nullptr) {
    const VoxmapHeader& h = map.header();
    grids.push_back(make_grid<openvdb::FloatGrid>(
        "distance_m", s, *map.distances(), measured_boxes(map), kMaxDistanceCode,
        [&](std::uint32_t code) {
          // Code 0 has no lower bound: here it stands for the step that it ends.
          return (static_cast<double>(code) - h.distance_zero_code) * h.distance_quantum_m;
        }));
  }
  if (map.objects() != nullptr) {
    grids.push_back(
        make_grid<openvdb::Int32Grid>("object", s, *map.objects(), named_boxes(map), 0, itself));
  }
  return grids;
}

}  // namespace

Status export_voxmap_vdb(const Voxmap& map, const std::string& out) {
  if (!fits_int32(map.header())) {
    return Error{ErrorCode::kUsage, out, "", "the scene's voxel indices are too large for a .vdb",
                 "export a .csv, or bake a scene that is nearer to the origin"};
  }
  if (Status s = check_memory(map, out); !s) return s;
  openvdb::initialize();
  auto vdb = BufferedOutput::create(out);
  if (!vdb) return vdb.error();
  OutputBuffer buffer(*vdb);
  std::ostream stream(&buffer);
  openvdb::io::Stream(stream).write(make_grids(map));
  return vdb->finish();
}

}  // namespace forcelayer::voxinfo
