#define XXH_INLINE_ALL
#include <xxhash.h>

#include "formats/section_table.h"

namespace forcelayer {

std::uint64_t checksum(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace forcelayer
