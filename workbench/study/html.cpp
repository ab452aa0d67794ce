#include "workbench/study/html.h"

#include "formats/result.h"

namespace forcelayer::study {

std::string html(std::string_view plain) {
  std::string out;
  for (const char c : escaped(plain)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t n = 0; n < 3; ++n) {
      group = group << 8 | (i + n < bytes.size() ? std::to_integer<unsigned>(bytes[i + n]) : 0);
    }
    for (std::size_t n = 0; n < 4; ++n) {
      out += i + n <= bytes.size() ? kDigits[group >> (18 - 6 * n) & 63] : '=';
    }
  }
  return out;
}

}  // namespace forcelayer::study
