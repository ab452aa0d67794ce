// Quantities as they are typed: values, errors, and the same reading in every locale.
#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <locale>

#include "formats/command/quantity.h"

namespace forcelayer {
namespace {

template <typename T>
void expect_usage_error(const Result<T>& result, const std::string& text) {
  ASSERT_FALSE(result) << text;
  EXPECT_EQ(result.error().code, ErrorCode::kUsage);
  EXPECT_FALSE(result.error().what.empty());
  EXPECT_FALSE(result.error().mend.empty()) << text;
}

TEST(Quantity, BareNumbersWithinBounds) {
  const command::Bounds bounds{0.001, 10};
  for (const auto& [text, number] :
       {std::pair{"0.001", 0.001}, {"10", 10.0}, {" +5 ", 5.0}, {"1e-2", 0.01}}) {
    const auto parsed = command::parse_number(text, bounds);
    ASSERT_TRUE(parsed) << text;
    EXPECT_EQ(*parsed, number);
  }
  for (const char* text : {"nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e400", "", "x", "5mm",
                           "5 5", "10.001", "0.0009", "-1", "0x5"}) {
    expect_usage_error(command::parse_number(text, bounds), text);
  }
  EXPECT_EQ(command::parse_number("nan", bounds).error().what, "'nan' is not a finite number");
  EXPECT_EQ(command::parse_number("11", bounds).error().what, "'11' is outside the allowed range");
}

TEST(Quantity, NoDurationIsBeyondItsBound) {
  EXPECT_EQ(*command::parse_duration("10000h"), command::kLongestS);
  for (const char* text : {"10001h", "1e300s", "nans", "infs", "nan s", "1e400s"}) {
    expect_usage_error(command::parse_duration(text), text);
  }
}

TEST(Quantity, NoLengthIsBeyondItsBound) {
  EXPECT_EQ(*command::parse_length("-1e6km"), -command::kFarthestM);
  for (const char* text : {"1.1e6km", "-1e10m", "1e300m", "1e40mm"}) {
    expect_usage_error(command::parse_length(text), text);
  }
  expect_usage_error(command::parse_point("0,0,1e10m"), "a point");
  expect_usage_error(command::parse_box("0,0,0,1m,1m,1e10m"), "a box");
  expect_usage_error(command::parse_pose("1e300m,0,0"), "a pose");
}

TEST(Quantity, Lengths) {
  const struct {
    const char* text;
    double meters;
  } cases[] = {{"5mm", 0.005},    {"0.2in", 0.2 * 0.0254}, {"0.005m", 0.005},    {"0", 0},
               {"-3cm", -0.03},   {"+2um", 2e-6},          {"1e3mm", 1.0},       {"1.5e-3km", 1.5},
               {"  7 dm  ", 0.7}, {"250nm", 250e-9},       {"1ft", 0.3048},      {"2yd", 1.8288},
               {".5mm", 0.0005},  {"5.mm", 0.005},         {"1E+2mm", 0.1},      {"0mm", 0},
               {"-0", 0},         {"0e-2147483648nm", 0},  {"0e2147483647km", 0}};
  for (const auto& [text, meters] : cases) {
    const auto length = command::parse_length(text);
    ASSERT_TRUE(length) << text;
    EXPECT_EQ(*length, meters) << text;
  }
}

// Two spellings of one length must bake the same file.
TEST(Quantity, MetricSpellingsAreTheSameDouble) {
  for (int tenths = 1; tenths < 2000; ++tenths) {
    const std::string number = std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
    const double meters = *command::parse_length(number + "e-3m");
    EXPECT_EQ(*command::parse_length(number + "mm"), meters) << number;
    EXPECT_EQ(*command::parse_length(number + "e3um"), meters) << number;
    EXPECT_EQ(*command::parse_length(number + "e-1cm"), meters) << number;
    EXPECT_EQ(meters, std::strtod((number + "e-3").c_str(), nullptr)) << number;
  }
}

TEST(Quantity, SpellingsOfUnits) {
  for (const char* text : {"5MM", "5mm", "5 MM"}) EXPECT_EQ(*command::parse_length(text), 0.005);
  for (const char* text : {"5\"", "5in", "5IN", "5inch", "5 inch"}) {
    EXPECT_EQ(*command::parse_length(text), 5 * 0.0254) << text;
  }
  for (const char* text : {"5um", "5\xC2\xB5m", "5\xCE\xBCm"}) {  // U+00B5, U+03BC
    EXPECT_EQ(*command::parse_length(text), 5e-6) << text;
  }
  for (const char* text : {"0e2147483647km", "-0e-2147483648nm", "0e9999999999mm"}) {
    EXPECT_EQ(*command::parse_length(text), 0) << text;
  }
  EXPECT_EQ(*command::parse_unit("MM"), 0.001);
  EXPECT_EQ(*command::parse_unit("inch"), 0.0254);
  EXPECT_EQ(*command::parse_unit("\xC2\xB5m"), 1e-6);
}

TEST(Quantity, WrongLengths) {
  for (const char* text :
       {"",      " ",     "5",     "mm",      "5 m m",   "5Mm",    "5furlong", "nan",
        "inf",   "infmm", "nanmm", "1e999mm", "1e308km", "0x10mm", "5,5mm",    "--5mm",
        "+-5mm", "5mm3",  "5mm,",  "1e-400m", "five mm", "\x01mm"}) {
    expect_usage_error(command::parse_length(text), text);
  }
}

TEST(Quantity, Units) {
  EXPECT_EQ(*command::parse_unit("mm"), 0.001);
  EXPECT_EQ(*command::parse_unit("m"), 1);
  EXPECT_EQ(*command::parse_unit("in"), 0.0254);
  for (const char* text : {"", "Mm", "meter", "mm ", "s"})
    expect_usage_error(command::parse_unit(text), text);
}

TEST(Quantity, Points) {
  EXPECT_EQ(*command::parse_point("1m,0,-3m"), (std::array<double, 3>{1, 0, -3}));
  EXPECT_EQ(*command::parse_point(" 1mm , 2m , 3cm "), (std::array<double, 3>{0.001, 2, 0.03}));
  EXPECT_EQ(*command::parse_point("-1,2e1, 3 mm"), (std::array<double, 3>{-0.001, 0.02, 0.003}));
  EXPECT_EQ(command::parse_point("1m,5,0").error().what, "length '5' has no unit");
  EXPECT_EQ(command::parse_point("1m,5,2mm").error().what, "length '5' has no unit");
  EXPECT_EQ(command::parse_point("5,1m,2").error().what, "length '5' has no unit");
  for (const char* text : {"", "1m,2m", "1m,2m,3m,4m", "1m,2m,", ",,", "1m,2m,x", "1m;2m;3m",
                           "1m 2m 3m", "1m,2m,inf", "1m,2m,3kg", "1m,2m,3"}) {
    expect_usage_error(command::parse_point(text), text);
  }
}

TEST(Quantity, Directions) {
  EXPECT_EQ(*command::parse_direction("1,-2,0.5"), (std::array<double, 3>{1, -2, 0.5}));
  for (const char* text : {"", "1,2", "1m,2,3", "1,2,x"}) {
    expect_usage_error(command::parse_direction(text), text);
  }
}

TEST(Quantity, Boxes) {
  EXPECT_EQ(*command::parse_box("0,0,0,1mm,2m,3m"), (std::array<double, 6>{0, 0, 0, 0.001, 2, 3}));
  for (const char* text :
       {"0,0,0,1m,1m", "0,0,0,1m,1m,0", "1m,0,0,0,1m,1m", "0,0,0,0,0,0", "0,0,0,1m,1m,1"}) {
    expect_usage_error(command::parse_box(text), text);
  }
  EXPECT_EQ(*command::parse_box("1,0,0,4,5,6mm"),
            (std::array<double, 6>{0.001, 0, 0, 0.004, 0.005, 0.006}));
  EXPECT_EQ(command::parse_box("0,0,0,5,1m,1m").error().what, "length '5' has no unit");
}

TEST(Quantity, Poses) {
  const auto position_only = command::parse_pose("1m,2mm,3m");
  ASSERT_TRUE(position_only);
  EXPECT_EQ(position_only->position_m, (std::array<double, 3>{1, 0.002, 3}));
  EXPECT_EQ(position_only->orientation_wxyz, (std::array<double, 4>{1, 0, 0, 0}));
  const auto one_unit = command::parse_pose("1,2,3mm,1,0,0,0");
  ASSERT_TRUE(one_unit);
  EXPECT_EQ(one_unit->position_m, (std::array<double, 3>{0.001, 0.002, 0.003}));
  const auto pose = command::parse_pose("0,0,0,0,0,3,4");
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->orientation_wxyz, (std::array<double, 4>{0, 0, 0.6, 0.8}));
  for (const char* text : {"", "0,0,0,1", "0,0,0,0,0,0,0", "0,0,0,1mm,0,0,0", "0,0,0,1,0,0,nan",
                           "0,0,0,1e200,0,0,0", "0,0,5", "5,0,0,1,0,0,0", "0,0,0,1,0,0,0,0"}) {
    expect_usage_error(command::parse_pose(text), text);
  }
}

TEST(Quantity, Durations) {
  EXPECT_EQ(*command::parse_duration("10s"), 10);
  EXPECT_EQ(*command::parse_duration("500ms"), 0.5);
  EXPECT_EQ(*command::parse_duration("2min"), 120);
  EXPECT_EQ(*command::parse_duration("0.5h"), 1800);
  EXPECT_EQ(*command::parse_duration("0s"), 0);
  for (const char* text : {"", "10", "0", "10m", "-1s", "infs", "1e308h"}) {
    expect_usage_error(command::parse_duration(text), text);
  }
}

TEST(Quantity, Pressures) {
  EXPECT_EQ(*command::parse_pressure_pa("4Pa"), 4);
  EXPECT_EQ(*command::parse_pressure_pa("1.1kPa"), 1100);
  EXPECT_EQ(*command::parse_pressure_pa(" 0.1 MPa"), 100'000);
  for (const char* text : {"", "4", "0", "4psi", "4N", "nanPa", "1e308kPa"}) {
    expect_usage_error(command::parse_pressure_pa(text), text);
  }
  EXPECT_NE(command::parse_pressure_pa("4N").error().what.find("is a force"), std::string::npos);
}

// A decimal comma in the user's locale changes nothing.
class DecimalComma : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(Quantity, DoesNotDependOnTheLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
  const std::string c_before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_ALL, name)) break;  // where one is installed
  }
  EXPECT_EQ(*command::parse_length("1.5mm"), 0.0015);
  EXPECT_EQ(*command::parse_direction("1.5,2.5,3.5"), (std::array<double, 3>{1.5, 2.5, 3.5}));
  expect_usage_error(command::parse_length("1,5mm"), "1,5mm");
  std::setlocale(LC_ALL, c_before.c_str());
  std::locale::global(before);
}

}  // namespace
}  // namespace forcelayer
