// baked_verdicts: for each path on standard input a line, `ok DIGEST` or `no REASON`: this
// project's readers, for tests/fuzz/differential.py. The digest is that of
// tests/golden/check_baked_file.py.
#include <bit>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <string>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "formats/voxmap_walk.h"

namespace forcelayer {
namespace {

class Digest {
 public:
  void add(std::uint64_t number) { state_ = (state_ ^ number) * 0x100000001b3u; }
  void words(std::span<const std::byte> bytes) {
    for (std::size_t at = 0; at + 4 <= bytes.size(); at += 4) {
      std::uint32_t word;
      std::memcpy(&word, bytes.data() + at, 4);
      add(word);
    }
  }
  std::uint64_t state() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

template <std::uint32_t kBits>
void add_tree(Digest& digest, const TreeView<kBits>& view) {
  for_each_region(view, [&](const VoxmapRegion& region) {
    if (region.is_brick) {
      for (const std::uint32_t element : view.brick_codes(region.entry)) digest.add(element);
      return;
    }
    for (const std::int64_t at : region.low) digest.add(static_cast<std::uint64_t>(at));
    digest.add(region.edge_voxels);
    digest.add(kBits == kValueBits ? region.entry & ~kUniformBit
                                   : uniform_wide_value(region.entry));
  });
}

std::uint64_t digest_of(const Voxmap& map) {
  Digest digest;
  add_tree(digest, map.view());
  if (map.distances() != nullptr) add_tree(digest, *map.distances());
  if (map.objects() != nullptr) add_tree(digest, *map.objects());
  for (std::uint32_t object = 1; object <= map.header().object_count; ++object) {
    for (const char c : map.object_name(object)) digest.add(static_cast<unsigned char>(c));
    digest.add(0);
  }
  digest.words(std::as_bytes(map.compliance()));
  return digest.state();
}

std::uint64_t digest_of(const Pshell& shell) {
  Digest digest;
  const PshellView& v = shell.view();
  const std::size_t stored = v.block_count * v.block_points;
  for (const float* column : {v.x, v.y, v.z, v.nx, v.ny, v.nz, v.weight_m2}) {
    digest.words(std::as_bytes(std::span(column, stored)));
  }
  digest.words(std::as_bytes(std::span(v.blocks, v.block_count)));
  digest.words(std::as_bytes(std::span(v.super_blocks, v.super_block_count)));
  if (v.cone_cos != nullptr) digest.words(std::as_bytes(std::span(v.cone_cos, stored)));
  digest.words(std::as_bytes(shell.surface_distance_terms().losses));
  return digest.state();
}

template <class Baked>
void judge(const std::string& path) {
  const auto opened = Baked::open(path, Verify::kStructureAndChecksums);
  if (opened) {
    std::printf("ok %016llx\n", static_cast<unsigned long long>(digest_of(*opened)));
  } else {
    const Error& error = opened.error();
    std::printf("no %s: %s\n", escaped(error.where).c_str(), escaped(error.what).c_str());
  }
}

}  // namespace
}  // namespace forcelayer

int main() {
  for (std::string path; std::getline(std::cin, path);) {
    if (path.ends_with(".vox")) {
      forcelayer::judge<forcelayer::Voxmap>(path);
    } else {
      forcelayer::judge<forcelayer::Pshell>(path);
    }
    std::fflush(stdout);
  }
}
