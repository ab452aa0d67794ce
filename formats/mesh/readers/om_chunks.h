// The chunks of an OpenMesh file (.om), walked over without the library.
#pragma once

#include <string>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

struct OmContent {
  std::uint32_t vertices = 0;  // as the header announces
  std::uint32_t faces = 0;
  std::uint32_t edges = 0;
  bool single_precision = true;
  // The file with its chunks of positions and topology alone, each of them whole. A mesh needs no
  // more, and nothing in it makes the library's reader run beyond the data.
  std::string stripped;
};

// Throws ReadFailure where a chunk is cut short, unknown, missing or there twice.
OmContent read_om_chunks(const SourceFile& file);

}  // namespace forcelayer::mesh
