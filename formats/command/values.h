// Options that take NAME=VALUE,...: one option in place of many.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "formats/command/quantity.h"

namespace forcelayer::command {

// A name that such an option knows, and where its value goes: one of the three pointers.
struct ValueName {
  std::string_view name;
  std::string* text = nullptr;  // any text but an empty one
  double* number = nullptr;     // a number within `bounds`
  Bounds bounds{};
  bool* is_given = nullptr;  // the name stands alone
};

// Reads "NAME=VALUE,NAME,..." into the values of `names`. Only the first "=" of an entry parts name
// and value, and a comma within a value is written twice. `option` is what errors are about.
// Errors: kUsage for a name that is not known (the nearest one is named), that is given twice,
// whose value is missing or out of its bounds, or that takes none.
Status read_values(const char* option, std::string_view text, std::span<const ValueName> names);

// Reads the values of --report, KIND:FILE, a line each, in the same way; a kind that stands alone
// has no file. Errors: kUsage.
Status read_reports(std::string_view texts, std::span<const ValueName> kinds);

}  // namespace forcelayer::command
