#include <stdexcept>

#include "formats/pshell_writer.h"
#include "pointshell/bake.h"
#include "tests/stress/baked.h"

namespace forcelayer::stress {

void bake_part_file(const mesh::Mesh& part, double voxel_size_m, const std::filesystem::path& path,
                    double covering_radius_m) {
  mesh::Assembly assembly;
  assembly.meshes.push_back(part);
  assembly.instances.push_back({0, "part", {}});
  const part::PartInput input{&assembly, 1};
  auto assembled = part::assemble_part(std::span(&input, 1));
  if (!assembled) throw std::runtime_error(to_line(assembled.error()));
  pointshell::ShellOptions options;
  options.voxel_size_m = voxel_size_m;
  options.covering_radius_m = covering_radius_m;
  options.effort = sample::Effort::kFast;
  options.threads = 1;
  const auto baked =
      pointshell::bake_shell(std::move(*assembled), options, [](const std::string&, double) {});
  if (!baked) throw std::runtime_error(to_line(baked.error()));
  const auto written = write_pshell(path, baked.value().content());
  if (!written) throw std::runtime_error(to_line(written.error()));
}

}  // namespace forcelayer::stress
