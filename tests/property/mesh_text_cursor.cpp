// Numbers as text: the fast way gives what std::from_chars gives, bit for bit.
#include "formats/mesh/readers/text_cursor.h"

#include <gtest/gtest.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <random>

namespace forcelayer {
namespace {

void expect_as_from_chars(const std::string& text) {
  double expected = 0, parsed = 0;
  const char* const end = text.data() + text.size();
  const auto [after, failure] = std::from_chars(text.data(), end, expected);
  const char* const place = mesh::parse_number(text.data(), end, parsed);
  if (failure == std::errc::result_out_of_range) return;  // from_chars does not say which way
  if (failure != std::errc{}) {
    EXPECT_EQ(place, nullptr) << text;
    return;
  }
  ASSERT_NE(place, nullptr) << text;
  EXPECT_EQ(place - text.data(), after - text.data()) << text;
  EXPECT_EQ(std::bit_cast<std::uint64_t>(parsed), std::bit_cast<std::uint64_t>(expected)) << text;
}

TEST(ParseNumber, EqualsFromCharsOnRandomNumbers) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200'000; ++i) {
    const double value = std::bit_cast<double>(random());
    char text[64];
    const char* const formats[] = {"%.17g", "%.6f", "%g", "%.9e", "%.3f", "%.15g"};
    const double scaled = i % 2 == 0 ? value : std::ldexp(static_cast<double>(random()), -60);
    std::snprintf(text, sizeof text, formats[random() % 6], scaled);
    if (std::string_view(text).size() < 60) expect_as_from_chars(text);
  }
}

TEST(ParseNumber, EqualsFromCharsOnRandomCharacters) {
  constexpr std::string_view kCharacters = "0123456789019.-eE 5";
  std::mt19937_64 random(2);
  for (int i = 0; i < 200'000; ++i) {
    std::string text;
    for (std::size_t length = random() % 24; length > 0; --length) {
      text += kCharacters[random() % kCharacters.size()];
    }
    expect_as_from_chars(text);
  }
}

// Numbers of hundreds of digits, beside an exponent that brings them back or beyond: as strtod
// tells.
TEST(ParseNumber, TellsTooSmallFromTooLarge) {
  std::mt19937_64 random(3);
  int small = 0, large = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto up_to = [&](std::uint64_t largest) { return random() % (largest + 1); };
    std::string text = i % 2 == 0 ? "-" : "";
    text.append(up_to(random() % 2 * 400), '0').append(up_to(random() % 2 * 400), '7');
    if (random() % 2 == 0) text.append(".").append(up_to(random() % 2 * 400), '0');
    text += std::to_string(1 + up_to(98));
    if (random() % 4 != 0) {
      text += (random() % 2 == 0 ? "e-" : "E") + std::to_string(up_to(random() % 2 == 0 ? 9 : 800));
    }
    const double expected = std::strtod(text.c_str(), nullptr);
    double parsed = 1;
    const char* const after = mesh::parse_number(text.data(), text.data() + text.size(), parsed);
    if (std::isinf(expected)) {
      ASSERT_EQ(after, nullptr) << text;
      ++large;
    } else {
      ASSERT_EQ(after, text.data() + text.size()) << text;
      ASSERT_EQ(parsed, expected) << text;
      small += expected == 0;
    }
  }
  EXPECT_GT(small, 1000);
  EXPECT_GT(large, 1000);
}

TEST(ParseNumber, TakesWhatMeshFilesHold) {
  const auto parse = [](const std::string& text) {
    double number = -1;
    const char* const after = mesh::parse_number(text.data(), text.data() + text.size(), number);
    return after == text.data() + text.size() ? number : std::nan("");
  };
  EXPECT_EQ(parse("+1.5"), 1.5);
  EXPECT_EQ(parse("1."), 1.0);
  EXPECT_EQ(parse(".5"), 0.5);
  EXPECT_EQ(parse("-0"), 0.0);
  EXPECT_TRUE(std::signbit(parse("-0")));
  EXPECT_EQ(parse("1E3"), 1000.0);
  EXPECT_EQ(parse("1e-400"), 0.0);
  EXPECT_EQ(parse("0." + std::string(400, '0') + "1"), 0.0);
  EXPECT_EQ(parse("inf"), INFINITY);
  for (const char* bad : {"", "-", "+", ".", "e5", "1e", "1e+", "1e999", "--1", "+-1", "0x10"}) {
    EXPECT_TRUE(std::isnan(parse(bad))) << bad;
  }
  double number = 0;
  const std::string infinite = "1e999";
  EXPECT_EQ(mesh::parse_number(infinite.data(), infinite.data() + infinite.size(), number),
            nullptr);
}

}  // namespace
}  // namespace forcelayer
