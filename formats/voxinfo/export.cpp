#include "formats/voxinfo/export.h"

#include <charconv>
#include <cmath>
#include <filesystem>

#include "formats/voxinfo/occupied_boxes.h"
#include "formats/voxinfo/output.h"
#include "formats/voxinfo/surface.h"
#include "formats/voxmap_walk.h"

namespace forcelayer::voxinfo {
namespace {

void append_row(BufferedOutput& csv, const std::array<std::int64_t, 3>& voxel, VoxelValue value) {
  char row[80];
  char* end = row;
  for (const std::int64_t index : voxel) {
    end = std::to_chars(end, row + sizeof row, index).ptr;
    *end++ = ',';
  }
  *end++ = static_cast<char>('0' + static_cast<int>(value));
  *end++ = '\n';
  csv.append(row, static_cast<std::size_t>(end - row));
}

void append_uniform_box(BufferedOutput& csv, const VoxmapRegion& region, VoxelValue value) {
  const std::int64_t edge = region.edge_voxels;
  for (std::int64_t x = 0; x < edge; ++x) {
    for (std::int64_t y = 0; y < edge; ++y) {
      if (csv.failed()) return;
      for (std::int64_t z = 0; z < edge; ++z) {
        append_row(csv, {region.low[0] + x, region.low[1] + y, region.low[2] + z}, value);
      }
    }
  }
}

Error unfit(const std::string& out, const char* what, const char* mend) {
  return {ErrorCode::kUsage, out, "", what, mend};
}

bool is_surface(const std::string& ending) {
  return ending == ".stl" || ending == ".glb" || ending == ".ply";
}

Status export_surface(const Voxmap& map, const std::string& path, const std::string& out,
                      const std::string& ending, double offset_m) {
  const auto surface = solid_surface(map, offset_m, ending != ".ply", path);
  if (!surface) return surface.error();
  if (ending == ".stl") return write_stl(*surface, out);
  return ending == ".glb" ? write_surface_glb(*surface, out) : write_ply(*surface, out);
}

}  // namespace

Status export_baked_file(const BakedFile& file, const std::string& path, const std::string& out,
                         std::optional<double> offset_m) {
  const std::string ending = std::filesystem::path(out).extension().string();
  const Voxmap* map = std::get_if<Voxmap>(&file);
  if (map != nullptr && is_surface(ending)) {
    return export_surface(*map, path, out, ending, offset_m.value_or(0));
  }
  if (offset_m) {
    return Error{ErrorCode::kUsage, "", "--offset", "applies only to the surface of a scene",
                 "leave it out, or export a scene to .stl, .glb or .ply"};
  }
  if (map == nullptr) {
    if (ending == ".ply") return export_pshell_ply(std::get<Pshell>(file), out);
    return unfit(out, "a part can be exported to .ply", "choose a name that ends in .ply");
  }
  if (ending == ".csv") return export_voxmap_csv(*map, out);
  if (ending == ".vdb") return export_voxmap_vdb(*map, out);
  return unfit(out, "a scene can be exported to .stl, .glb, .ply, .csv or .vdb",
               "choose one of these endings");
}

Status export_voxmap_csv(const Voxmap& map, const std::string& out) {
  const auto occupied = occupied_boxes(map);
  const double steps = occupied.steps([](std::uint32_t value, std::uint32_t edge) {
    return value == static_cast<std::uint32_t>(VoxelValue::kFree) ? 0 : std::pow(edge, 3);
  });
  if (Status s = check_walk(steps, out); !s) return s;
  auto csv = BufferedOutput::create(out);
  if (!csv) return csv.error();
  csv->append("i,j,k,value\n");
  for_each_region_where(map.view(), occupied, [&](const VoxmapRegion& region) {
    if (!region.is_brick) {
      const VoxelValue value = static_cast<VoxelValue>(uniform_value(region.entry));
      if (value != VoxelValue::kFree) append_uniform_box(*csv, region, value);
      return;
    }
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      const VoxelValue value = static_cast<VoxelValue>(map.view().brick_code(region.entry, n));
      if (value == VoxelValue::kFree) continue;
      append_row(*csv, voxmap_walk::child_low(region.low, n, 1), value);
    }
  });
  return csv->finish();
}

}  // namespace forcelayer::voxinfo
