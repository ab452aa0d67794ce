// A place in a text file: words, numbers and lines. Lines end with LF, CR LF or CR, mixed or not.
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// Parses the decimal number at the start of [at, end); returns the place after it, or nullptr where
// there is none or it overflows a double. Correctly rounded, as std::from_chars. Accepts a leading
// '+', "nan" and "inf"; a number too small for a double is 0.
const char* parse_number_slow(const char* at, const char* end, double& number);

inline const char* parse_number(const char* at, const char* end, double& number) {
  // Up to 2^53 and 10^22 both parts are exact doubles, so one multiplication or division rounds
  // correctly (Clinger 1990). All else goes the slow way.
  static constexpr std::array<double, 23> kPowersOfTen = {
      1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
      1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const auto digit = [](char c) { return static_cast<unsigned>(c) - '0'; };
  const char* p = at;
  const bool negative = p != end && *p == '-';
  if (p != end && (*p == '-' || *p == '+')) ++p;
  const char* const first = p;
  std::uint64_t mantissa = 0;
  for (; p != end && digit(*p) < 10; ++p) mantissa = 10 * mantissa + digit(*p);
  auto digits = p - first;
  int exponent = 0;
  if (p != end && *p == '.') {
    const char* const fraction = ++p;
    for (; p != end && digit(*p) < 10; ++p) mantissa = 10 * mantissa + digit(*p);
    digits += p - fraction;
    exponent = -static_cast<int>(p - fraction);
  }
  if (digits == 0 || digits > 18) return parse_number_slow(at, end, number);
  if (p != end && (*p == 'e' || *p == 'E')) {
    const char* q = p + 1;
    const bool down = q != end && *q == '-';
    if (q != end && (*q == '-' || *q == '+')) ++q;
    const char* const exponent_digits = q;
    int power = 0;
    for (; q != end && digit(*q) < 10 && q - exponent_digits < 4; ++q) {
      power = 10 * power + static_cast<int>(digit(*q));
    }
    if (q == exponent_digits || (q != end && digit(*q) < 10)) {
      return parse_number_slow(at, end, number);
    }
    exponent += down ? -power : power;
    p = q;
  }
  if (mantissa > (std::uint64_t{1} << 53) || exponent < -22 || exponent > 22) {
    return parse_number_slow(at, end, number);
  }
  double value = static_cast<double>(mantissa);
  value = exponent < 0 ? value / kPowersOfTen[static_cast<std::size_t>(-exponent)]
                       : value * kPowersOfTen[static_cast<std::size_t>(exponent)];
  number = negative ? -value : value;
  return p;
}

// The byte order mark of UTF-8. Editors and scripts put it at a file's beginning; joined files have
// it in the middle.
inline constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

class TextCursor {
 public:
  // Begins after a byte order mark, where there is one. `backslash_joins_lines`: a backslash at a
  // line's end is white space, together with the end.
  explicit TextCursor(const SourceFile& file, bool backslash_joins_lines = false)
      : file_(file),
        begin_(file.bytes.data()),
        at_(begin_),
        end_(begin_ + file.bytes.size()),
        backslash_joins_lines_(backslash_joins_lines) {
    if (file.bytes.starts_with(kByteOrderMark)) at_ += kByteOrderMark.size();
  }

  bool at_end() const { return at_ == end_; }
  bool at_line_end() const { return at_ == end_ || *at_ == '\n' || *at_ == '\r'; }
  char peek() const { return at_ == end_ ? '\0' : *at_; }
  std::uint64_t offset() const { return static_cast<std::uint64_t>(at_ - begin_); }
  std::uint64_t bytes_left() const { return static_cast<std::uint64_t>(end_ - at_); }
  void advance(std::uint64_t bytes) { at_ += bytes; }

  // White space within a line.
  void skip_blanks() {
    while (at_ != end_) {
      if (*at_ == ' ' || *at_ == '\t' || *at_ == '\v' || *at_ == '\f') {
        ++at_;
      } else if (*at_ != '\\' || !skip_joined_line_end()) {
        return;
      }
    }
  }
  // White space over line ends, too; `comment` (where not 0) starts a comment to the line's end.
  void skip_space(char comment = '\0') {
    for (;;) {
      skip_blanks();
      if (at_ == end_) return;
      if (comment != '\0' && *at_ == comment) skip_to_line_end();
      if (!at_line_end()) return;
      if (at_ != end_) ++at_;
    }
  }
  void skip_to_line_end();
  void skip_line_end() {
    if (at_ != end_ && *at_ == '\r') ++at_;
    if (at_ != end_ && *at_ == '\n') ++at_;
  }

  // The next word of this line; empty at the line's end.
  std::string_view word() {
    skip_blanks();
    const char* const first = at_;
    while (at_ != end_ && !is_space(*at_)) ++at_;
    return {first, static_cast<std::size_t>(at_ - first)};
  }
  // The next word of this line as a number; throws "WHAT is not a number".
  double number(const char* what) {
    skip_blanks();
    double value = 0;
    const char* const after = parse_number(at_, end_, value);
    if (after == nullptr || (after != end_ && !is_space(*after))) fail_number(what);
    at_ = after;
    return value;
  }
  // A whole number at this place (no blanks skipped); false, without moving, where there is none.
  bool integer(std::int64_t& value) {
    const auto [after, failure] = std::from_chars(at_, end_, value);
    if (failure != std::errc{}) return false;
    at_ = after;
    return true;
  }
  // The next word of this line as a count; throws "WHAT is not a whole number of zero or more".
  std::uint64_t count(const char* what);

  std::uint64_t line_of(std::uint64_t offset) const;  // from 1
  [[noreturn]] void fail(ErrorCode code, std::string what, std::string mend = {}) const;
  [[noreturn]] void fail_at(std::uint64_t offset, ErrorCode code, std::string what,
                            std::string mend = {}) const;

 private:
  static bool is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');  // tab, LF, VT, FF, CR
  }
  bool skip_joined_line_end();
  [[noreturn]] void fail_number(const char* what) const;

  const SourceFile& file_;
  const char* begin_;
  const char* at_;
  const char* end_;
  bool backslash_joins_lines_;
};

}  // namespace forcelayer::mesh
