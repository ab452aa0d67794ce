#include "formats/mesh/readers/gltf/gltf_document.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <filesystem>

#include "formats/mesh/checks/confined_path.h"
#include "formats/mesh/checks/unique_keys.h"
#include "formats/mesh/readers/gltf/meshopt_view.h"

namespace forcelayer::mesh {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are read in place");

constexpr std::string_view kGlbMagic = "glTF";
constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinaryChunk = 0x004e4942;

// Extensions that an asset may require: this reader honors them, or they move no vertex.
constexpr std::string_view kKnownExtensions[] = {
    "KHR_draco_mesh_compression", "KHR_mesh_quantization", "EXT_mesh_gpu_instancing",
    "KHR_texture_transform",      "KHR_texture_basisu",    "EXT_texture_webp",
    "EXT_texture_avif",           "KHR_lights_punctual",   "KHR_xmp_json_ld"};
constexpr const char* kMeshopt = "EXT_meshopt_compression";

// The object of an extension, or null.
const nlohmann::json* extension_of(const nlohmann::json& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->contains(name)) return nullptr;
  return &extensions->at(name);
}

std::uint32_t uint32_at(std::string_view bytes, std::uint64_t offset) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

// The bytes of a base64 text; false if it is not base64.
bool decode_base64(std::string_view text, std::string& bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (text.ends_with('=')) text.remove_suffix(1);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const char c : text) {
    const auto digit = kDigits.find(c);
    if (digit == std::string_view::npos) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    bit_count += 6;
    if (bit_count < 8) continue;
    bit_count -= 8;
    bytes += static_cast<char>(bits >> bit_count & 0xff);
  }
  return true;
}

std::string decode_percent(std::string_view uri) {
  const auto digit = [](char c) {
    const auto lower = static_cast<char>(c | 0x20);
    return c >= '0' && c <= '9' ? c - '0' : lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
  };
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      path += static_cast<char>(16 * digit(uri[i + 1]) + digit(uri[i + 2]));
      i += 2;
    } else {
      path += uri[i];
    }
  }
  return path;
}

std::string in_list(const char* list, std::uint64_t index) {
  return std::string(list) + "[" + std::to_string(index) + "]";
}

}  // namespace

GltfDocument::GltfDocument(const SourceFile& file) : file_(file) {
  std::string_view binary;
  const bool is_glb = file.bytes.starts_with(kGlbMagic);
  parse_json(is_glb ? take_apart_glb(binary) : file.bytes);
  check_version_and_extensions();
  load_buffers(binary);
}

void GltfDocument::fail(ErrorCode code, std::string where, std::string what,
                        std::string mend) const {
  fail_read(file_, code, std::move(where), std::move(what), std::move(mend));
}

// Returns the JSON chunk and sets `binary` to the binary one, where there is one.
std::string_view GltfDocument::take_apart_glb(std::string_view& binary) const {
  constexpr std::uint64_t kHeader = 12, kChunkHeader = 8;
  const std::string_view bytes = file_.bytes;
  if (bytes.size() < kHeader) {
    fail(ErrorCode::kMeshIncomplete, at_byte(bytes.size()), "the file ends inside the GLB header");
  }
  if (const std::uint32_t version = uint32_at(bytes, 4); version != 2) {
    fail(ErrorCode::kMeshUnsupported, at_byte(4),
         "GLB version " + std::to_string(version) + " is not supported",
         "export the mesh as glTF 2.0");
  }
  const std::uint64_t announced = uint32_at(bytes, 8);
  if (announced != bytes.size()) {
    fail(ErrorCode::kMeshIncomplete, at_byte(std::min<std::uint64_t>(announced, bytes.size())),
         "the GLB header announces " + std::to_string(announced) + " bytes, but the file has " +
             std::to_string(bytes.size()),
         "copy or export the file again");
  }
  std::string_view json;
  for (std::uint64_t at = kHeader, chunk = 0; at != bytes.size(); ++chunk) {
    if (bytes.size() - at < kChunkHeader ||
        uint32_at(bytes, at) > bytes.size() - at - kChunkHeader) {
      fail(ErrorCode::kMeshIncomplete, at_byte(at), "a GLB chunk is longer than the file");
    }
    const std::uint64_t length = uint32_at(bytes, at);
    const std::uint32_t type = uint32_at(bytes, at + 4);
    const std::string_view content = bytes.substr(at + kChunkHeader, length);
    if (chunk == 0 && type != kJsonChunk) {
      fail(ErrorCode::kMeshUnreadable, at_byte(at), "the first GLB chunk is not JSON");
    }
    if (chunk == 0) json = content;
    if (chunk == 1 && type == kBinaryChunk) binary = content;
    at += kChunkHeader + length;
  }
  return json;
}

void GltfDocument::parse_json(std::string_view text) {
  std::string repeated;
  try {
    json_ = mesh::parse_json<nlohmann::json>(text, repeated);
  } catch (const nlohmann::json::parse_error& error) {
    fail(ErrorCode::kMeshUnreadable, "JSON " + at_byte(error.byte), "not valid JSON");
  }
  if (!json_.is_object()) fail(ErrorCode::kMeshUnreadable, "JSON", "the file is not a JSON object");
  if (!repeated.empty()) {
    fail(ErrorCode::kMeshUnreadable, "JSON",
         "an object has the key " + in_quotes(repeated) + " twice, and only one can be read",
         "export the file again");
  }
}

void GltfDocument::check_version_and_extensions() const {
  const auto asset = json_.find("asset");
  if (asset == json_.end() || !asset->is_object()) {
    fail(ErrorCode::kMeshUnreadable, "asset", "not a glTF file: 'asset' is missing");
  }
  const std::string version = asset->value("version", "");
  if (!version.starts_with("2.")) {
    fail(ErrorCode::kMeshUnsupported, "asset",
         "glTF version " + in_quotes(version) + " is not supported", "export the mesh as glTF 2.0");
  }
  const auto required = json_.find("extensionsRequired");
  if (required == json_.end()) return;
  for (const auto& entry : *required) {
    const std::string name = entry.get<std::string>();
    if (std::find(std::begin(kKnownExtensions), std::end(kKnownExtensions), name) !=
            std::end(kKnownExtensions) ||
        name.starts_with("KHR_materials_")) {
      continue;
    }
    if (name == kMeshopt && reads_meshopt()) continue;
    if (name == kMeshopt) fail_meshopt("extensionsRequired");
    fail(ErrorCode::kMeshUnsupported, "extensionsRequired",
         "the extension " + in_quotes(name) + " is not supported", "export the mesh without it");
  }
}

void GltfDocument::fail_meshopt(std::string where) const {
  fail(ErrorCode::kMeshUnsupported, std::move(where),
       std::string("this build does not support ") + kMeshopt,
       "build with libmeshoptimizer-dev, or export without compression");
}

const nlohmann::json& GltfDocument::element(const char* list, std::uint64_t index) const {
  if (index >= count(list)) {
    fail(ErrorCode::kMeshUnreadable, in_list(list, index),
         "does not exist (length of the list: " + std::to_string(count(list)) + ")");
  }
  const nlohmann::json& found = json_[list][index];
  if (!found.is_object()) {
    fail(ErrorCode::kMeshUnreadable, in_list(list, index), "is not a JSON object");
  }
  return found;
}

std::uint64_t GltfDocument::count(const char* list) const {
  const auto found = json_.find(list);
  if (found == json_.end()) return 0;
  if (!found->is_array()) fail(ErrorCode::kMeshUnreadable, list, "is not a JSON array");
  return found->size();
}

std::uint64_t GltfDocument::index(const nlohmann::json& object, const char* key) const {
  const auto found = object.find(key);
  if (found == object.end()) fail(ErrorCode::kMeshUnreadable, key, "is missing");
  return whole_number(*found, key);
}

std::uint64_t GltfDocument::whole_number(const nlohmann::json& json, const char* key) const {
  if (json.is_number_unsigned()) return json.get<std::uint64_t>();
  if (json.is_number_float()) {
    const double number = json.get<double>();
    // Some writers print whole numbers as 12.0.
    if (number >= 0 && number < 9e15 &&
        number == static_cast<double>(static_cast<std::uint64_t>(number))) {
      return static_cast<std::uint64_t>(number);
    }
  }
  fail(ErrorCode::kMeshUnreadable, key, "is not a whole number of zero or more");
}

std::uint64_t GltfDocument::index_or(const nlohmann::json& object, const char* key,
                                     std::uint64_t missing) const {
  return object.contains(key) ? index(object, key) : missing;
}

void GltfDocument::load_buffers(std::string_view binary) {
  const std::uint64_t buffer_count = count("buffers");
  for (std::uint64_t i = 0; i < buffer_count; ++i) {
    const nlohmann::json& buffer = element("buffers", i);
    std::string_view bytes = binary;
    // Stands in for readers that do not know the compression, and has no bytes.
    const nlohmann::json* const meshopt = extension_of(buffer, kMeshopt);
    if (meshopt != nullptr && meshopt->value("fallback", false) && !buffer.contains("uri")) {
      if (!reads_meshopt()) fail_meshopt(in_list("buffers", i));
      buffers_.emplace_back();
      continue;
    }
    if (buffer.contains("uri")) {
      bytes = load_buffer(buffer, i);
    } else if (i != 0) {
      fail(ErrorCode::kMeshIncomplete, in_list("buffers", i), "has no 'uri'");
    }
    const std::uint64_t announced = index(buffer, "byteLength");
    if (announced > bytes.size()) {
      fail(ErrorCode::kMeshIncomplete, in_list("buffers", i),
           "announces " + std::to_string(announced) + " bytes but has " +
               std::to_string(bytes.size()),
           "copy or export the file again");
    }
    buffers_.push_back(bytes.substr(0, announced));
    buffer_bytes_ += announced;
  }
}

std::string_view GltfDocument::load_buffer(const nlohmann::json& buffer, std::uint64_t index) {
  const std::string uri = buffer["uri"].get<std::string>();
  const std::string where = in_list("buffers", index);
  if (uri.starts_with("data:")) {
    const auto comma = uri.find(";base64,");
    std::string bytes;
    if (comma == std::string::npos ||
        !decode_base64(std::string_view(uri).substr(comma + 8), bytes)) {
      fail(ErrorCode::kMeshUnreadable, where, "the data URI is not valid base64");
    }
    return decoded_buffers_.emplace_back(std::move(bytes));
  }
  if (uri.find("://") != std::string::npos) {
    fail(ErrorCode::kMeshUnsupported, where,
         "the buffer " + in_quotes(uri) + " is not a local file",
         "put the buffer beside the .gltf file");
  }
  const auto folder = std::filesystem::path(file_.path).parent_path();
  const auto path = folder / decode_percent(uri);
  if (!file_.options.allow_outside && !lies_under(path, folder)) {
    fail(ErrorCode::kMeshUnsupported, where, "the buffer " + in_quotes(uri) + " " + kOutsideWhat,
         kOutsideMend);
  }
  auto bytes = FileBytes::read(path);
  if (!bytes) {
    Error error = bytes.error();
    error.where = where + " of " + file_.path;
    throw ReadFailure{error};
  }
  return text_of(file_buffers_.emplace_back(std::move(*bytes)));
}

std::uint64_t GltfDocument::max_unfolded() const {
  constexpr std::uint64_t kAlways = 1'000'000, kPerByte = 32;
  return kAlways + kPerByte * (file_.bytes.size() + buffer_bytes_);
}

std::string_view GltfDocument::buffer_view(std::uint64_t view_index) const {
  const nlohmann::json& view = element("bufferViews", view_index);
  const std::string where = in_list("bufferViews", view_index);
  const nlohmann::json* const meshopt = extension_of(view, kMeshopt);
  if (meshopt == nullptr || !reads_meshopt()) return stored_view(view, where);
  const auto known = decompressed_views_.find(view_index);
  if (known != decompressed_views_.end()) return known->second;
  std::string bytes = decompressed_view(*meshopt, where);
  if (bytes.size() != index(view, "byteLength")) {
    fail(ErrorCode::kMeshUnreadable, where,
         "announces " + std::to_string(index(view, "byteLength")) +
             " bytes, but its compressed stream gives " + std::to_string(bytes.size()));
  }
  return decompressed_views_.emplace(view_index, std::move(bytes)).first->second;
}

std::string GltfDocument::decompressed_view(const nlohmann::json& extension,
                                            const std::string& where) const {
  MeshoptView view;
  view.packed = stored_view(extension, where);
  view.mode = extension.at("mode").get<std::string>();
  view.filter = extension.value("filter", "NONE");
  view.count = index(extension, "count");
  view.stride = index(extension, "byteStride");
  constexpr std::uint64_t kLongestElement = 256;
  const std::uint64_t largest = sizeof(double) * max_unfolded();
  if (view.stride > kLongestElement || view.count > largest ||
      (decompressed_bytes_ += view.count * view.stride) > largest) {
    fail(ErrorCode::kMeshUnsupported, where,
         "would expand the data of the file to more than " + std::to_string(largest) + " bytes");
  }
  auto bytes = decode_meshopt(view);
  if (!bytes) {
    fail(ErrorCode::kMeshUnreadable, where, "the " + std::string(kMeshopt) + " stream is damaged",
         "copy or export the file again");
  }
  return std::move(*bytes);
}

std::string_view GltfDocument::stored_view(const nlohmann::json& view,
                                           const std::string& where) const {
  const std::uint64_t buffer = index(view, "buffer");
  if (buffer >= buffers_.size()) {
    fail(ErrorCode::kMeshUnreadable, where, "names a buffer that does not exist");
  }
  const std::uint64_t offset = index_or(view, "byteOffset", 0);
  const std::uint64_t length = index(view, "byteLength");
  if (offset > buffers_[buffer].size() || length > buffers_[buffer].size() - offset) {
    fail(ErrorCode::kMeshIncomplete, where, "reaches beyond its buffer",
         "copy or export the file again");
  }
  return buffers_[buffer].substr(offset, length);
}

}  // namespace forcelayer::mesh
