// A recording of voxrun.
#include "runtime/stream/recording.h"

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const fuzz::MemoryFile file(fuzz::bytes_of(data, size));
  const auto recording = stream::Recording::open(file.path());
  if (!recording) {
    fuzz::require(!recording.error().what.empty(), "an error says what is wrong");
    return 0;
  }
  std::uint64_t sum = 0;  // every byte that it promises can be read
  for (const std::byte byte : std::as_bytes(recording->frames())) sum += std::to_integer<int>(byte);
  return sum == 1 ? -1 : 0;
}
