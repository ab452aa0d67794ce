#include "workbench/disassembly/target.h"

#include <map>
#include <span>
#include <vector>

#include "formats/mesh/node_names.h"

namespace forcelayer::disassembly {

Result<Parts> target_parts(const pairs::AssemblyParts& assembly, const std::string& name) {
  // The nodes above the parts, each before its children.
  std::vector<mesh::AssemblyNode> nodes;
  std::map<std::string, std::size_t> numbers;
  std::vector<std::size_t> node_of;  // [parts]
  for (const std::string& path : assembly.paths) {
    for (std::size_t start = 0; start <= path.size();) {
      const std::size_t end = std::min(path.find('/', start), path.size());
      const std::string above = path.substr(0, end);
      if (numbers.try_emplace(above, nodes.size()).second) {
        mesh::AssemblyNode& node = nodes.emplace_back();
        node.label = path.substr(start, end - start);
        node.path = above;
        for (const char c : above) node.depth += c == '/';
      }
      start = end + 1;
    }
    node_of.push_back(numbers[path]);
  }
  const auto chosen = mesh::choose_nodes({&name, 1}, nodes);
  if (!chosen) {
    Error error = chosen.error();
    error.code = ErrorCode::kUsage;
    error.what = "'" + name + "': " + error.what;
    return error;
  }
  Parts parts;
  for (std::size_t part = 0; part < node_of.size(); ++part) {
    if ((*chosen)[node_of[part]]) parts.push_back(part);
  }
  if (parts.size() == assembly.parts.size()) {
    return Error{ErrorCode::kUsage, "", "", "'" + name + "' means all parts of the assembly",
                 "name a part or node of it, or leave out --target"};
  }
  return parts;
}

}  // namespace forcelayer::disassembly
