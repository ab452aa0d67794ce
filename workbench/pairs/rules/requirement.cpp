#include "workbench/pairs/rules/requirement.h"

#include "formats/command/quantity.h"
#include "formats/path/path_columns.h"

namespace forcelayer::pairs {

Result<Requirement> parse_requirement(const std::string& text) {
  if (text == "touch") return Requirement{};
  if (text == "ignore") return Requirement{Requirement::Kind::kIgnore, 0};
  constexpr const char* kMend = "write a length such as 1mm, touch or ignore";
  const auto wrong = [&](const char* what) {
    return Error{ErrorCode::kUsage, "", "", in_quotes(text) + what, kMend};
  };
  const auto length_m = command::parse_length(text);
  if (!length_m) return wrong(" is not a length with a unit");
  if (*length_m < 0) return wrong(" must not be negative");
  if (*length_m == 0) return Requirement{};
  return Requirement{Requirement::Kind::kClearance, *length_m};
}

}  // namespace forcelayer::pairs
