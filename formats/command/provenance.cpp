#include "formats/command/provenance.h"

#include <algorithm>
#include <optional>

namespace forcelayer::command {
namespace {

// Goes over JSON text without a parser, which would be a tenth of voxrun. It looks at brackets,
// strings and commas alone; nothing is said about text that is no JSON, but that it ends.
class JsonScan {
 public:
  explicit JsonScan(std::string_view text) : text_(text) {}

  // The elements of the array of this name in the outermost object: those of the last one; 0 where
  // it is no array. Nothing where the text is no object.
  std::optional<std::uint64_t> elements_of(std::string_view name) {
    std::uint64_t count = 0;
    if (!take('{')) return std::nullopt;
    if (take('}')) return count;
    do {
      const std::optional<std::string_view> key = string();
      if (!key || !take(':')) return std::nullopt;
      if (*key != name || peek() != '[') {
        if (*key == name) count = 0;
        if (!skip_value()) return std::nullopt;
        continue;
      }
      const auto found = elements();
      if (!found) return std::nullopt;
      count = *found;
    } while (take(','));
    return take('}') ? std::optional(count) : std::nullopt;
  }

 private:
  // The next letter that is no white space; 0 at the end.
  char peek() {
    at_ = std::min(text_.find_first_not_of(" \t\n\r", at_), text_.size());
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool take(char letter) {
    if (peek() != letter) return false;
    ++at_;
    return true;
  }

  // What stands between quotes, as it stands there.
  std::optional<std::string_view> string() {
    if (!take('"')) return std::nullopt;
    const std::size_t first = at_;
    for (; at_ < text_.size(); ++at_) {
      if (text_[at_] == '"') return text_.substr(first, at_++ - first);
      if (text_[at_] == '\\') ++at_;
    }
    return std::nullopt;
  }

  bool skip_value() {
    std::size_t depth = 0;
    do {
      const char letter = peek();
      if (letter == '"') {
        if (!string()) return false;
      } else if (letter == '{' || letter == '[') {
        ++at_, ++depth;
      } else if (depth > 0 && (letter == '}' || letter == ']')) {
        ++at_, --depth;
      } else if (depth > 0 && (letter == ',' || letter == ':')) {
        ++at_;
      } else {
        const std::size_t first = at_;
        at_ = std::min(text_.find_first_of(" \t\n\r,:]}\"[{", at_), text_.size());
        if (at_ == first) return false;
      }
    } while (depth > 0);
    return true;
  }

  std::optional<std::uint64_t> elements() {
    std::uint64_t count = 0;
    if (!take('[')) return std::nullopt;
    if (take(']')) return count;
    do {
      if (!skip_value()) return std::nullopt;
      ++count;
    } while (take(','));
    return take(']') ? std::optional(count) : std::nullopt;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::uint64_t missing_faces_in(std::string_view provenance) {
  return JsonScan(provenance).elements_of("missing_faces").value_or(0);
}

std::string missing_faces_text(std::string_view provenance) {
  const std::uint64_t count = missing_faces_in(provenance);
  if (count == 0) return "";
  return std::to_string(count) + (count == 1 ? " face is" : " faces are") +
         " missing from it, and no guarantee covers " + (count == 1 ? "it" : "them");
}

}  // namespace forcelayer::command
