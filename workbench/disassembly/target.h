// The parts that --target names.
#pragma once

#include <string>

#include "formats/result.h"
#include "workbench/disassembly/blocking_graph.h"
#include "workbench/pairs/assembly_parts.h"

namespace forcelayer::disassembly {

// The parts of the node that a name means, as `voxelize --list` prints it, with all below it. A
// name with wildcards, or a list, may mean several nodes: they come out together. Errors: kUsage
// where it means none, one of several by chance, or all parts.
Result<Parts> target_parts(const pairs::AssemblyParts& assembly, const std::string& name);

}  // namespace forcelayer::disassembly
