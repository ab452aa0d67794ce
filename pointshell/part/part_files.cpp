#include "pointshell/part/part_files.h"

#include "formats/mesh/checks/grouped_warnings.h"
#include "formats/mesh/node_names.h"
#include "formats/mesh/units.h"

namespace forcelayer::part {
Result<PartFiles> read_part(const std::vector<std::string>& paths,
                            std::optional<double> chosen_unit_m, const mesh::ReadOptions& options,
                            const mesh::AssemblyReader& read) {
  PartFiles files;
  std::vector<mesh::Assembly> assemblies;
  std::vector<double> units;
  mesh::GroupedWarnings warnings("files");
  for (auto& [path, nodes] : mesh::unite_by_file(paths)) {
    mesh::ReadOptions own = options;
    own.nodes = nodes;
    auto assembly = read(path, own);
    if (!assembly) return assembly.error();
    const auto unit = mesh::meters_per_unit(*assembly, path, chosen_unit_m, assembly->warnings);
    if (!unit) return unit.error();
    for (const std::string& warning : assembly->warnings) warnings.add(path, warning);
    units.push_back(*unit);
    assemblies.push_back(std::move(*assembly));
  }
  if (Status named = mesh::check_left_out(options.without, assemblies); !named) {
    return named.error();
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
  files.warnings = warnings.lines();
  return files;
}

std::string precision_warning(const Part& part, double voxel_size_m) {
  if (!part.single_precision) return "";
  return mesh::coarse_vertices_warning(part.largest_coordinate * 0x1p-23, voxel_size_m)
      .value_or("");
}

std::string size_warning(const Part& part, double voxel_size_m) {
  mesh::Box box = mesh::empty_box();
  for (const Vec3& v : part.vertices) mesh::extend(box, mesh::Vec3d{v.x, v.y, v.z});
  return mesh::small_size_warning("the part", box, voxel_size_m).value_or("");
}

}  // namespace forcelayer::part
