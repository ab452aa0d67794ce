// A glTF 2.0 asset: its JSON, its binary buffers, and the accessors that read them.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "formats/file/file_bytes.h"
#include "formats/mesh/mesh.h"
#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

class GltfDocument {
 public:
  // Takes .glb and .gltf apart and loads every buffer (of the file itself, of data URIs and of
  // files beside it). Throws ReadFailure.
  explicit GltfDocument(const SourceFile& file);

  const SourceFile& file() const { return file_; }
  const nlohmann::json& json() const { return json_; }

  // The element `index` of the top-level array `list`, such as "nodes"; throws where there is none.
  const nlohmann::json& element(const char* list, std::uint64_t index) const;
  std::uint64_t count(const char* list) const;

  // A whole number from 0 in `object`; throws where it is something else, or missing.
  std::uint64_t index(const nlohmann::json& object, const char* key) const;
  // One of a list; `key` is the list's.
  std::uint64_t whole_number(const nlohmann::json& json, const char* key) const;
  std::uint64_t index_or(const nlohmann::json& object, const char* key,
                         std::uint64_t missing) const;

  // The bytes of a view; those of a compressed one (EXT_meshopt_compression) as they were before.
  std::string_view buffer_view(std::uint64_t index) const;

  // The most numbers, and the most instances, that accessors, meshes and nodes may make by sharing
  // data of the file.
  std::uint64_t max_unfolded() const;

  // An accessor of type SCALAR with unsigned integers.
  std::vector<std::uint32_t> read_indices(std::uint64_t accessor) const;
  // An accessor of floats or normalized or plain integers, [count][components].
  std::vector<double> read_numbers(std::uint64_t accessor, std::uint64_t components) const;

  [[noreturn]] void fail(ErrorCode code, std::string where, std::string what,
                         std::string mend = "export the mesh again") const;

 private:
  struct Accessor;

  std::string_view take_apart_glb(std::string_view& binary) const;
  void parse_json(std::string_view text);
  void check_version_and_extensions() const;
  [[noreturn]] void fail_meshopt(std::string where) const;
  void load_buffers(std::string_view binary);
  std::string_view load_buffer(const nlohmann::json& buffer, std::uint64_t index);
  std::string_view stored_view(const nlohmann::json& view, const std::string& where) const;
  std::string decompressed_view(const nlohmann::json& extension, const std::string& where) const;
  Accessor accessor(std::uint64_t index) const;
  void read_components(const Accessor& accessor, std::vector<double>& numbers) const;
  void apply_sparse(const nlohmann::json& json, const Accessor& accessor,
                    std::vector<double>& numbers) const;

  const SourceFile& file_;
  nlohmann::json json_;
  std::deque<std::string> decoded_buffers_;  // of data URIs
  std::deque<FileBytes> file_buffers_;       // of files beside this one
  std::vector<std::string_view> buffers_;
  std::uint64_t buffer_bytes_ = 0;  // of all buffers
  mutable std::map<std::uint64_t, std::string> decompressed_views_;
  mutable std::uint64_t decompressed_bytes_ = 0;  // of these
  mutable std::uint64_t numbers_read_ = 0;
};

}  // namespace forcelayer::mesh
