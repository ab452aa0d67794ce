#include "formats/voxmap_writer.h"

#include <algorithm>

#include "formats/section_table.h"
#include "formats/voxmap.h"
#include "formats/voxmap_sections.h"

namespace forcelayer {
namespace {

FileLayout lay_out(const VoxmapContent& content) {
  const auto names = std::as_bytes(std::span(content.object_names));
  std::vector<std::span<const std::byte>> bytes;
  const auto add_tree = [&](const TreeContent& tree) {
    for (const auto& part : {tree.directory, tree.upper_nodes, tree.lower_nodes, tree.bricks}) {
      bytes.push_back(std::as_bytes(part));
    }
  };
  add_tree(content.values);
  bytes.push_back(std::as_bytes(content.compliance));
  bytes.push_back(std::as_bytes(std::span(content.provenance)));
  add_tree(content.distances);
  add_tree(content.objects);
  bytes.push_back(names);

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
  const auto check = [](MappedFile file, std::string_view name) {
    const auto map = Voxmap::from_file(std::move(file), name);
    return map ? Status() : map.error();
  };
  return write_layout(path, lay_out(content), check);
}

std::vector<std::byte> voxmap_bytes(const VoxmapContent& content) {
  return bytes_of(lay_out(content));
}

}  // namespace forcelayer
