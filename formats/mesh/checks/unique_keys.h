// JSON whose objects have each key once: of two equal ones a parser keeps one, without a word.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace forcelayer::mesh {

// The value of a JSON text. Throws the parser's errors. `repeated`: the first key that an object
// has twice; left as it is where there is none.
template <typename Json, typename Text>
Json parse_json(const Text& text, std::string& repeated) {
  using Event = typename Json::parse_event_t;
  std::vector<std::set<std::string>> open;  // keys of the objects that the parser is in
  const auto look_at = [&](int, Event event, Json& value) {
    if (event == Event::object_start) open.emplace_back();
    if (event == Event::object_end) open.pop_back();
    if (event == Event::key && repeated.empty()) {
      const auto key = value.template get<std::string>();
      if (!open.back().insert(key).second) repeated = key;
    }
    return true;
  };
  return Json::parse(text.begin(), text.end(), look_at);
}

}  // namespace forcelayer::mesh
