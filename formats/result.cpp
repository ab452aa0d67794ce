#include "formats/result.h"

#include <cstddef>
#include <cstdint>

namespace forcelayer {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 1;
  bool valid = false;
};

// The first character of a text that is not empty; one byte that is not valid where it is no UTF-8.
Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return {first, 1, true};
  const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = first & (0xffu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0u) != 0x80u) return {};
    code = code << 6 | (byte(i) & 0x3fu);
  }
  constexpr std::uint32_t kMin[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (code < kMin[bytes] || surrogate || code > 0x10ffff) return {};
  return {code, bytes, true};
}

// Whether a terminal shows the character in its place, and does nothing else.
bool is_shown(std::uint32_t code) {
  const bool control = code < 0x20 || (code >= 0x7f && code < 0xa0);
  const bool line_end = code == 0x2028 || code == 0x2029;
  const bool direction = code == 0x61c || code == 0x200e || code == 0x200f ||
                         (code >= 0x202a && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
  // Characters without an image; those that join letters of some scripts are not among them.
  const bool unseen = code == 0xad || code == 0x200b || (code >= 0x2060 && code <= 0x2064) ||
                      code == 0xfeff || (code >= 0xfff9 && code <= 0xfffb) ||
                      (code >= 0xe0000 && code <= 0xe0fff);
  // No characters at all: no XML may hold the first of these.
  const bool nothing = (code & 0xfffe) == 0xfffe || (code >= 0xfdd0 && code <= 0xfdef);
  return !control && !line_end && !direction && !unseen && !nothing;
}

}  // namespace

Error::Error() = default;
Error::Error(ErrorCode its_code, std::string_view its_file, std::string_view its_where,
             std::string_view its_what, std::string_view its_mend)
    : code(its_code), file(its_file), where(its_where), what(its_what), mend(its_mend) {}
Error::Error(const Error& other) = default;
Error::Error(Error&& other) noexcept = default;
Error& Error::operator=(const Error& other) = default;
Error& Error::operator=(Error&& other) noexcept = default;
Error::~Error() = default;

std::string escaped(std::string_view text) {
  constexpr std::string_view kHex = "0123456789abcdef";
  std::string shown;
  while (!text.empty()) {
    const Character character = first_of(text);
    const std::string_view bytes = text.substr(0, character.bytes);
    text.remove_prefix(character.bytes);
    if (character.valid && is_shown(character.code)) {
      shown += bytes;
      continue;
    }
    for (const char c : bytes) {
      const auto byte = static_cast<unsigned char>(c);
      shown += "\\x";
      shown += kHex[byte >> 4];
      shown += kHex[byte & 15];
    }
  }
  return shown;
}

std::size_t utf8_bytes(std::string_view text) {
  const Character character = first_of(text);
  return character.valid ? character.bytes : 0;
}

std::string to_line(const Error& error) {
  std::string line;
  for (const std::string* part : {&error.file, &error.where}) {
    if (part->empty()) continue;
    line += escaped(*part) + ": ";
  }
  line += escaped(error.what);
  if (!error.mend.empty()) line += "; " + escaped(error.mend);
  return line;
}

}  // namespace forcelayer
