// A scene manifest.
#include "formats/mesh/scene_manifest.h"

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const fuzz::MemoryFile file(fuzz::bytes_of(data, size));
  const auto manifest = mesh::read_manifest(file.path());
  fuzz::require(manifest || !manifest.error().what.empty(), "an error says what is wrong");
  return 0;
}
