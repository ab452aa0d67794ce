#include "formats/mesh/readers/text_cursor.h"

#include <algorithm>

namespace forcelayer::mesh {

namespace {

// Whether a number that no double holds is too small for one, not too large.
bool is_tiny(std::string_view text) {
  const std::string_view digits = text.substr(0, text.find_first_of("eE"));
  const auto first = static_cast<long>(digits.find_first_of("123456789"));
  const auto point = static_cast<long>(std::min(digits.find('.'), digits.size()));
  const long power = first < point ? point - first - 1 : point - first;  // of ten, of that digit
  if (digits.size() == text.size()) return power < 0;
  text.remove_prefix(digits.size() + 1);
  const bool is_negative = text.front() == '-';
  if (text.front() == '+' || is_negative) text.remove_prefix(1);
  long exponent = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), exponent);
  if (read.ec != std::errc{}) return is_negative;
  return power < (is_negative ? exponent : -exponent);
}

}  // namespace

const char* parse_number_slow(const char* at, const char* end, double& number) {
  if (at != end && *at == '+') {
    if (++at != end && *at == '-') return nullptr;
  }
  const auto [after, failure] = std::from_chars(at, end, number);
  if (failure == std::errc::result_out_of_range) {
    if (!is_tiny({at, static_cast<std::size_t>(after - at)})) return nullptr;
    number = 0;
    return after;
  }
  return failure == std::errc{} ? after : nullptr;
}

void TextCursor::skip_to_line_end() {
  for (;;) {
    at_ = std::find_if(at_, end_, [](char c) { return c == '\n' || c == '\r'; });
    const bool joined = backslash_joins_lines_ && at_ != end_ && at_ != begin_ && at_[-1] == '\\';
    if (!joined) return;
    skip_line_end();
  }
}

bool TextCursor::skip_joined_line_end() {
  if (!backslash_joins_lines_ || at_ + 1 == end_ || (at_[1] != '\n' && at_[1] != '\r'))
    return false;
  ++at_;
  skip_line_end();
  return true;
}

std::uint64_t TextCursor::count(const char* what) {
  skip_blanks();
  std::uint64_t value = 0;
  const auto [after, failure] = std::from_chars(at_, end_, value);
  if (failure != std::errc{} || (after != end_ && !is_space(*after))) {
    fail(ErrorCode::kMeshUnreadable, std::string(what) + " '" +
                                         std::string(TextCursor(*this).word().substr(0, 40)) +
                                         "' is not a whole number of zero or more");
  }
  at_ = after;
  return value;
}

std::uint64_t TextCursor::line_of(std::uint64_t offset) const {
  std::uint64_t line = 1;
  for (const char* p = begin_; p != begin_ + offset; ++p) {
    if (*p == '\n' || (*p == '\r' && (p + 1 == end_ || p[1] != '\n'))) ++line;
  }
  return line;
}

void TextCursor::fail(ErrorCode code, std::string what, std::string mend) const {
  fail_at(offset(), code, std::move(what), std::move(mend));
}

void TextCursor::fail_at(std::uint64_t offset, ErrorCode code, std::string what,
                         std::string mend) const {
  fail_read(file_, code, "line " + std::to_string(line_of(offset)), std::move(what),
            std::move(mend));
}

void TextCursor::fail_number(const char* what) const {
  const std::string_view word = TextCursor(*this).word();
  if (word.empty() && at_ == end_) {
    fail(ErrorCode::kMeshIncomplete, std::string("the file ends before ") + what,
         "export the mesh again");
  }
  fail(ErrorCode::kMeshUnreadable,
       word.empty() ? std::string(what) + " is missing"
                    : std::string(what) + " " + in_quotes(word) + " is not a number");
}

}  // namespace forcelayer::mesh
