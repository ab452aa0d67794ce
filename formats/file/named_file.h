// "FILE#NODE", as inputs are typed and as manifests have them, taken apart.
#pragma once

#include <string>
#include <vector>

namespace forcelayer {

// The file of it. A file may have "#" in its name: the first part that is the name of a file
// counts.
std::string file_of(const std::string& input);

struct NamedFile {
  std::string path;                // file_of()
  std::vector<std::string> nodes;  // the text after "#", empty too; none for the whole file
};
NamedFile named_file(const std::string& input);

}  // namespace forcelayer
