// Paths as files: which headers are read, and other paths made of one.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "formats/path/path_edit.h"
#include "formats/path/path_file.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

Result<std::vector<PathRow>> read_text(const std::string& text, PathOf of = PathOf::kPart) {
  const ScratchFolder folder;
  std::ofstream(folder / "path.csv") << text;
  return read_path(folder / "path.csv", of);
}

// The row after the header and before the end.
PathRow only_row(const std::string& text, PathOf of = PathOf::kPart) {
  const auto rows = read_text(text, of);
  if (!rows) throw std::runtime_error(to_line(rows.error()));
  return rows->at(0);
}

TEST(Path, HeadersNameUnits) {
  const struct {
    const char* text;
    PathRow row;
  } cases[] = {
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n1,2,3,4,0,0,0,2\n", {1, {2, 3, 4}, {0, 0, 0, 1}}},
      {"t_ms,x_mm,y_mm,z_mm\n1000,2000,3000,4000\n", {1, {2, 3, 4}, {1, 0, 0, 0}}},
      {"time_min,x_in,y_ft,z_cm\n1,100,10,400\n", {60, {2.54, 3.048, 4}, {1, 0, 0, 0}}},
      {"z_um;y_m;x_m;t_s\n4000000;3,0;2,00;1\n", {1, {2, 3, 4}, {1, 0, 0, 0}}},
      {"\xef\xbb\xbf# from CAD\r\n\r\nT_S, X_M ,Y_M,\"Z_M\"\r\n# a comment\r\n 1, 2,+3,4e0\r\n",
       {1, {2, 3, 4}, {1, 0, 0, 0}}},
      {"t_s\tx_m\ty_m\tz_m\tnote\n1\t2\t3\t4\tanything\n", {1, {2, 3, 4}, {1, 0, 0, 0}}},
      {"t_s,x_m,y_m,z_m,rx_deg,ry_deg,rz_deg\n1,2,3,4,0,0,180\n", {1, {2, 3, 4}, {0, 0, 0, 1}}},
      {"t_s,x_m,y_m,z_m,rx_rad,ry_deg,rz_deg\n1,2,3,4,1.5707963267948966,0,90\n",
       {1, {2, 3, 4}, {0.5, 0.5, 0.5, 0.5}}},
      {"t_s,part_x_m,part_y_m,part_z_m,part_qw,part_qx,part_qy,part_qz,"
       "handle_x_m,handle_y_m,handle_z_m,handle_qw,handle_qx,handle_qy,handle_qz,name\n"
       "1,2,3,4,1,0,0,0,5,6,7,1,0,0,0,\"a,\"\"b\"\"\"\n",
       {1, {2, 3, 4}, {1, 0, 0, 0}}},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.text);
    const PathRow row = only_row(c.text);
    EXPECT_NEAR(row.time_s, c.row.time_s, 1e-12);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(row.position_m[i], c.row.position_m[i], 1e-12);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_NEAR(row.orientation_wxyz[i], c.row.orientation_wxyz[i], 1e-12);
    }
  }
  EXPECT_EQ(only_row(cases[8].text, PathOf::kHandle).position_m[0], 5);
}

TEST(Path, WhatIsNoneSaysWhy) {
  const struct {
    const char *text, *where, *what;
  } cases[] = {
      {"t_s,x,y,z\n0,0,0,0\n", "line 1", "x_mm"},
      {"x_m,y_m,z_m\n0,0,0\n", "line 1", "t_s"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy\n0,0,0,0,1,0,0\n", "line 1", "qz"},
      {"t_s,x_m,y_m,z_m,rx_deg,rz_deg\n0,0,0,0,1,0\n", "line 1", "ry_deg"},
      {"# nothing\n", "line 2", "header"},
      {"t_s,x_m,y_m,z_m\n0,0,0\n", "line 2", "4 cells"},
      {"t_s;x_m;y_m;z_m\n0;0;1,2,3;0\n", "line 2", "numbers"},
      {"t_s,x_m,y_m,z_m\n0,0,0,0\n# c\n0,1,1,1\n", "line 4", "later"},
      {"t_s,x_m,y_m,z_m\n0,1e400,0,0\n", "line 2", "finite"},
      {"t_s,x_mm,y_m,z_m\n0,1e12,0,0\n1,-1.001e12,0,0\n", "line 3", "1e9 m"},
      {"t_s,x_m,y_m,z_m\n0,0,0,1e308\n", "line 2", "1e9 m"},
      {"t_min,x_m,y_m,z_m\n-1e12,0,0,0\n", "line 2", "1e12 s"},
  };
  for (const auto& c : cases) {
    const auto rows = read_text(c.text);
    ASSERT_FALSE(rows) << c.text;
    EXPECT_EQ(rows.error().code, ErrorCode::kUsage) << c.text;
    EXPECT_EQ(rows.error().where, c.where) << c.text;
    EXPECT_NE(rows.error().what.find(c.what), std::string::npos) << rows.error().what;
  }
}

TEST(Path, WhatIsWrittenIsReadBack) {
  const ScratchFolder folder;
  const std::vector<PathRow> rows = {{-0.1, {1e-9, 2.0 / 3, -7}, {0.5, -0.5, 0.5, -0.5}},
                                     {1.0 / 3, {1, 2, 3}, {1, 0, 0, 0}}};
  auto writer = PathWriter::create(folder / "path.csv");
  ASSERT_TRUE(writer);
  for (const PathRow& row : rows) ASSERT_TRUE(writer->add(row));
  ASSERT_TRUE(writer->finish());
  const auto back = read_path(folder / "path.csv", PathOf::kPart);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ((*back)[i].time_s, rows[i].time_s);
    EXPECT_EQ((*back)[i].position_m, rows[i].position_m);
    EXPECT_EQ((*back)[i].orientation_wxyz, rows[i].orientation_wxyz);
  }
}

// Comments of all lengths between rows, so that lines lie across the blocks in which a file is
// read.
TEST(Path, LinesLieAnywhereInAFile) {
  constexpr std::size_t kLongest = 4096;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    const char* const ends[] = {"\n", "\r\n"};
    std::string text = "t_s,x_m,y_m,z_m\n";
    std::vector<double> written_m;
    while (text.size() < 300'000) {
      const std::string end = ends[random() % 2];
      text += '#' + std::string(random() % (kLongest - end.size()), 'x') + end;
      for (std::size_t i = random() % 20; i > 0; --i) {
        written_m.push_back(static_cast<double>(random() >> 36));
        text += std::to_string(written_m.size()) + ',' + std::to_string(written_m.back()) + ",0,0" +
                ends[random() % 2];
      }
    }
    if (random() % 2 == 0) text.resize(text.find_last_not_of("\r\n") + 1);
    const auto rows = read_text(text);
    ASSERT_TRUE(rows) << to_line(rows.error());
    std::vector<double> read_m;
    for (const PathRow& row : *rows) read_m.push_back(row.position_m[0]);
    EXPECT_EQ(read_m, written_m) << "seed " << seed;
  }
}

TEST(Path, ALineHasAtMost4096Bytes) {
  const std::string begin = "t_s,x_m,y_m,z_m\n" + std::string(65'530, '\n');
  for (const char* const end : {"", "\n", "\n0,0,0,0\n"}) {
    const auto of = [&](std::size_t bytes) {
      const std::string row = "1,2,3,4";
      return read_text(begin + row + std::string(bytes - row.size(), ' ') + end);
    };
    EXPECT_EQ(bool(of(4096)), std::string_view(end).size() < 2) << "the row after it is earlier";
    const auto longer = of(4097);
    ASSERT_FALSE(longer);
    EXPECT_EQ(longer.error().where, "line 65532");
    EXPECT_NE(longer.error().what.find("longer than 4096"), std::string::npos);
  }
}

// Each of these is what read_path refuses.
TEST(Path, WhatItsReaderWouldRefuseIsNotWritten) {
  const PathRow good{1, {0, 0, 0}, {1, 0, 0, 0}};
  const PathRow late{1, {1, 0, 0}, {1, 0, 0, 0}};
  const PathRow none{2, {0, std::nan(""), 0}, {1, 0, 0, 0}};
  const PathRow turned{2, {0, 0, 0}, {1, 0, std::numeric_limits<double>::infinity(), 0}};
  const PathRow far{2, {0, 0, 1.001e9}, {1, 0, 0, 0}};
  const PathRow much_later{1.001e12, {0, 0, 0}, {1, 0, 0, 0}};
  for (const auto& rows : std::vector<std::vector<PathRow>>{
           {}, {good, late}, {none}, {good, turned}, {good, far}, {good, much_later}}) {
    const ScratchFolder folder;
    auto writer = PathWriter::create(folder / "path.csv");
    ASSERT_TRUE(writer);
    Status written;
    for (const PathRow& row : rows) written = written ? writer->add(row) : written;
    if (written) written = writer->finish();
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().code, ErrorCode::kInternal);
    EXPECT_FALSE(std::filesystem::exists(folder / "path.csv"));
  }
}

// A quarter turn about z, half a second in the middle of which the center is half-way.
TEST(Path, IsResampledAboutACenterAndReversed) {
  const double half = std::sqrt(0.5);
  const std::vector<PathRow> rows = {{0, {0, 0, 0}, {1, 0, 0, 0}},
                                     {1, {2, 0, 0}, {half, 0, 0, half}}};
  const auto facts = path_facts(rows);
  EXPECT_EQ(facts.way_m, 2);
  EXPECT_NEAR(facts.turn_rad, M_PI / 2, 1e-15);
  EXPECT_EQ(facts.high_m[0], 2);
  // The center (1, 0, 0) goes from (1, 0, 0) to (2, 1, 0).
  const PathRow middle = pose_at(rows, 0.5, {1, 0, 0});
  EXPECT_NEAR(middle.orientation_wxyz[3], std::sin(M_PI / 8), 1e-15);
  EXPECT_NEAR(middle.position_m[0], 1.5 - half, 1e-15);
  EXPECT_NEAR(middle.position_m[1], 0.5 - half, 1e-15);
  EXPECT_EQ(pose_at(rows, 9, {}).position_m[0], 2);
  const auto samples = resampled(rows, 0.3, {1, 0, 0});
  ASSERT_EQ(samples.size(), 5u);
  EXPECT_EQ(samples[4].time_s, 1);
  EXPECT_NEAR(samples[3].time_s, 0.9, 1e-15);
  const auto back = reversed(samples);
  ASSERT_EQ(back.size(), 5u);
  EXPECT_EQ(back[0].time_s, 0);
  EXPECT_NEAR(back[1].time_s, 0.1, 1e-15);
  EXPECT_EQ(back[4].position_m, samples[0].position_m);
}

// Seconds since 1970 are doubles 2.4e-7 s apart: a sample at 1.0000002 s is one at the end. Those
// at 1e11 s are 1.5e-5 s apart.
TEST(Path, IsResampledAtLateTimes) {
  const std::pair<double, double> cases[] = {{1.7e9, 0.0010000002}, {1.7e9, 1e-3}, {1e11, 1e-6}};
  for (const auto& [begin_s, period_s] : cases) {
    const double end_s = begin_s + 1 + std::ldexp(1.0, -22);
    const std::vector<PathRow> rows = {{begin_s, {0, 0, 0}, {1, 0, 0, 0}},
                                       {end_s, {2, 0, 0}, {1, 0, 0, 0}}};
    const auto samples = resampled(rows, period_s, {});
    for (std::size_t i = 1; i < samples.size(); ++i) {
      ASSERT_LT(samples[i - 1].time_s, samples[i].time_s) << period_s << " row " << i;
    }
    EXPECT_EQ(samples.back().position_m[0], 2);
    EXPECT_GE(samples.size(), 1001u);
  }
}

}  // namespace
}  // namespace forcelayer::test
