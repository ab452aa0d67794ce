#include "formats/pshell_writer.h"

#include <array>
#include <vector>

#include "formats/pshell.h"
#include "formats/pshell_sections.h"
#include "formats/section_table.h"

namespace forcelayer {
namespace {

// `values` with its last element, or zero for weights, repeated up to a whole number of blocks.
std::vector<float> padded(std::span<const float> values, const PshellHeader& header,
                          bool is_weight) {
  std::vector<float> result(values.begin(), values.end());
  const float filler = is_weight || values.empty() ? 0.0f : values.back();
  result.resize(header.block_count * header.block_points, filler);
  return result;
}

// The sections' own storage must outlive the layout that points into it.
struct PaddedLayout {
  std::array<std::vector<float>, 8> columns;  // x y z nx ny nz weight cone
  std::vector<std::uint8_t> two_sided;
  FileLayout layout;
};

PaddedLayout lay_out(const PshellContent& content) {
  PaddedLayout result;
  const std::span<const float> columns[] = {content.x,  content.y,  content.z,        content.nx,
                                            content.ny, content.nz, content.weight_m2};
  for (std::size_t i = 0; i < std::size(columns); ++i) {
    result.columns[i] = padded(columns[i], content.header, i == 6);
  }
  if (!content.cone_cos.empty()) {
    result.columns[7] = padded(content.cone_cos, content.header, false);
  }
  std::vector<std::span<const std::byte>> bytes;
  for (std::size_t i = 0; i < 7; ++i) bytes.push_back(std::as_bytes(std::span(result.columns[i])));
  bytes.push_back(std::as_bytes(content.blocks));
  bytes.push_back(std::as_bytes(content.super_blocks));
  bytes.push_back(std::as_bytes(std::span(result.columns[7])));
  bytes.push_back(std::as_bytes(content.losses));
  bytes.push_back(std::as_bytes(std::span(content.provenance)));
  result.two_sided.assign(content.two_sided.begin(), content.two_sided.end());
  if (!content.two_sided.empty()) {
    result.two_sided.resize(content.header.block_count * content.header.block_points,
                            content.two_sided.back());
  }
  bytes.push_back(std::as_bytes(std::span(result.two_sided)));

  const auto rules = pshell_section_rules();
  std::vector<SectionContent> sections;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (!rules[i].required && bytes[i].empty()) continue;
    sections.push_back({rules[i].id, rules[i].element_bytes, bytes[i], rules[i].minor});
  }
  result.layout =
      lay_out_file(std::as_bytes(std::span(&content.header, 1)), kPshellHeaderRule, sections);
  return result;
}

}  // namespace

Result<std::uint64_t> write_pshell(const std::filesystem::path& path,
                                   const PshellContent& content) {
  const auto check = [](std::span<const std::byte> bytes, std::string_view name) {
    const auto shell = Pshell::from_bytes(bytes, name);
    return shell ? Status() : shell.error();
  };
  return write_layout(path, lay_out(content).layout, check);
}

std::vector<std::byte> pshell_bytes(const PshellContent& content) {
  return bytes_of(lay_out(content).layout);
}

}  // namespace forcelayer
