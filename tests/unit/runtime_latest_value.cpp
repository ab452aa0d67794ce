// The newest value between two threads, and between two processes of which one may be broken.
#include "runtime/machine/latest_value.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <thread>

namespace forcelayer::test {
namespace {

TEST(LatestValue, GivesTheNewestOnce) {
  machine::LatestValue<int> value;
  int got = -1;
  EXPECT_FALSE(value.take(got));
  value.put(1);
  value.put(2);
  EXPECT_TRUE(value.take(got));
  EXPECT_EQ(got, 2);
  EXPECT_FALSE(value.take(got));
  EXPECT_EQ(got, 2);
  value.put(3);
  EXPECT_TRUE(value.take(got));
  EXPECT_EQ(got, 3);
}

TEST(LatestValue, NoValueIsTornOrOld) {
  struct Pair {
    std::uint64_t a = 0, b = 0;
  };
  machine::LatestValue<Pair> value;
  constexpr std::uint64_t kLast = 200'000;
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) value.put({i, ~i});
  });
  Pair got{0, ~std::uint64_t{0}};
  while (got.a < kLast) {
    const std::uint64_t before = got.a;
    if (!value.take(got)) continue;
    ASSERT_EQ(got.b, ~got.a);
    ASSERT_GT(got.a, before);
  }
  producer.join();
}

// Whatever stands in the shared word: the consumer reads a slot or nothing, and knows that no
// producer wrote it. The producer, too, writes a slot.
TEST(LatestValue, NothingThatIsSharedLeadsOutOfTheSlots) {
  int refused = 0;
  for (std::uint64_t n = 0; n < 1024; ++n) {
    const auto word = static_cast<std::uint32_t>(n < 512 ? n : (n << 23) | (n & 7));
    struct {
      std::uint64_t before = 0;
      machine::SharedValue<std::uint64_t> shared;
      std::uint64_t after = 0;
    } memory;
    memory.shared.slots.fill(7);
    memory.shared.between = word;
    machine::ValueConsumer<std::uint64_t> consumer;
    std::uint64_t got = 7;
    const bool taken = consumer.take(memory.shared, got);
    EXPECT_EQ(got, 7u) << word;
    // The slots that a producer can hand over: those that the consumer does not hold.
    const bool sound = word == (0u | 4u) || word == (2u | 4u);
    EXPECT_EQ(taken, sound) << word;
    EXPECT_EQ(consumer.broken(), !sound && (word & 4u) != 0) << word;
    refused += consumer.broken() ? 1 : 0;
    memory.shared.between = word;
    machine::ValueProducer<std::uint64_t> producer;
    producer.put(memory.shared, 9);
    producer.put(memory.shared, 9);
    EXPECT_EQ(memory.before + memory.after, 0u) << word;
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace forcelayer::test
