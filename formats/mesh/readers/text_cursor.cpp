#include "formats/mesh/readers/text_cursor.h"

#include <algorithm>

namespace forcelayer::mesh {

const char* parse_number_slow(const char* at, const char* end, double& number) {
  if (at != end && *at == '+') {
    if (++at != end && *at == '-') return nullptr;
  }
  const auto [after, failure] = std::from_chars(at, end, number);
  if (failure == std::errc::result_out_of_range) {
    const std::string_view text(at, static_cast<std::size_t>(after - at));
    const auto exponent = text.find_first_of("eE");
    const bool tiny = exponent == std::string_view::npos ? text.find('.') < 3
                                                         : text.substr(exponent + 1, 1) == "-";
    if (!tiny) return nullptr;
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
                                         "' is not a whole number from 0");
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
    fail(ErrorCode::kMeshIncomplete, std::string("the file ends where ") + what + " should stand",
         "export the mesh again");
  }
  fail(ErrorCode::kMeshUnreadable,
       word.empty() ? std::string(what) + " is missing"
                    : std::string(what) + " " + in_quotes(word) + " is not a number");
}

}  // namespace forcelayer::mesh
