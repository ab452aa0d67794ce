// The report of `voxelize --json`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh_facts.h"
#include "formats/mesh/scene.h"
#include "voxelize/bake.h"

namespace forcelayer::voxelize {

struct BakeFacts {
  double read_s = 0, write_s = 0, total_s = 0;
  std::uint64_t file_bytes = 0;
  int threads = 0;
  double expected_thread_s = 0, expected_bytes = 0;  // the forecast
  mesh::Box scene_box_m{};
  std::vector<std::string> warnings;  // as they are printed
};

// `facts` are those of the objects' meshes.
nlohmann::ordered_json report_of(const Bake& bake, const mesh::Scene& scene,
                                 std::span<const mesh::MeshFacts> facts, const BakeFacts& run);

}  // namespace forcelayer::voxelize
