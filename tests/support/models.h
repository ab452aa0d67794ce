// Where the tests find meshes that no test makes: tests/models, and Debian's glmark2-data.
#pragma once

#include <cctype>
#include <string>

#include "tests/support/places.h"

namespace forcelayer::test {

// The path of a file of tests/models, which its README.md lists.
inline std::string model_path(const std::string& file) {
  return source_path("tests/models/" + file);
}

// A file's name as a part of a test's name.
inline std::string test_name_of(std::string file) {
  for (char& c : file) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return file;
}

// A scanned bunny as OBJ: 69,666 triangles.
inline std::string bunny_obj_path() { return "/usr/share/glmark2/models/bunny.obj"; }

}  // namespace forcelayer::test
