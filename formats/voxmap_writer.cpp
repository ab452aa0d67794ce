#include "formats/voxmap_writer.h"

#include <algorithm>

#include "formats/section_table.h"
#include "formats/voxmap.h"
#include "formats/voxmap_sections.h"

namespace forcelayer {
namespace {

// A tree whose bricks are packed, with the entries that lead to them.
struct PackedTree {
  PackedBricks bricks;
  std::vector<std::uint32_t> lower_nodes;

  PackedTree(const TreeContent& tree, PackedBricks packed)
      : bricks(std::move(packed)), lower_nodes(tree.lower_nodes.begin(), tree.lower_nodes.end()) {
    for (std::uint32_t& entry : lower_nodes) {
      if (is_uniform(entry)) continue;
      // The reader refuses a brick that is not there.
      entry = entry < bricks.units.size() ? bricks.units[entry] : kUniformBit - 1;
    }
  }

  TreeContent content(const TreeContent& tree) const {
    return {tree.directory, tree.upper_nodes, lower_nodes, words()};
  }
  std::span<const std::uint32_t> words() const {
    return {reinterpret_cast<const std::uint32_t*>(bricks.bytes.data()), bricks.bytes.size() / 4};
  }
};

template <typename Element>
std::span<const Element> elements_in(const TreeContent& tree) {
  return {reinterpret_cast<const Element*>(tree.bricks.data()),
          tree.bricks.size_bytes() / sizeof(Element)};
}

// The trees as they stand in the file. They outlive the layout, which points to them.
struct PackedTrees {
  PackedTree distances, objects;

  explicit PackedTrees(const VoxmapContent& content)
      : distances(content.distances, pack_distances(elements_in<std::uint8_t>(content.distances))),
        objects(content.objects, pack_objects(elements_in<std::uint16_t>(content.objects))) {}
};

FileLayout lay_out(const VoxmapContent& content, const PackedTrees& packed) {
  const auto names = std::as_bytes(std::span(content.object_names));
  std::vector<std::span<const std::byte>> bytes;
  const auto add_tree = [&](const TreeContent& tree) {
    for (const auto& part : {tree.directory, tree.upper_nodes, tree.lower_nodes, tree.bricks}) {
      bytes.push_back(std::as_bytes(part));
    }
  };
  add_tree(content.values);
  bytes.push_back({});  // no forces of points
  bytes.push_back(std::as_bytes(std::span(content.provenance)));
  add_tree(packed.distances.content(content.distances));
  add_tree(packed.objects.content(content.objects));
  bytes.push_back(names);
  bytes.push_back(std::as_bytes(content.compliance));

  const auto rules = voxmap_section_rules();
  std::vector<SectionContent> sections;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (!rules[i].required && bytes[i].empty()) continue;
    sections.push_back({rules[i].id, rules[i].element_bytes, bytes[i]});
  }
  return lay_out_file(std::as_bytes(std::span(&content.header, 1)), kVoxmapHeaderRule, sections);
}

}  // namespace

void add_object_name(std::string_view name, std::string& object_names) {
  while (!name.empty()) {
    const std::size_t bytes = utf8_bytes(name);
    if (bytes == 0 || name[0] == '\0') {
      object_names += "\xef\xbf\xbd";
    } else {
      object_names += name.substr(0, bytes);
    }
    name.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  object_names += '\0';
}

Result<std::uint64_t> write_voxmap(const std::filesystem::path& path,
                                   const VoxmapContent& content) {
  const auto check = [](std::span<const std::byte> bytes, std::string_view name) {
    const auto map = Voxmap::from_bytes(bytes, name);
    return map ? Status() : map.error();
  };
  const PackedTrees packed(content);
  constexpr std::uint64_t kMaxBytes = std::uint64_t{kUniformBit} * kPackedUnitBytes;
  for (const PackedTree* tree : {&packed.distances, &packed.objects}) {
    if (tree->bricks.bytes.size() <= kMaxBytes) continue;
    return Error{ErrorCode::kBakeTooLarge, path.string(), "", "the bricks take more than 32 GB",
                 "use a larger voxel size, or bake a smaller region (--roi)"};
  }
  return write_layout(path, lay_out(content, packed), check);
}

std::vector<std::byte> voxmap_bytes(const VoxmapContent& content) {
  const PackedTrees packed(content);
  return bytes_of(lay_out(content, packed));
}

}  // namespace forcelayer
