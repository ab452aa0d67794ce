#include "tests/support/places.h"

namespace forcelayer::test {

std::string source_path(const std::string& file) { return FORCELAYER_SOURCE_DIR "/" + file; }

std::string command_path(const std::string& name) { return FORCELAYER_BIN_DIR "/" + name; }

}  // namespace forcelayer::test
