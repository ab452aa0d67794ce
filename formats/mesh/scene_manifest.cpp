#include "formats/mesh/scene_manifest.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "formats/command/quantity.h"
#include "formats/file/file_bytes.h"
#include "formats/mesh/checks/unique_keys.h"

namespace forcelayer::mesh {
namespace {

using Json = nlohmann::json;

// Thrown within this file only; read_manifest() turns it into an Error.
struct BadKey {
  std::string key, what, mend;
};

std::string joined(const std::string& parent, const std::string& key) {
  return parent.empty() ? key : parent + "." + key;
}

// A JSON object whose keys are all known, with the path that leads to it.
class Fields {
 public:
  Fields(const Json& json, std::string path, std::initializer_list<const char*> known)
      : json_(json), path_(std::move(path)) {
    if (!json.is_object()) throw BadKey{path_, "is not a JSON object", "write it in braces: {...}"};
    const std::set<std::string> names(known.begin(), known.end());
    std::string list;
    for (const char* name : known) list += list.empty() ? name : std::string(", ") + name;
    for (const auto& [key, value] : json.items()) {
      if (!names.contains(key))
        throw BadKey{joined(path_, key), "is not a known key", "use one of " + list};
    }
  }

  const Json* find(const char* key) const {
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
  }
  std::string path(const char* key) const { return joined(path_, key); }

 private:
  const Json& json_;
  std::string path_;
};

double finite_number(const Json& json, const std::string& key) {
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    throw BadKey{key, "is not a finite number", ""};
  return json.get<double>();
}

std::string text(const Json& json, const std::string& key) {
  if (!json.is_string() || json.get_ref<const std::string&>().empty()) {
    throw BadKey{key, "is not a text, or is empty", ""};
  }
  return json.get<std::string>();
}

template <class T>
T parsed(Result<T> result, const std::string& key) {
  if (!result) throw BadKey{key, result.error().what, result.error().mend};
  return std::move(*result);
}

// A text with a unit, or 0.
double length(const Json& json, const std::string& key) {
  if (json.is_number()) {
    const double number = finite_number(json, key);
    if (number == 0) return 0;
    throw BadKey{key, "is " + json.dump() + " without a unit", R"(write it like "5mm")"};
  }
  return parsed(command::parse_length(text(json, key)), key);
}

template <std::size_t N>
std::array<double, N> lengths(const Json& json, const std::string& key) {
  if (!json.is_array() || json.size() != N) {
    throw BadKey{key, "is not a list of " + std::to_string(N) + " lengths", ""};
  }
  std::array<double, N> values;
  for (std::size_t i = 0; i < N; ++i)
    values[i] = length(json[i], key + "[" + std::to_string(i) + "]");
  return values;
}

template <std::size_t N>
std::array<double, N> numbers(const Json& json, const std::string& key) {
  if (!json.is_array() || json.size() != N) {
    throw BadKey{key, "is not a list of " + std::to_string(N) + " numbers", ""};
  }
  std::array<double, N> values;
  for (std::size_t i = 0; i < N; ++i) {
    values[i] = finite_number(json[i], key + "[" + std::to_string(i) + "]");
  }
  return values;
}

std::vector<Vec3d> points(const Json& json, const std::string& key) {
  if (!json.is_array()) throw BadKey{key, "is not a list of points", ""};
  std::vector<Vec3d> list;
  for (std::size_t i = 0; i < json.size(); ++i) {
    list.push_back(lengths<3>(json[i], key + "[" + std::to_string(i) + "]"));
  }
  return list;
}

std::vector<std::string> names(const Json& json, const std::string& key) {
  if (!json.is_array()) throw BadKey{key, "is not a list of names", R"(write it like ["Cover"])"};
  std::vector<std::string> list;
  for (std::size_t i = 0; i < json.size(); ++i) {
    list.push_back(text(json[i], key + "[" + std::to_string(i) + "]"));
  }
  return list;
}

// Four rows of three numbers and a length; the last row is 0 0 0 1.
Affine matrix(const Json& json, const std::string& key) {
  if (!json.is_array() || json.size() != 4) throw BadKey{key, "is not a list of four rows", ""};
  Affine affine;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::string row_key = key + "[" + std::to_string(i) + "]";
    if (i == 3) {
      if (json[i] != Json{0, 0, 0, 1}) {
        throw BadKey{row_key, "is not 0, 0, 0, 1",
                     "give the matrix row by row, with the translation last in each row"};
      }
      continue;
    }
    if (!json[i].is_array() || json[i].size() != 4) {
      throw BadKey{row_key, "is not a list of four: three numbers, then a length",
                   R"(write it like [1, 0, 0, "5mm"])"};
    }
    for (std::size_t j = 0; j < 3; ++j) {
      affine.linear[i * 3 + j] = finite_number(json[i][j], row_key + "[" + std::to_string(j) + "]");
    }
    affine.translation[i] = length(json[i][3], row_key + "[3]");
  }
  return affine;
}

// Row-major matrix of a quaternion w, x, y, z, which is normalized.
std::array<double, 9> rotation(const Json& json, const std::string& key) {
  auto q = numbers<4>(json, key);
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  // Below the least normal double nothing is left of its digits.
  if (!(norm >= std::numeric_limits<double>::min()) || !std::isfinite(norm))
    throw BadKey{key, "is a quaternion (w, x, y, z) whose norm is 0, too small or not finite", ""};
  for (double& c : q) c /= norm;
  const auto [w, x, y, z] = q;
  return {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
          2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
          2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
}

Vec3d scale(const Json& json, const std::string& key) {
  if (json.is_number()) {
    const double factor = finite_number(json, key);
    return {factor, factor, factor};
  }
  return numbers<3>(json, key);
}

Affine placement(const Fields& fields) {
  const Json *whole = fields.find("matrix"), *moved = fields.find("translation"),
             *turned = fields.find("rotation"), *scaled = fields.find("scale");
  if (whole != nullptr) {
    if (moved != nullptr || turned != nullptr || scaled != nullptr) {
      throw BadKey{fields.path("matrix"), "is given together with translation, rotation or scale",
                   "leave out the matrix, or leave out translation, rotation and scale"};
    }
    return matrix(*whole, fields.path("matrix"));
  }
  Affine affine;
  if (turned != nullptr) affine.linear = rotation(*turned, fields.path("rotation"));
  if (scaled != nullptr) {
    const Vec3d factor = scale(*scaled, fields.path("scale"));
    for (std::size_t i = 0; i < 9; ++i) affine.linear[i] *= factor[i % 3];
  }
  if (moved != nullptr) affine.translation = lengths<3>(*moved, fields.path("translation"));
  return affine;
}

ManifestObject read_object(const Json& json, const std::string& key,
                           const std::filesystem::path& folder) {
  const Fields fields(json, key,
                      {"name", "mesh", "units", "up", "matrix", "translation", "rotation", "scale",
                       "free_seeds", "mesh_deviation"});
  ManifestObject object;
  const Json* mesh = fields.find("mesh");
  if (mesh == nullptr)
    throw BadKey{fields.path("mesh"), "is missing", "name the mesh file of this object"};
  object.mesh = (folder / text(*mesh, fields.path("mesh"))).string();
  if (const Json* name = fields.find("name")) object.name = text(*name, fields.path("name"));
  if (const Json* units = fields.find("units")) {
    object.meters_per_unit =
        parsed(command::parse_unit(text(*units, fields.path("units"))), fields.path("units"));
  }
  if (const Json* up = fields.find("up")) {
    const std::string axis = text(*up, fields.path("up"));
    if (axis != "y" && axis != "z") {
      throw BadKey{
          fields.path("up"), "is neither \"y\" nor \"z\"",
          "write \"y\" to keep the axes of a glTF file, or \"z\" to turn them so that z is up"};
    }
    object.up = axis == "y" ? Up::kY : Up::kZ;
  }
  object.world_from_object = placement(fields);
  if (is_flat(object.world_from_object)) {
    throw BadKey{fields.path(fields.find("matrix") != nullptr ? "matrix" : "scale"),
                 "collapses the object to a plane, a line or a point",
                 "to leave the object out, list its name in \"without\""};
  }
  if (const Json* seeds = fields.find("free_seeds"))
    object.free_seeds_m = points(*seeds, fields.path("free_seeds"));
  if (const Json* deviation = fields.find("mesh_deviation")) {
    object.deviation_m = length(*deviation, fields.path("mesh_deviation"));
    if (object.deviation_m < 0) throw BadKey{fields.path("mesh_deviation"), "is negative", ""};
  }
  return object;
}

std::array<double, 6> box(const Json& json, const std::string& key) {
  const auto values = lengths<6>(json, key);
  for (std::size_t d = 0; d < 3; ++d) {
    if (!(values[d] < values[d + 3]))
      throw BadKey{key, "is not x0, y0, z0, x1, y1, z1 with x0 < x1, y0 < y1 and z0 < z1", ""};
  }
  return values;
}

Manifest read_fields(const Json& json, const std::filesystem::path& folder) {
  const Fields fields(json, "", {"voxel_size", "layers", "roi", "free_seeds", "without", "parts"});
  Manifest manifest;
  if (const Json* size = fields.find("voxel_size")) {
    manifest.voxel_size_m = length(*size, "voxel_size");
    if (!(*manifest.voxel_size_m > 0)) throw BadKey{"voxel_size", "is not above zero", ""};
  }
  if (const Json* layers = fields.find("layers")) {
    if (!layers->is_number_unsigned() || layers->get<std::uint64_t>() > UINT32_MAX) {
      throw BadKey{"layers", "is not a whole number of zero or more", ""};
    }
    manifest.layers = layers->get<std::uint32_t>();
  }
  if (const Json* roi = fields.find("roi")) manifest.roi_m = box(*roi, "roi");
  if (const Json* seeds = fields.find("free_seeds"))
    manifest.free_seeds_m = points(*seeds, "free_seeds");
  if (const Json* without = fields.find("without")) manifest.without = names(*without, "without");
  const Json* parts = fields.find("parts");
  if (parts == nullptr || !parts->is_array() || parts->empty()) {
    throw BadKey{"parts", "is missing, empty or not a list",
                 "list at least one object with its mesh"};
  }
  for (std::size_t i = 0; i < parts->size(); ++i) {
    manifest.objects.push_back(
        read_object((*parts)[i], "parts[" + std::to_string(i) + "]", folder));
  }
  return manifest;
}

}  // namespace

Result<Manifest> read_manifest(const std::string& path) {
  const auto file = FileBytes::read(path);
  if (!file) return file.error();
  const auto* first = reinterpret_cast<const char*>(file->bytes().data());
  try {
    std::string repeated;
    const Json json = parse_json<Json>(std::string_view(first, file->bytes().size()), repeated);
    if (!repeated.empty())
      throw BadKey{repeated, "is given twice in the same JSON object", "keep one of them"};
    return read_fields(json, std::filesystem::path(path).parent_path());
  } catch (const Json::parse_error& error) {
    return Error{ErrorCode::kSceneInvalid, path, "byte " + std::to_string(error.byte),
                 "the JSON is not valid here", "correct it"};
  } catch (const Json::out_of_range&) {
    return Error{ErrorCode::kSceneInvalid, path, "",
                 "the file has a number that is too large for a double", "write a smaller number"};
  } catch (const BadKey& bad) {
    return Error{ErrorCode::kSceneInvalid, path, bad.key, bad.what, bad.mend};
  }
}

}  // namespace forcelayer::mesh
