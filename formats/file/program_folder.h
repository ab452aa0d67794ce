// Where the programs and libraries stand that a program starts or loads.
#pragma once

#include <filesystem>
#include <system_error>

namespace forcelayer {

// The folder of the running program; empty where the system does not tell it.
inline std::filesystem::path program_folder() {
  std::error_code failure;
  return std::filesystem::read_symlink("/proc/self/exe", failure).parent_path();
}

}  // namespace forcelayer
