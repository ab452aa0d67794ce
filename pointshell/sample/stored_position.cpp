#include "pointshell/sample/stored_position.h"

namespace forcelayer::sample {
namespace {

// gcc 12 at -O2 drops the rounding where neighboring doubles go to floats and back
// (-ftree-slp-vectorize). A volatile float is stored, and so it is rounded.
double rounded(double coordinate) {
  volatile float stored = static_cast<float>(coordinate);
  return double{stored};
}

}  // namespace

part::Vec3 as_stored(const part::Vec3& position) {
  return {rounded(position.x), rounded(position.y), rounded(position.z)};
}

}  // namespace forcelayer::sample
