#include "voxelize/cache/mesh_source.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <filesystem>
#include <map>
#include <utility>

#include "formats/mesh/reader.h"
#include "formats/mesh/units.h"
#include "formats/mesh/up_axis.h"
#include "voxelize/cache/byte_pack.h"
#include "voxelize/cache/cache_versions.h"
#include "voxelize/cache/reading_slots.h"

namespace forcelayer::cache {
namespace {

constexpr const char* kAssemblyKind = "assembly";
constexpr const char* kFactsKind = "facts";

std::vector<MeshOutline> outlines_of(const mesh::Assembly& assembly) {
  std::vector<MeshOutline> outlines;
  for (const mesh::Mesh& mesh : assembly.meshes) outlines.push_back(outline_of(mesh));
  return outlines;
}

bool contains(std::string_view text, std::string_view word) {
  return text.find(word) != std::string_view::npos;
}

// Whether the file may refer to others: then its bytes are no key.
bool may_refer_to_files(std::string_view bytes, const std::string& extension) {
  if (extension == ".gltf" || extension == ".glb") return contains(bytes, "\"uri\"");
  if (extension == ".stp" || extension == ".step") {
    return contains(bytes, "DOCUMENT_FILE") || contains(bytes, "EXTERNAL");
  }
  return false;
}

// The digest of everything that reading a file depends on; nothing where other files may count.
std::optional<Digest> assembly_key(const std::string& path, const mesh::ReadOptions& options) {
  const NamedFile source = named_file(path);
  const auto file = FileBytes::read(source.path);
  if (!file) return std::nullopt;  // reading it will say why
  const std::filesystem::path name = std::filesystem::path(source.path).filename();
  std::string extension = name.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (may_refer_to_files(mesh::text_of(*file), extension)) return std::nullopt;
  DigestBuilder digest;
  digest.text(kAssemblyKind).value(kAssemblyCacheVersion);
  digest.text(name.string());  // nodes without names are called by the file's
  digest.text(mesh::name_of(options.up));
  digest.value(std::uint64_t{options.nodes.size()});
  for (const std::string& node : options.nodes) digest.text(node);
  if (extension.starts_with(".st") || extension.starts_with(".ig")) {
    if (extension != ".stl") digest.value(options.deflection_m).value(options.missing_faces);
  }
  for (const std::string& node : options.without) digest.text(node);
  return digest.value(digest_of(file->bytes())).finish();
}

// The assembly without its meshes. There is an outline for each.
std::vector<std::byte> pack(const mesh::Assembly& assembly,
                            const std::vector<MeshOutline>& outlines) {
  BytePacker packer;
  packer.list(outlines);
  packer.value(std::uint64_t{assembly.instances.size()});
  for (const mesh::MeshInstance& instance : assembly.instances) {
    packer.value(instance.mesh);
    packer.text(instance.name);
    packer.value(instance.assembly_from_mesh);
    packer.value(instance.box);
    packer.value(instance.deviation_units);
  }
  packer.value(std::uint64_t{assembly.meters_per_unit.has_value()});
  packer.value(assembly.meters_per_unit.value_or(0));
  packer.value(std::uint64_t{assembly.up.has_value()});
  packer.value(std::uint64_t{assembly.up == mesh::Up::kY});
  packer.value(std::uint64_t{assembly.warnings.size()});
  for (const std::string& warning : assembly.warnings) packer.text(warning);
  packer.value(std::uint64_t{assembly.missing_faces.size()});
  for (const mesh::MissingFace& face : assembly.missing_faces) {
    packer.text(face.node);
    packer.value(face.center);
    packer.value(face.size);
  }
  packer.value(std::uint64_t{assembly.nodes.size()});
  for (const mesh::AssemblyNode& node : assembly.nodes) {
    packer.text(node.label);
    packer.text(node.path);
    packer.value(std::uint64_t{node.depth});
    packer.value(std::array{node.first_instance, node.instance_count});
  }
  packer.value(std::uint64_t{assembly.left_out.size()});
  for (const std::string& name : assembly.left_out) packer.text(name);
  return packer.bytes();
}

std::optional<mesh::Assembly> unpack(std::span<const std::byte> bytes,
                                     std::vector<MeshOutline>& outlines) {
  try {
    ByteUnpacker unpacker(bytes);
    const auto list = unpacker.list<MeshOutline>();
    outlines.assign(list.begin(), list.end());
    mesh::Assembly assembly;
    assembly.meshes.resize(outlines.size());
    for (auto n = unpacker.value<std::uint64_t>(); n > 0; --n) {
      mesh::MeshInstance& instance = assembly.instances.emplace_back();
      instance.mesh = unpacker.value<std::uint32_t>();
      if (instance.mesh >= outlines.size()) return std::nullopt;
      instance.name = unpacker.text();
      instance.assembly_from_mesh = unpacker.value<mesh::Affine>();
      instance.box = unpacker.value<mesh::Box>();
      instance.deviation_units = unpacker.value<double>();
    }
    const bool has_unit = unpacker.value<std::uint64_t>() != 0;
    const auto unit = unpacker.value<double>();
    if (has_unit) assembly.meters_per_unit = unit;
    const bool has_up = unpacker.value<std::uint64_t>() != 0;
    const bool is_y_up = unpacker.value<std::uint64_t>() != 0;
    if (has_up) assembly.up = is_y_up ? mesh::Up::kY : mesh::Up::kZ;
    for (auto n = unpacker.value<std::uint64_t>(); n > 0; --n) {
      assembly.warnings.push_back(unpacker.text());
    }
    for (auto n = unpacker.value<std::uint64_t>(); n > 0; --n) {
      mesh::MissingFace& face = assembly.missing_faces.emplace_back();
      face.node = unpacker.text();
      face.center = unpacker.value<mesh::Vec3d>();
      face.size = unpacker.value<double>();
    }
    for (auto n = unpacker.value<std::uint64_t>(); n > 0; --n) {
      mesh::AssemblyNode& node = assembly.nodes.emplace_back();
      node.label = unpacker.text();
      node.path = unpacker.text();
      node.depth = unpacker.value<std::uint64_t>();
      const auto range = unpacker.value<std::array<std::uint32_t, 2>>();
      node.first_instance = range[0];
      node.instance_count = range[1];
      if (std::uint64_t{range[0]} + range[1] > assembly.instances.size()) return std::nullopt;
    }
    for (auto n = unpacker.value<std::uint64_t>(); n > 0; --n) {
      assembly.left_out.push_back(unpacker.text());
    }
    unpacker.expect_end();
    return assembly;
  } catch (const BadPack&) {
    return std::nullopt;
  }
}

struct FactsRecord {
  std::array<std::uint64_t, 8> counts;
  std::array<std::uint64_t, 2> flags;
  std::array<double, 8> measures;
};

FactsRecord record_of(const mesh::MeshFacts& f) {
  return {{f.triangles, f.vertices, f.distinct_vertices, f.degenerate_triangles,
           f.duplicate_triangles, f.boundary_edges, f.non_manifold_edges, f.flipped_edges},
          {f.closed, f.consistently_oriented},
          {f.min[0], f.min[1], f.min[2], f.max[0], f.max[1], f.max[2], f.area, f.signed_volume}};
}

mesh::MeshFacts facts_of(const FactsRecord& r) {
  const auto& [triangles, vertices, distinct, degenerate, duplicate, boundary, non_manifold,
               flipped] = r.counts;
  const auto& m = r.measures;
  return {triangles,
          vertices,
          distinct,
          degenerate,
          duplicate,
          boundary,
          non_manifold,
          flipped,
          r.flags[0] != 0,
          r.flags[1] != 0,
          {m[0], m[1], m[2]},
          {m[3], m[4], m[5]},
          m[6],
          m[7]};
}

// The memory that a file takes while it is read: an estimate from its size, high for its format.
double reading_bytes(const std::string& path) {
  constexpr double kOfCompressed = 40, kOfPlain = 10;
  const NamedFile source = named_file(path);
  const std::string extension = std::filesystem::path(source.path).extension().string();
  std::error_code failure;
  const auto size = static_cast<double>(std::filesystem::file_size(source.path, failure));
  if (failure) return 0;
  return size * (extension == ".drc" || extension.starts_with(".gl") ? kOfCompressed : kOfPlain);
}

}  // namespace

MeshOutline outline_of(const mesh::Mesh& mesh) {
  return {digest_of(std::as_bytes(std::span(mesh.vertices))),
          digest_of(std::as_bytes(std::span(mesh.triangles))), mesh.triangles.size(),
          mesh::float_coordinate(mesh), mesh::area_of(mesh)};
}

Digest MeshOutline::digest() const {
  return DigestBuilder().value(vertices).value(triangles).finish();
}

void MeshSource::read_ahead(std::span<const mesh::FileToRead> files, double max_bytes) {
  std::vector<std::optional<Result<ReadFile>>> found(files.size());
  std::atomic<bool> failed = false;
  ReadingSlots slots(max_bytes);
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    const ReadingSlots::Slot slot(slots, reading_bytes(files[i].path));
    if (failed) return;
    found[i] = read_file(files[i].path, files[i].options);
    if (!*found[i]) failed = true;
  });
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (found[i]) files_ahead_.emplace(files[i].path, std::move(*found[i]));
  }
}

Result<mesh::Assembly> MeshSource::read(const std::string& path, const mesh::ReadOptions& options) {
  auto ahead = files_ahead_.extract(path);
  Result<ReadFile> read = ahead ? std::move(ahead.mapped()) : read_file(path, options);
  if (!read) return read.error();
  files_.push_back(std::move(read->file));
  return std::move(read->assembly);
}

std::uint32_t MeshSource::add(mesh::Mesh mesh) {
  File file;
  file.outlines.push_back(outline_of(mesh));
  std::vector<mesh::Mesh> meshes;
  meshes.push_back(std::move(mesh));
  keep(std::move(meshes), file);
  files_.push_back(std::move(file));
  return static_cast<std::uint32_t>(files_.size() - 1);
}

Result<MeshSource::ReadFile> MeshSource::read_file(const std::string& path,
                                                   const mesh::ReadOptions& options) {
  File file{path, options, {}, {}, {}};
  file.options.progress = nullptr;  // whoever listens now may be gone when it is read again
  std::optional<Digest> key;
  if (cache_ != nullptr) key = assembly_key(path, options);
  if (key) {
    if (const auto entry = cache_->find(kAssemblyKind, *key)) {
      if (auto assembly = unpack(entry->bytes(), file.outlines)) {
        return ReadFile{std::move(*assembly), std::move(file)};
      }
    }
  }
  auto assembly = read_(path, options);
  if (!assembly) return assembly.error();
  file.outlines = outlines_of(*assembly);
  // Not kept where the file changed while it was read.
  if (key && key == assembly_key(path, options)) {
    cache_->keep(kAssemblyKind, *key, pack(*assembly, file.outlines));
  }
  keep(std::exchange(assembly->meshes, std::vector<mesh::Mesh>(file.outlines.size())), file);
  return ReadFile{std::move(*assembly), std::move(file)};
}

std::vector<MeshOutline> MeshSource::outlines(const mesh::Scene& scene) const {
  std::vector<MeshOutline> all;
  for (const mesh::MeshObject& part : scene.objects) all.push_back(outline(part));
  return all;
}

void MeshSource::keep(std::vector<mesh::Mesh> meshes, File& file) {
  const std::lock_guard lock(keeping_);
  for (const mesh::Mesh& mesh : meshes) {
    bytes_ += std::span(mesh.vertices).size_bytes() + std::span(mesh.triangles).size_bytes();
  }
  if (bytes_ <= max_bytes_) {
    file.meshes = std::move(meshes);
    return;
  }
  if (spill_ == nullptr) spill_ = std::make_unique<scan::SpillFile>();
  for (mesh::Mesh& mesh : meshes) {
    const auto vertices = spill_->array<mesh::Vec3d>(mesh.vertices.size());
    const auto triangles = spill_->array<mesh::Triangle>(mesh.triangles.size());
    std::copy(mesh.vertices.begin(), mesh.vertices.end(), vertices.begin());
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), triangles.begin());
    file.on_disk.push_back({vertices, triangles, mesh.single_precision});
    mesh = {};
  }
  spill_->let_go();  // each is wanted once more
}

Result<std::shared_ptr<const mesh::Mesh>> MeshSource::mesh(const mesh::MeshObject& part) {
  File& file = files_[part.assembly];
  if (file.meshes.empty() && file.on_disk.empty()) {
    auto assembly = read_(file.path, file.options);
    if (!assembly) return assembly.error();
    const std::vector<MeshOutline> outlines = outlines_of(*assembly);
    const bool same =
        std::equal(outlines.begin(), outlines.end(), file.outlines.begin(), file.outlines.end(),
                   [](const auto& a, const auto& b) { return a.digest() == b.digest(); });
    if (!same) {
      return Error{ErrorCode::kReadFailed, file.path, "", "has changed while it was being read",
                   "start again"};
    }
    keep(std::move(assembly->meshes), file);
  }
  if (file.on_disk.empty()) {
    return std::shared_ptr<const mesh::Mesh>(std::shared_ptr<void>(), &file.meshes[part.mesh]);
  }
  const MeshOnDisk& stored = file.on_disk[part.mesh];
  auto mesh = std::make_shared<mesh::Mesh>();
  mesh->vertices.assign(stored.vertices.begin(), stored.vertices.end());
  mesh->triangles.assign(stored.triangles.begin(), stored.triangles.end());
  mesh->single_precision = stored.single_precision;
  spill_->let_go();
  return std::shared_ptr<const mesh::Mesh>(std::move(mesh));
}

Result<mesh::MeshFacts> MeshSource::facts(const mesh::MeshObject& part, std::mutex& one_caller) {
  const Digest key = DigestBuilder()
                         .text(kFactsKind)
                         .value(kFactsCacheVersion)
                         .value(outline(part).digest())
                         .finish();
  if (cache_ != nullptr) {
    const auto entry = cache_->find(kFactsKind, key);
    if (entry && entry->bytes().size() == sizeof(FactsRecord)) {
      return facts_of(ByteUnpacker(entry->bytes()).value<FactsRecord>());
    }
  }
  const auto found = [&] {
    const std::lock_guard lock(one_caller);
    return mesh(part);
  }();
  if (!found) return found.error();
  const mesh::MeshFacts facts = mesh::mesh_facts(**found);
  if (cache_ != nullptr) {
    const FactsRecord record = record_of(facts);
    cache_->keep(kFactsKind, key, std::as_bytes(std::span(&record, 1)));
  }
  return facts;
}

Result<std::vector<mesh::MeshFacts>> MeshSource::facts(const mesh::Scene& scene) {
  using Key = std::pair<std::uint32_t, std::uint32_t>;  // assembly, mesh
  const auto key_of = [](const mesh::MeshObject& part) { return Key{part.assembly, part.mesh}; };
  std::map<Key, std::size_t> numbers;
  std::vector<const mesh::MeshObject*> first_parts;  // of each mesh
  for (const mesh::MeshObject& part : scene.objects) {
    if (numbers.emplace(key_of(part), first_parts.size()).second) first_parts.push_back(&part);
  }
  std::vector<std::optional<Result<mesh::MeshFacts>>> found(first_parts.size());
  std::mutex one_caller;
  tbb::parallel_for(std::size_t{0}, found.size(),
                    [&](std::size_t i) { found[i] = facts(*first_parts[i], one_caller); });
  std::vector<mesh::MeshFacts> all;
  for (const mesh::MeshObject& part : scene.objects) {
    const Result<mesh::MeshFacts>& facts = *found[numbers[key_of(part)]];
    if (!facts) return facts.error();
    all.push_back(*facts);
  }
  return all;
}

}  // namespace forcelayer::cache
