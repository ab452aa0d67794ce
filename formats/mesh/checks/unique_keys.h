// JSON whose objects have each key once: of two equal ones a parser keeps one, without a word.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace forcelayer::mesh {

// Finds the first key that an object has twice.
template <typename Json>
class RepeatedKey : public nlohmann::json_sax<Json> {
 public:
  const std::string& found() const { return found_; }

  bool key(std::string& key) override {
    if (found_.empty() && !open_.back().insert(key).second) found_ = key;
    return true;
  }
  bool start_object(std::size_t) override {
    open_.emplace_back();
    return true;
  }
  bool end_object() override {
    open_.pop_back();
    return true;
  }
  bool start_array(std::size_t) override { return true; }
  bool end_array() override { return true; }
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(std::int64_t) override { return true; }
  bool number_unsigned(std::uint64_t) override { return true; }
  bool number_float(double, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(typename Json::binary_t&) override { return true; }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  std::vector<std::set<std::string>> open_;  // keys of the objects that the parser is in
  std::string found_;
};

// The value of a JSON text. Throws the parser's errors. `repeated`: the first key that an object
// has twice; left as it is where there is none. Two passes: a parser with a callback looks, at the
// end of each element of an array, through all before it.
template <typename Json, typename Text>
Json parse_json(const Text& text, std::string& repeated) {
  Json value = Json::parse(text.begin(), text.end());
  RepeatedKey<Json> keys;
  Json::sax_parse(text.begin(), text.end(), &keys);
  if (!keys.found().empty()) repeated = keys.found();
  return value;
}

}  // namespace forcelayer::mesh
