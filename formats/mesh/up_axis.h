// Which axis is up. The world is z up; glTF is y up (glTF 2.0, 3.4), and other formats have no
// rule.
#pragma once

#include <string_view>

#include "formats/mesh/mesh.h"

namespace CLI {
class App;
}

namespace forcelayer::mesh {

// --up, of a command that reads meshes.
void declare_up(CLI::App& app, Up& up);

// "z" or "y".
const char* name_of(Up up);

// The other way round; kY for what is neither, as command::up_in() says of earlier versions.
Up up_named(std::string_view name);

// Turns an assembly that is y up: (x, y, z) becomes (x, -z, y), without rounding.
void turn_z_up(Assembly& assembly);

// Whether a file of a format that is y up is among these.
bool any_y_up_format(const std::vector<Assembly>& assemblies);

}  // namespace forcelayer::mesh
