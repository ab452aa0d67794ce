#include "pointshell/part/part_files.h"

#include "formats/mesh/units.h"

namespace forcelayer::part {
Result<PartFiles> read_part(const std::vector<std::string>& paths,
                            std::optional<double> chosen_unit_m, const mesh::ReadOptions& options,
                            const mesh::AssemblyReader& read) {
  PartFiles files;
  std::vector<mesh::Assembly> assemblies;
  std::vector<double> units;
  for (const std::string& path : paths) {
    auto assembly = read(path, options);
    if (!assembly) return assembly.error();
    for (const std::string& warning : assembly->warnings) {
      files.warnings.push_back(path + ": " + warning);
    }
    const auto unit = mesh::meters_per_unit(*assembly, path, chosen_unit_m, files.warnings);
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
  if (!part.single_precision) return "";
  return mesh::coarse_vertices_warning(part.largest_coordinate * 0x1p-23, voxel_size_m)
      .value_or("");
}

}  // namespace forcelayer::part
