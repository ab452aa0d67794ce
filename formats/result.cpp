#include "formats/result.h"

#include <string_view>

namespace forcelayer {
namespace {

void append_escaped(std::string& line, std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte != 0x7f) {
      line += c;
    } else {
      line += "\\x";
      line += kHex[byte >> 4];
      line += kHex[byte & 15];
    }
  }
}

}  // namespace

std::string to_line(const Error& error) {
  std::string line;
  for (const std::string* part : {&error.file, &error.where}) {
    if (part->empty()) continue;
    append_escaped(line, *part);
    line += ": ";
  }
  append_escaped(line, error.what);
  if (!error.mend.empty()) {
    line += "; ";
    append_escaped(line, error.mend);
  }
  return line;
}

}  // namespace forcelayer
