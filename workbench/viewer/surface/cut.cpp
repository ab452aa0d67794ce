#include "workbench/viewer/surface/cut.h"

#include "formats/command/quantity.h"

namespace forcelayer::viewer {

Result<Cut> parse_cut(std::string_view text) {
  const Error wrong{ErrorCode::kUsage, "", "--cut", "'" + std::string(text) + "' is not a cut",
                    "write the side to keep, like z<300mm or x>0m"};
  constexpr std::string_view kAxes = "xyz";
  if (text.size() < 3) return wrong;
  const std::size_t axis = kAxes.find(text[0]);
  if (axis == std::string_view::npos || (text[1] != '<' && text[1] != '>')) return wrong;
  const auto at_m = command::parse_length(text.substr(2));
  if (!at_m) return wrong;
  return Cut{static_cast<int>(axis), *at_m, text[1] == '<'};
}

}  // namespace forcelayer::viewer
