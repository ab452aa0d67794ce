#include "runtime/voxcheck/exact_exchange.h"

#include <nlohmann/json.hpp>

namespace forcelayer::voxcheck {
// Found by their arguments alone, so not in a nameless namespace.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactMoment, time_s, exact_m, object, part_m, scene_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactViolation, from_s, to_s, clearance_m, worst, graze,
                                   pushed_into_seat, depth_m, max_depth_m, contact_s, contact_known,
                                   inside, passes_wall)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactHole, edges_m, place_m)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactSeat, object, gap_m, installed_m, allowed_m, deepest_m,
                                   nearest_m, margin_m, crack_m, soon_m, soon_s, settled, part_hole,
                                   object_hole)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactNearest, from_s, to_s, clearance_m, nearest)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactStop, stage, object, settled_s)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactRule, required_m, ignored)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExactAnswer, clearance_m, margin_m, smallest, violations, seat,
                                   seated, beyond, beyond_clearance_m, enclosed_by,
                                   ends_beyond_scene, moments, stop, rules, warnings)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ProvenMoment, time_s, min_m, max_m, seated)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ProvenStretch, from_s, to_s, proven_m, too_near, seated)

namespace {

using Json = nlohmann::json;

// File names need not be UTF-8: bytes as numbers.
std::vector<int> bytes_of(const std::string& text) {
  std::vector<int> bytes;
  for (const char c : text) bytes.push_back(static_cast<unsigned char>(c));
  return bytes;
}
std::string text_from(const Json& bytes) {
  std::string text;
  for (const int byte : bytes.get<std::vector<int>>()) text += static_cast<char>(byte);
  return text;
}
Json bytes_of(const std::vector<std::string>& texts) {
  Json list = Json::array();
  for (const std::string& text : texts) list.push_back(bytes_of(text));
  return list;
}
std::vector<std::string> texts_from(const Json& list) {
  std::vector<std::string> texts;
  for (const Json& bytes : list) texts.push_back(text_from(bytes));
  return texts;
}

Json or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(); }
std::optional<double> unless_null(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional<double>(json.get<double>());
}

template <typename T>
Result<T> read(const std::string& text, T (*take)(const Json&)) {
  try {
    return take(Json::parse(text));
  } catch (const Json::exception& e) {
    return Error{
        ErrorCode::kInternal, "", "--exact",
        std::string("voxcheck and voxcheck-exact do not understand each other: ") + e.what(),
        "install the same version of both"};
  }
}

}  // namespace

std::string text_of(const ExactRequest& r) {
  return Json{{"scene", bytes_of(r.scene)},
              {"part", bytes_of(r.part)},
              {"path", bytes_of(r.path)},
              {"pivot_m", r.pivot_m ? Json(*r.pivot_m) : Json()},
              {"meshes", bytes_of(r.meshes)},
              {"part_meshes", bytes_of(r.part_meshes)},
              {"without", bytes_of(r.without)},
              {"unit_m", or_null(r.unit_m)},
              {"part_unit_m", or_null(r.part_unit_m)},
              {"allow_outside", r.allow_outside},
              {"sandbox", bytes_of(r.sandbox)},
              {"required_m", r.required_m},
              {"min_s", r.min_s},
              {"max_m", or_null(r.max_m)},
              {"allowed", r.allowed},
              {"seat", r.seat},
              {"stretches", r.stretches},
              {"moments", r.moments},
              {"seated", r.seated},
              {"seat_pose", r.seat_pose},
              {"seat_depth_m", or_null(r.seat_depth_m)},
              {"max_s", or_null(r.max_s)},
              {"animation", bytes_of(r.animation)},
              {"map", bytes_of(r.map)},
              {"rules", bytes_of(r.rules)},
              {"quiet", r.quiet}}
      .dump();
}

Result<ExactRequest> exact_request(const std::string& text) {
  return read<ExactRequest>(
      text, +[](const Json& json) {
        ExactRequest r;
        r.scene = text_from(json.at("scene"));
        r.part = text_from(json.at("part"));
        r.path = text_from(json.at("path"));
        if (const Json& pivot = json.at("pivot_m"); !pivot.is_null()) {
          r.pivot_m = pivot.get<std::array<double, 3>>();
        }
        r.meshes = texts_from(json.at("meshes"));
        r.part_meshes = texts_from(json.at("part_meshes"));
        r.without = texts_from(json.at("without"));
        r.unit_m = unless_null(json.at("unit_m"));
        r.part_unit_m = unless_null(json.at("part_unit_m"));
        json.at("allow_outside").get_to(r.allow_outside);
        r.sandbox = text_from(json.at("sandbox"));
        json.at("required_m").get_to(r.required_m);
        json.at("min_s").get_to(r.min_s);
        r.max_m = unless_null(json.at("max_m"));
        json.at("allowed").get_to(r.allowed);
        json.at("seat").get_to(r.seat);
        json.at("stretches").get_to(r.stretches);
        json.at("moments").get_to(r.moments);
        json.at("seated").get_to(r.seated);
        json.at("seat_pose").get_to(r.seat_pose);
        r.seat_depth_m = unless_null(json.at("seat_depth_m"));
        r.max_s = unless_null(json.at("max_s"));
        r.animation = text_from(json.at("animation"));
        r.map = text_from(json.at("map"));
        r.rules = text_from(json.at("rules"));
        json.at("quiet").get_to(r.quiet);
        return r;
      });
}

std::string text_of(const Result<ExactAnswer>& answer) {
  if (answer) {
    ExactAnswer plain = *answer;
    for (std::string& warning : plain.warnings) warning = escaped(warning);
    return Json(plain).dump();
  }
  const Error& e = answer.error();
  return Json{{"error", static_cast<int>(e.code)},
              {"file", bytes_of(e.file)},
              {"where", bytes_of(e.where)},
              {"what", bytes_of(e.what)},
              {"mend", bytes_of(e.mend)}}
      .dump();
}

Result<ExactAnswer> exact_answer(const std::string& text) {
  std::optional<Error> error;
  auto answer = read<std::pair<ExactAnswer, std::optional<Error>>>(
      text, +[](const Json& json) {
        std::pair<ExactAnswer, std::optional<Error>> both;
        if (json.contains("error")) {
          both.second = Error{static_cast<ErrorCode>(json.at("error").get<int>()),
                              text_from(json.at("file")), text_from(json.at("where")),
                              text_from(json.at("what")), text_from(json.at("mend"))};
        } else {
          both.first = json.get<ExactAnswer>();
        }
        return both;
      });
  if (!answer) return answer.error();
  if (answer->second) return *answer->second;
  return std::move(answer->first);
}

}  // namespace forcelayer::voxcheck
