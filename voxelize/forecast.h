// A bake's memory and time, said before it begins and without a bake: from the area of its
// surfaces.
//
// The voxels of a surface outweigh all else where a bake is large; `--plan` extrapolates file and
// time far better, from two bakes.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "formats/mesh/mesh.h"
#include "formats/mesh/scene.h"
#include "formats/result.h"
#include "voxelize/bake_options.h"
#include "voxelize/cache/mesh_source.h"

namespace forcelayer::voxelize {

struct Forecast {
  mesh::Box box_m{};            // of the scene; empty where it has no objects
  double surface_voxels = 0;    // the area of what is baked, in faces of a voxel
  double memory_bytes = 0;      // about as much at the peak
  double min_memory_bytes = 0;  // no bake of this surface takes less
  double bake_s = 0;            // about, on as many threads as the bake has, without a cache
  double largest_unit_m = 0;    // of the files
};

// "the scene is 745 m across; if the unit of the files is the millimeter, add --units mm": the
// likeliest mistake is meters that are millimeters. Nothing where `what` is no larger than made
// things are, or the unit is not about a meter.
std::optional<std::string> unit_question(const char* what, const mesh::Box& box_m,
                                         double largest_unit_m);

// `meshes` are those of the objects. Objects that lie outside of a region of interest do not count.
Forecast forecast_of(const mesh::Scene& scene, std::span<const cache::MeshOutline> meshes,
                     const BakeOptions& options);

// kBakeTooLarge where the bake cannot fit into `available_bytes`. The mend names the likeliest
// mistake.
Status check_forecast(const Forecast& forecast, const BakeOptions& options, double available_bytes);

// A line where the bake will take more than a minute or a gigabyte.
std::optional<std::string> forecast_warning(const Forecast& forecast, const BakeOptions& options);

}  // namespace forcelayer::voxelize
