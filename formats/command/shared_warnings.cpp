#include "formats/command/shared_warnings.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdlib>

namespace forcelayer::command {
namespace {

// Names the descriptor of a file in memory, which the programs that are started inherit: a line for
// each warning that was printed.
constexpr const char* kVariable = "FORCELAYER_WARNINGS";
constexpr const char* kFile = "forcelayer-warnings";

// -1 where the variable names no such file.
int shared_file() {
  const char* const number = std::getenv(kVariable);
  if (number == nullptr) return -1;
  std::array<char, 64> target{};
  const std::string link = std::string("/proc/self/fd/") + number;
  if (::readlink(link.c_str(), target.data(), target.size() - 1) < 0) return -1;
  return std::string(target.data()).starts_with(std::string("/memfd:") + kFile) ? std::atoi(number)
                                                                                : -1;
}

std::string content_of(int file) {
  std::string content;
  std::array<char, 4096> piece;
  ssize_t got = 0;
  while ((got = ::pread(file, piece.data(), piece.size(), static_cast<off_t>(content.size()))) >
         0) {
    content.append(piece.data(), static_cast<std::size_t>(got));
  }
  return content;
}

}  // namespace

void share_warnings() {
  const int file = ::memfd_create(kFile, 0);
  if (file < 0 || ::fcntl(file, F_SETFL, O_APPEND) != 0) return;
  ::setenv(kVariable, std::to_string(file).c_str(), 1);
}

bool is_new_warning(const std::string& text) {
  const int file = shared_file();
  if (file < 0) return true;
  const std::string line = text + "\n";
  if (("\n" + content_of(file)).find("\n" + line) != std::string::npos) return false;
  // Where it cannot be noted, it is printed again.
  [[maybe_unused]] const ssize_t noted = ::write(file, line.data(), line.size());
  return true;
}

}  // namespace forcelayer::command
