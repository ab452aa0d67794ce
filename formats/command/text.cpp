#include "formats/command/text.h"

#include <cstdarg>
#include <cstdio>

namespace forcelayer::command {

std::string text(const char* pattern, ...) {
  std::va_list arguments, again;
  va_start(arguments, pattern);
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, pattern, arguments);
  std::string line(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::vsnprintf(line.data(), line.size() + 1, pattern, again);
  va_end(again);
  va_end(arguments);
  return line;
}

}  // namespace forcelayer::command
