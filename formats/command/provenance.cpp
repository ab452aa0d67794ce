#include "formats/command/provenance.h"

#include <nlohmann/json.hpp>

namespace forcelayer::command {

using Json = nlohmann::ordered_json;  // as in reports: one instance of its templates

namespace {

// Counts the elements of the array "missing_faces" of the outermost object.
class FaceCounter {
 public:
  std::uint64_t count() const { return count_; }

  bool null() { return value(); }
  bool boolean(bool) { return value(); }
  bool number_integer(std::int64_t) { return value(); }
  bool number_unsigned(std::uint64_t) { return value(); }
  bool number_float(double, const std::string&) { return value(); }
  bool string(std::string&) { return value(); }
  bool binary(Json::binary_t&) { return value(); }
  bool start_object(std::size_t) { return open(true); }
  bool start_array(std::size_t) { return open(false); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name) {
    if (depth_ != 1) return true;
    in_faces_ = name == "missing_faces";
    if (in_faces_) count_ = 0;  // of two keys of one name the last one counts
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const Json::exception&) { return false; }

 private:
  bool value() {
    if (depth_ == 2 && in_faces_ && in_array_) ++count_;
    return true;
  }
  bool open(bool object) {
    value();
    if (depth_ == 0 && !object) in_faces_ = false;
    if (depth_ == 1) in_array_ = !object;
    ++depth_;
    return true;
  }
  bool close() {
    --depth_;
    return true;
  }

  std::uint64_t count_ = 0;
  int depth_ = 0;
  bool in_faces_ = false, in_array_ = false;
};

// The text of a key; empty where there is none.
std::string text_in(const Json& json, const char* key) {
  const auto at = json.is_object() ? json.find(key) : json.end();
  return at != json.end() && at->is_string() ? at->get<std::string>() : "";
}

}  // namespace

std::uint64_t missing_faces_in(std::string_view provenance) {
  FaceCounter counter;
  return Json::sax_parse(provenance, &counter) ? counter.count() : 0;
}

std::string up_in(std::string_view provenance) {
  return text_in(Json::parse(provenance, nullptr, false), "up");
}

std::vector<std::string> object_hashes_in(std::string_view provenance) {
  const Json json = Json::parse(provenance, nullptr, false);
  std::vector<std::string> hashes;
  if (!json.is_object() || !json.contains("parts")) return hashes;
  for (const Json& part : json["parts"]) {
    hashes.push_back(text_in(part, "xxh128"));
    if (hashes.back().empty()) return {};
  }
  return hashes;
}

std::string part_hash_in(std::string_view provenance) {
  return text_in(Json::parse(provenance, nullptr, false), "part_xxh3");
}

std::optional<double> mesh_deviation_in(std::string_view provenance) {
  const Json json = Json::parse(provenance, nullptr, false);
  if (!json.is_object() || !json.contains("mesh_deviation_m")) return std::nullopt;
  const Json& deviation = json["mesh_deviation_m"];
  return deviation.is_number() ? std::optional(deviation.get<double>()) : std::nullopt;
}

std::string missing_faces_text(std::string_view provenance) {
  const std::uint64_t count = missing_faces_in(provenance);
  if (count == 0) return "";
  return std::to_string(count) + (count == 1 ? " face is" : " faces are") +
         " missing from the mesh, and no guarantee covers " + (count == 1 ? "it" : "them");
}

}  // namespace forcelayer::command
