// Positions are rounded as a file rounds them, whatever the compiler makes of it.
#include "pointshell/sample/stored_position.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "tests/support/random_numbers.h"

namespace forcelayer::test {
namespace {

// The coordinates as they are read back from the bytes of a file.
std::array<double, 3> from_file(const std::array<double, 3>& coordinates) {
  std::array<std::byte, 3 * sizeof(float)> bytes{};
  for (std::size_t n = 0; n < 3; ++n) {
    const auto value = static_cast<float>(coordinates[n]);
    std::memcpy(&bytes[n * sizeof value], &value, sizeof value);
  }
  std::array<double, 3> back{};
  for (std::size_t n = 0; n < 3; ++n) {
    float value = 0;
    std::memcpy(&value, &bytes[n * sizeof value], sizeof value);
    back[n] = double{value};
  }
  return back;
}

TEST(StoredPosition, IsThatOfTheFile) {
  Random random(7);
  for (int trial = 0; trial < 1000; ++trial) {
    const std::array<double, 3> p{uniform(random, -1, 1), uniform(random, -1, 1),
                                  uniform(random, -1, 1)};
    const part::Vec3 stored = sample::as_stored({p[0], p[1], p[2]});
    const std::array<double, 3> expected = from_file(p);
    ASSERT_EQ(stored.x, expected[0]) << "trial " << trial;
    ASSERT_EQ(stored.y, expected[1]) << "trial " << trial;
    ASSERT_EQ(stored.z, expected[2]) << "trial " << trial;
  }
}

}  // namespace
}  // namespace forcelayer::test
