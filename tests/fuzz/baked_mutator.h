// The mutator of the targets that read baked files: libFuzzer calls it instead of its own.
#pragma once

#include "tests/fuzz/fuzz_target.h"
#include "tests/support/file_surgery.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size)
    __attribute__((weak));

// After the mutation the size field and all checksums are made right again three times out of four,
// so that what lies behind them is reached too.
extern "C" inline std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                                      std::size_t max_size, unsigned seed)
    __attribute__((used));

std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                    unsigned seed) {
  using namespace forcelayer;
  size = LLVMFuzzerMutate(data, size, max_size);
  if (seed % 4 == 0 || size < sizeof(FileHeader)) return size;
  const std::span<std::byte> bytes = std::as_writable_bytes(std::span(data, size));
  testing::write_at(bytes, offsetof(FileHeader, file_bytes), std::uint64_t{size});
  testing::resign(bytes);
  return size;
}
