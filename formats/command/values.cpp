#include "formats/command/values.h"

#include <algorithm>

#include "formats/command/spelling/spelling.h"

namespace forcelayer::command {
namespace {

// "a,b" of "a,,b,c"; `text` becomes "c".
std::string take_entry(std::string_view& text) {
  std::string entry;
  std::size_t n = 0;
  for (; n < text.size(); ++n) {
    if (text[n] == ',') {
      if (!text.substr(n + 1).starts_with(',')) break;
      ++n;
    }
    entry += text[n];
  }
  text.remove_prefix(std::min(n + 1, text.size()));
  return entry;
}

// Says what is wrong with an entry, and how to mend it.
struct Wrong {
  std::string what, mend;
};

Wrong take_value(const ValueName& name, const std::string& entry, const char* option,
                 Status& outcome) {
  const std::string value = entry.substr(std::min(name.name.size() + 1, entry.size()));
  if (name.is_given != nullptr) {
    if (entry.size() > name.name.size()) return {"takes no value", "write it without ="};
    *name.is_given = true;
  } else if (value.empty()) {
    return {"needs a value", "write " + std::string(name.name) + "=VALUE"};
  } else if (name.text != nullptr) {
    *name.text = value;
  } else if (const auto number = parse_number(value, name.bounds); number) {
    *name.number = *number;
  } else {
    outcome = about(option + (' ' + std::string(name.name)), number.error());
  }
  return {};
}

}  // namespace

Status read_values(const char* option, std::string_view text, std::span<const ValueName> names) {
  std::string seen = ",";  // the names so far
  Status outcome;
  while (!text.empty() && outcome) {
    const std::string entry = take_entry(text);
    const std::string typed = entry.substr(0, entry.find('='));
    const ValueName* nearest = nullptr;
    std::size_t smallest = typed.npos;
    for (const ValueName& name : names) {
      const std::size_t distance = spelling_distance(typed, name.name);
      if (distance < smallest) smallest = distance, nearest = &name;
    }
    Wrong wrong;
    if (smallest == typed.npos) {
      wrong = {"is not a known name", "leave it out"};
    } else if (smallest > 0) {
      wrong = {"is not a known name", "the nearest known name is " + std::string(nearest->name) +
                                          "; --help lists all names"};
    } else if (seen.find(',' + typed + ',') != seen.npos) {
      wrong = {"is given more than once", "give it once"};
    } else {
      wrong = take_value(*nearest, entry, option, outcome);
    }
    seen += typed + ',';
    if (!wrong.what.empty()) {
      outcome = Error{ErrorCode::kUsage, "", option, "'" + typed + "' " + wrong.what, wrong.mend};
    }
  }
  return outcome;
}

Status read_reports(std::string_view texts, std::span<const ValueName> kinds) {
  const auto wrong = [](const std::string& text, const char* what, const std::string& mend) {
    return Error{ErrorCode::kUsage, "", "--report", "'" + text + what, mend};
  };
  while (!texts.empty()) {
    const std::string text(texts.substr(0, texts.find('\n')));
    texts.remove_prefix(std::min(text.size() + 1, texts.size()));
    const std::string name = text.substr(0, text.find(':'));
    const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                   [&](const ValueName& one) { return one.name == name; });
    if (kind == kinds.end()) {
      std::string known;
      for (const ValueName& one : kinds) (known += known.empty() ? "" : ", ") += one.name;
      return wrong(name, "' is not a kind of report", "known kinds: " + known);
    }
    const bool has_file = text.size() > name.size() + 1;
    if (kind->is_given != nullptr) {
      if (text != name)
        return wrong(name, "' takes no file, because this report is printed",
                     "write " + name + " alone");
      *kind->is_given = true;
    } else if (!has_file || !kind->text->empty()) {
      return wrong(name, has_file ? "' is given more than once" : "' needs a file",
                   "write " + name + ":FILE once");
    } else {
      *kind->text = text.substr(name.size() + 1);
    }
  }
  return {};
}

}  // namespace forcelayer::command
