// Reading the typed arrays of glTF ("accessors") out of its buffers.
#include <cmath>
#include <cstring>
#include <limits>

#include "formats/mesh/readers/gltf/gltf_document.h"

namespace forcelayer::mesh {
namespace {

enum ComponentType : std::uint64_t {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126,
};

std::uint64_t byte_size(std::uint64_t component_type) {
  switch (component_type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

std::uint64_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4") return 4;
  if (type == "MAT4") return 16;
  return 0;  // smaller matrices are of no use to a mesh
}

template <typename T>
double value_at(const char* at, bool normalized) {
  T value;
  std::memcpy(&value, at, sizeof value);
  if (!normalized || std::is_floating_point_v<T>) return static_cast<double>(value);
  return std::max(static_cast<double>(value) / std::numeric_limits<T>::max(), -1.0);
}

double component_at(const char* at, std::uint64_t component_type, bool normalized) {
  switch (component_type) {
    case kByte:
      return value_at<std::int8_t>(at, normalized);
    case kUnsignedByte:
      return value_at<std::uint8_t>(at, normalized);
    case kShort:
      return value_at<std::int16_t>(at, normalized);
    case kUnsignedShort:
      return value_at<std::uint16_t>(at, normalized);
    case kUnsignedInt:
      return value_at<std::uint32_t>(at, normalized);
    default:
      return value_at<float>(at, normalized);
  }
}

}  // namespace

// An accessor, or one of the two arrays of a sparse one, checked against its buffer view.
struct GltfDocument::Accessor {
  std::string where;
  std::uint64_t count = 0;
  std::uint64_t components = 0;
  std::uint64_t component_type = 0;
  bool normalized = false;
  std::uint64_t stride = 0;  // bytes
  std::string_view bytes;    // from the first element on; empty where all elements are zero

  // Sets `bytes` and `stride`; throws where the elements reach beyond the view.
  void place(const GltfDocument& document, std::uint64_t view, std::uint64_t offset) {
    const std::uint64_t element_bytes = components * byte_size(component_type);
    const nlohmann::json& view_json = document.element("bufferViews", view);
    stride = document.index_or(view_json, "byteStride", element_bytes);
    bytes = document.buffer_view(view);
    if (stride < element_bytes) {
      document.fail(ErrorCode::kMeshUnreadable, where,
                    "has elements that overlap: byteStride is too small");
    }
    if (count == 0) return;
    if (offset > bytes.size() || bytes.size() - offset < element_bytes ||
        (bytes.size() - offset - element_bytes) / stride < count - 1) {
      document.fail(
          ErrorCode::kMeshIncomplete, where,
          "has " + std::to_string(count) + " elements, but its buffer view is too small for them",
          "copy or export the file again");
    }
    bytes.remove_prefix(offset);
  }
};

GltfDocument::Accessor GltfDocument::accessor(std::uint64_t accessor_index) const {
  const nlohmann::json& json = element("accessors", accessor_index);
  Accessor accessor;
  accessor.where = "accessors[" + std::to_string(accessor_index) + "]";
  accessor.count = index(json, "count");
  accessor.component_type = index(json, "componentType");
  accessor.components = components_of(json.value("type", ""));
  accessor.normalized = json.value("normalized", false);
  if (accessor.components == 0 || byte_size(accessor.component_type) == 0) {
    fail(ErrorCode::kMeshUnreadable, accessor.where, "has an unknown type");
  }
  if (json.contains("bufferView")) {
    accessor.place(*this, index(json, "bufferView"), index_or(json, "byteOffset", 0));
  } else if (!json.contains("sparse") || accessor.count > buffer_bytes_) {
    // Zeros that nothing replaces, or more of them than the whole file has bytes, are no mesh.
    fail(ErrorCode::kMeshIncomplete, accessor.where, "has elements without data");
  }
  return accessor;
}

void GltfDocument::read_components(const Accessor& accessor, std::vector<double>& numbers) const {
  const std::uint64_t component_bytes = byte_size(accessor.component_type);
  numbers_read_ += accessor.count * accessor.components;
  if (numbers_read_ > max_unfolded()) {
    fail(ErrorCode::kMeshUnsupported, accessor.where,
         "the file's meshes share data: with a copy for each mesh, they have more than " +
             std::to_string(max_unfolded()) + " numbers",
         "export each mesh with its own vertices");
  }
  numbers.assign(accessor.count * accessor.components, 0.0);
  if (accessor.bytes.empty()) return;
  auto number = numbers.begin();
  for (std::uint64_t i = 0; i < accessor.count; ++i) {
    const char* at = accessor.bytes.data() + i * accessor.stride;
    for (std::uint64_t c = 0; c < accessor.components; ++c, at += component_bytes) {
      *number++ = component_at(at, accessor.component_type, accessor.normalized);
    }
  }
}

void GltfDocument::apply_sparse(const nlohmann::json& json, const Accessor& accessor,
                                std::vector<double>& numbers) const {
  const auto sparse = json.find("sparse");
  if (sparse == json.end()) return;
  Accessor places{accessor.where + ".sparse", index(*sparse, "count"), 1, 0, false, 0, {}};
  Accessor values = accessor;
  values.count = places.count;
  const nlohmann::json& place_json = sparse->at("indices");
  const nlohmann::json& value_json = sparse->at("values");
  places.component_type = index(place_json, "componentType");
  if (byte_size(places.component_type) == 0) {
    fail(ErrorCode::kMeshUnreadable, places.where, "has an unknown type");
  }
  places.place(*this, index(place_json, "bufferView"), index_or(place_json, "byteOffset", 0));
  values.place(*this, index(value_json, "bufferView"), index_or(value_json, "byteOffset", 0));
  std::vector<double> elements, replaced;
  read_components(places, elements);
  read_components(values, replaced);
  for (std::uint64_t i = 0; i < places.count; ++i) {
    if (!(elements[i] >= 0 && elements[i] < static_cast<double>(accessor.count))) {
      fail(ErrorCode::kMeshUnreadable, places.where, "replaces an element that does not exist");
    }
    const auto element_index = static_cast<std::uint64_t>(elements[i]);
    for (std::uint64_t c = 0; c < accessor.components; ++c) {
      numbers[element_index * accessor.components + c] = replaced[i * accessor.components + c];
    }
  }
}

std::vector<double> GltfDocument::read_numbers(std::uint64_t accessor_index,
                                               std::uint64_t components) const {
  const Accessor found = accessor(accessor_index);
  if (found.components != components) {
    fail(ErrorCode::kMeshUnreadable, found.where,
         "has " + std::to_string(found.components) + " components instead of " +
             std::to_string(components));
  }
  std::vector<double> numbers;
  read_components(found, numbers);
  apply_sparse(element("accessors", accessor_index), found, numbers);
  return numbers;
}

std::vector<std::uint32_t> GltfDocument::read_indices(std::uint64_t accessor_index) const {
  const Accessor found = accessor(accessor_index);
  const bool unsigned_integer = found.component_type == kUnsignedByte ||
                                found.component_type == kUnsignedShort ||
                                found.component_type == kUnsignedInt;
  if (found.components != 1 || !unsigned_integer || found.normalized) {
    fail(ErrorCode::kMeshUnreadable, found.where, "must be a list of vertex numbers");
  }
  const std::vector<double> numbers = read_numbers(accessor_index, 1);
  return {numbers.begin(), numbers.end()};  // exact: 32-bit integers are doubles
}

}  // namespace forcelayer::mesh
