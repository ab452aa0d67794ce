// Four floats in a vector that gcc and clang know on every processor.
#pragma once

#include <cstdint>
#include <cstring>

namespace forcelayer::query {

using Four [[gnu::vector_size(16)]] = float;
using FourBits [[gnu::vector_size(16)]] = std::int32_t;

inline Four load_four(const float* from) {
  Four v;
  std::memcpy(&v, from, sizeof v);
  return v;
}

// The dot product of the first three.
inline float dot3(Four a, Four b) {
  const Four product = a * b;
  return product[0] + product[1] + product[2];
}

}  // namespace forcelayer::query
