#include "formats/file/named_file.h"

#include <unistd.h>

namespace forcelayer {

std::string file_of(const std::string& input) {
  std::string path = input;
  std::size_t hash = input.find('#');
  if (hash == std::string::npos) return path;
  while (::access(path.c_str(), F_OK) != 0 && hash != std::string::npos) {
    path = input.substr(0, hash);
    hash = input.find('#', hash + 1);
  }
  return path;
}

NamedFile named_file(const std::string& input) {
  NamedFile file{file_of(input), {}};
  if (file.path != input) file.nodes.push_back(input.substr(file.path.size() + 1));
  return file;
}

}  // namespace forcelayer
