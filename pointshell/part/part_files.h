// Reading the mesh files of a part.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/sandbox/trust_options.h"
#include "formats/result.h"
#include "pointshell/part/part.h"

namespace forcelayer::part {

struct PartFiles {
  Part part;
  std::vector<std::string> warnings;  // a line each
};

// Reads all files with these options, each once ("FILE#NODE" as in read_assembly; of a manifest
// "FILE#PART", as in read_scene, where the manifest places it), and unites them.
// A name of ReadOptions::without that no file has is kSceneInvalid. `meters_per_unit` is the user's
// choice of unit. It is required (else kUsage) where a format defines none; where a format defines
// one, it overrides that with a warning. Other errors: those of read_assembly and assemble_part,
// with the file's name.
Result<PartFiles> read_part(const std::vector<std::string>& paths,
                            std::optional<double> meters_per_unit,
                            const mesh::ReadOptions& options = {},
                            const mesh::AssemblyReader& read = mesh::read_assembly);

// A warning where the file's 32-bit vertices are coarser than a thousandth of a voxel; else empty.
std::string precision_warning(const Part& part, double voxel_size_m);

// A warning where the part is less than four voxels across; else empty.
std::string size_warning(const Part& part, double voxel_size_m);

}  // namespace forcelayer::part
