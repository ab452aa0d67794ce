#include "pointshell/part_files.h"

#include <cstdio>

namespace forcelayer {
namespace {

// The unit to read `path` in, with a warning when the user overrides the file's own.
Result<double> unit_of(const Assembly& assembly, const std::string& path,
                       std::optional<double> chosen, std::vector<std::string>& warnings) {
  if (!chosen && !assembly.metres_per_unit) {
    return Error{ErrorCode::kUsage, path, "", "the format does not define a unit of length",
                 "add --units, for example --units mm"};
  }
  if (!chosen) return *assembly.metres_per_unit;
  if (assembly.metres_per_unit && *assembly.metres_per_unit != *chosen) {
    warnings.push_back(path + ": --units overrides the unit that the file defines");
  }
  return *chosen;
}

}  // namespace

Result<PartFiles> read_part(const std::vector<std::string>& paths,
                            std::optional<double> metres_per_unit) {
  PartFiles files;
  std::vector<Assembly> assemblies;
  std::vector<double> units;
  for (const std::string& path : paths) {
    auto assembly = read_assembly(path);
    if (!assembly) return assembly.error();
    for (const std::string& warning : assembly->warnings) {
      files.warnings.push_back(path + ": " + warning);
    }
    const auto unit = unit_of(*assembly, path, metres_per_unit, files.warnings);
    if (!unit) return unit.error();
    units.push_back(*unit);
    assemblies.push_back(std::move(*assembly));
  }
  std::vector<PartInput> inputs;
  for (std::size_t n = 0; n < assemblies.size(); ++n) inputs.push_back({&assemblies[n], units[n]});
  auto part = assemble_part(inputs);
  if (!part) {
    Error error = part.error();
    if (paths.size() == 1) error.file = paths.front();
    return error;
  }
  files.part = std::move(*part);
  return files;
}

std::string precision_warning(const Part& part, double voxel_size_m) {
  const double spacing_m = part.largest_coordinate * 0x1p-23;
  if (!part.single_precision || spacing_m <= voxel_size_m / 1000) return "";
  char text[160];
  std::snprintf(text, sizeof text,
                "vertices are 32-bit numbers, %.2g m apart where they lie: coarser than a "
                "thousandth of a voxel",
                spacing_m);
  return text;
}

}  // namespace forcelayer
