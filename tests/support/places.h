// Where the repository lies, and where its commands were built. A source of its own holds both
// paths, so that no other object file depends on where the tree lies.
#pragma once

#include <string>

namespace forcelayer::test {

// The absolute path of a file of the repository, given relative to its root.
std::string source_path(const std::string& file);

// The absolute path of a command that this build makes.
std::string command_path(const std::string& name);

}  // namespace forcelayer::test
