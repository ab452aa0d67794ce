// The facts that a baked file states about itself, for people and for programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "formats/voxinfo/files.h"

namespace forcelayer::voxinfo {

// The facts under the names of the other commands' reports.
nlohmann::ordered_json report_of(const BakedFile& file);

// The same in a few lines of text.
std::string summary_of(const BakedFile& file, const std::string& path);

// An object of a scene, and how many of the voxels with a measured distance are nearest to it. The
// name lives as long as the map.
struct ObjectFacts {
  std::string_view name;
  std::uint64_t voxels = 0;
};

// The objects in the order of their numbers; none where the map stores none. An error where the
// tree repeats nodes so often that they cannot be counted. `path` is for that error.
Result<std::vector<ObjectFacts>> objects_of(const Voxmap& map, const std::string& path);

}  // namespace forcelayer::voxinfo
