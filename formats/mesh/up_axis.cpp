#include "formats/mesh/up_axis.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>

namespace forcelayer::mesh {

void declare_up(CLI::App& app, Up& up) {
  app.add_option_function<std::string>(
         "--up", [&up](const std::string& name) { up = up_named(name); },
         "y keeps glTF files y-up; z turns them to z-up, as STEP files are (default z)")
      ->check(CLI::IsMember({"z", "y"}));
}

const char* name_of(Up up) { return up == Up::kZ ? "z" : "y"; }

Up up_named(std::string_view name) { return name == name_of(Up::kZ) ? Up::kZ : Up::kY; }

void turn_z_up(Assembly& assembly) {
  const Affine z_up_from_y_up{{1, 0, 0, 0, 0, -1, 0, 1, 0}, {0, 0, 0}};
  for (MeshInstance& instance : assembly.instances) {
    instance.assembly_from_mesh = compose(z_up_from_y_up, instance.assembly_from_mesh);
  }
}

bool any_y_up_format(const std::vector<Assembly>& assemblies) {
  return std::any_of(assemblies.begin(), assemblies.end(),
                     [](const Assembly& assembly) { return assembly.up.has_value(); });
}

}  // namespace forcelayer::mesh
