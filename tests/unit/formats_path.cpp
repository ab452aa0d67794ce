// Paths as files: which headers are read, and other paths made of one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <span>

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
      {"t_s;x_m;y_m;z_m;rz_deg\n1;2;3;4;180\n", {1, {2, 3, 4}, {0, 0, 0, 1}}},
      {"sep=;\r\nt [s];X (mm);y/m;z_m;Rx [deg];ry [\xc2\xb0]\n1;\"2000,0\";\"3\"; 4 ;0;180\n",
       {1, {2, 3, 4}, {0, 0, 1, 0}}},
      {"t_s,\"x_m\",\"y_m\",\"z_m\",\"a, b\"\n\"1\",\"2\",\" 3\",\"+4\",\"c, d\"\n",
       {1, {2, 3, 4}, {1, 0, 0, 0}}},
      {"t_s\tx_m\ty_m\tz_m\tn\n1\t2\t 3 \t4\t\n", {1, {2, 3, 4}, {1, 0, 0, 0}}},
      {"size \",t_s,x_m,y_m,\"z_m\"\n3/4\" bolt,1,2,3,\t\"4\" \n", {1, {2, 3, 4}, {1, 0, 0, 0}}},
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
  EXPECT_EQ(only_row(std::rbegin(cases)->text, PathOf::kHandle).position_m[0], 5);
}

TEST(Path, WhatIsNoneSaysWhy) {
  const struct {
    const char *text, *where, *what;
  } cases[] = {
      {"t_s,x,y,z\n0,0,0,0\n", "line 1", "x_mm"},
      {"x_m,y_m,z_m\n0,0,0\n", "line 1", "t_s"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy\n0,0,0,0,1,0,0\n", "line 1", "qz"},
      {"# nothing\n", "line 2", "header"},
      {"t_s x_m y_m z_m\n0 0 0 0\n", "line 1", "no comma, semicolon or tab"},
      {"t_s,x_m,y_m,z_m\n0,0,0\n", "line 2", "has 3 cells, but the header has 4"},
      {"t_s,x_m,y_m,z_m\n0,0,0,0,\n", "line 2", "has 5 cells"},
      {"t_s;x_m;y_m;z_m\n0;0;1,2,3;0\n", "line 2", "'y_m' is '1,2,3', not a finite number"},
      {"t_s,X_mm ,y_m,z_m\n0,00:00:01,0,0\n", "line 2", "'X_mm' is '00:00:01', not"},
      {"t_s,x_m,y_m,z_m\n0,0,0, \n", "line 2", "'z_m' is '', not a finite number"},
      {"t_s,x_m,y_m,z_m\n0,\xe2\x88\x92"
       "1,\x1b[2J,0\n",
       "line 2",
       "'\xe2\x88\x92"
       "1', not a finite"},
      {"t_s,x_m,y_m,z_m\n0,1,\x1b[2J,0\n", "line 2", "'\\x1b[2J', not a finite"},
      {"t_s,x_m,y_m,z_m\n0,0,0,0\n# c\n0,1,1,1\n", "line 4",
       "the time 0 s is not later than 0 s in the row before"},
      {"t_ms,x_m,y_m,z_m\n1700000000123,0,0,0\n1700000000122,1,1,1\n", "line 3",
       "the time 1700000000.122 s is not later than 1700000000.123 s in the row before"},
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

// A cell is shown up to 40 bytes, and not within a character.
TEST(Path, ALongCellIsShortened) {
  const std::string cell = std::string(39, 'x') + "\xc3\xbc" + std::string(1000, 'y');
  const auto rows = read_text("t_s,x_m,y_m,z_m\n0," + cell + ",0,0\n");
  ASSERT_FALSE(rows);
  EXPECT_NE(rows.error().what.find("'" + std::string(39, 'x') + "...'"), std::string::npos)
      << rows.error().what;
}

// A turn that is not read is an error, not left out: the part would be checked unturned.
TEST(Path, AColumnThatMayBeATurnIsReadOrRefused) {
  const std::string begin = "t_s,x_m,y_m,z_m,", rows = "\n0,0,0,0,1,1,1,1\n1,0,0,0,1,1,1,1\n";
  for (const char* const names : {"rx,ry,rz,n",
                                  "rx_deg,ry_deg,rz,n",
                                  "rx_grad,ry_grad,rz_grad,n",
                                  "Rx [gon],n,n,n",
                                  "rx_m,n,n,n",
                                  "rx_\xb0,n,n,n",
                                  "r_x,n,n,n",
                                  "rzdeg,n,n,n",
                                  "q_w,q_x,q_y,q_z",
                                  "q0,q1,q2,q3",
                                  "quat_w,quat_x,quat_y,quat_z",
                                  "orientation.w,n,n,n",
                                  "pose.orientation.w,n,n,n",
                                  "tcp_rx,n,n,n",
                                  "tool_q_w,n,n,n",
                                  "rotx,n,n,n",
                                  "Rotation X,n,n,n",
                                  "roll,n,n,n",
                                  "n,pitch_deg,n,n",
                                  "yaw_rad,n,n,n",
                                  "a,b,c,n",
                                  "a_deg,b_deg,c_deg,n",
                                  "w,n,n,n",
                                  "theta_rad,n,n,n",
                                  "euler_z,n,n,n",
                                  "Heading,n,n,n",
                                  "angle,n,n,n",
                                  "RPY 1,n,n,n",
                                  "n,n,n,tilt_degrees",
                                  "part_qw,part_qx,part_qy,part_qz",
                                  "part_rz_deg,n,n,n"}) {
    const auto read = read_text(begin + names + rows);
    ASSERT_FALSE(read) << names;
    EXPECT_EQ(read.error().where, "line 1") << names;
    EXPECT_NE(read.error().what.find("may be a rotation in an unknown form"), std::string::npos)
        << names << ": " << read.error().what;
    EXPECT_NE(read.error().mend.find("rx_deg"), std::string::npos) << names;
  }
  // Those that have the prefix of a trace's other pose, and what is no turn.
  for (const char* const names :
       {"handle_qw,handle_rz_deg,handle_rx,note", "force_x_n,torque_x_nm,step_ns,output",
        "radius_mm,r_m,quality,controller", "triangle,vx_mps,wx_radps,j1", "x,y,z,t",
        "part_name,n,n,n"}) {
    const auto read = read_text(begin + names + rows);
    EXPECT_TRUE(read) << names << ": " << to_line(read.error());
  }
  // In a trace, names without a prefix do not belong to the pose.
  const std::string trace = "t_s,part_x_m,part_y_m,part_z_m,";
  EXPECT_FALSE(read_text(trace + "rx_deg,ry_deg,rz_deg,n" + rows));
  EXPECT_FALSE(read_text(trace + "part_rx,n,n,n" + rows));
  EXPECT_TRUE(read_text(trace + "part_rx_deg,x_mm,handle_roll,n" + rows));
}

TEST(Path, NoValueIsGivenTwice) {
  const std::string rows = "\n0,0,0,0,0,0,0,1,1\n";
  const struct {
    const char *header, *names[2];
  } cases[] = {
      {"t_s,x_m,y_m,z_m,X_mm,n,n,n,n", {"'x_m'", "'X_mm'"}},
      {"t_s,x_mm,y_m,z_m,x_mm,n,n,n,n", {"'x_mm'", "both 'x_mm' and 'x_mm'"}},
      {"t_s,x_mm,y_m,z_m,time_ms,n,n,n,n", {"'t_s'", "'time_ms'"}},
      {"t_s,x_mm,y_m,z_m,rx_deg,rx_rad,n,n,n", {"'rx_deg'", "'rx_rad'"}},
      {"t_s,x_m,y_m,z_m,qx,qy,qz,qw,rz_deg", {"'qw'", "'rz_deg'"}},
      {"t_s,part_x_m,part_y_m,part_z_m,part_x_cm,x_m,n,n,n", {"'part_x_m'", "'part_x_cm'"}},
  };
  for (const auto& c : cases) {
    const auto read = read_text(c.header + rows);
    ASSERT_FALSE(read) << c.header;
    EXPECT_EQ(read.error().where, "line 1") << c.header;
    for (const char* const name : c.names) {
      EXPECT_NE(read.error().what.find(name), std::string::npos) << read.error().what;
    }
  }
}

TEST(Path, OtherFilesAreToldByTheirKind) {
  const std::string utf16("\xff\xfet\0_\0s\0,\0x\0\n\0", 14);
  const std::pair<std::string, const char*> cases[] = {
      {" {\"t_s\": 0}\n", "JSON"},
      {"[[0, 0, 0, 0]]\n", "JSON"},
      {utf16, "UTF-16"},
      {"\211FLV\r\n\x1a\n", ".vox"},
      {"\211FLP\r\n\x1a\n", ".pshell"},
      {"\211FLR\r\n\x1a\n", "recording"},
      {"PK\3\4\n", "workbook"},
  };
  for (const auto& [text, kind] : cases) {
    const auto read = read_text(text);
    ASSERT_FALSE(read) << kind;
    EXPECT_EQ(read.error().code, ErrorCode::kUsage) << kind;
    EXPECT_NE(read.error().what.find(kind), std::string::npos) << read.error().what;
  }
}

using Matrix = std::array<std::array<double, 3>, 3>;

// Rz Ry Rx.
Matrix matrix_of(const std::array<double, 3>& turn_deg) {
  Matrix all{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
    const double c = std::cos(turn_deg[axis] * M_PI / 180),
                 s = std::sin(turn_deg[axis] * M_PI / 180);
    for (std::size_t column = 0; column < 3; ++column) {
      const double x = all[a][column], y = all[b][column];
      all[a][column] = c * x - s * y;
      all[b][column] = s * x + c * y;
    }
  }
  return all;
}

// The slow twin: three matrices, one after the other.
TEST(Path, TurnsAreAboutTheWorldsAxesXThenYThenZ) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any_deg(-400, 400);
  for (int trial = 0; trial < 50; ++trial) {
    const std::array<double, 3> turn_deg{any_deg(random), any_deg(random), any_deg(random)};
    char text[256];
    std::snprintf(text, sizeof text,
                  "t_s,x_m,y_m,z_m,rx_deg,ry_deg,rz_deg\n0,0,0,0,%.17g,%.17g,%.17g\n", turn_deg[0],
                  turn_deg[1], turn_deg[2]);
    const auto [w, x, y, z] = only_row(text).orientation_wxyz;
    const Matrix read{{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                       {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                       {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
    const Matrix wanted = matrix_of(turn_deg);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(read[i][j], wanted[i][j], 1e-14) << trial;
    }
  }
}

// Between two rows of turns: the slow twin, by matrices.
TEST(Path, AStepOfHalfATurnIsRefusedButWhereTheNumbersStartAnew) {
  const auto read = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    char text[512];
    std::snprintf(text, sizeof text,
                  "t_s,x_m,y_m,z_m,rx_deg,ry_deg,rz_deg\n0,0,0,0,0,0,0\n# c\n"
                  "1,0,0,0,%.17g,%.17g,%.17g\n2,0,0,0,%.17g,%.17g,%.17g\n",
                  a[0], a[1], a[2], b[0], b[1], b[2]);
    return read_text(text);
  };
  for (const double to_deg : {180.0, 181.0, -181.0, 360.0, 540.0, -360.0, -180.0}) {
    const auto rows = read({0, 0, 0}, {0, 0, to_deg});
    ASSERT_FALSE(rows) << to_deg;
    EXPECT_EQ(rows.error().where, "line 5");
    EXPECT_NE(rows.error().what.find("'rz_deg' turns by 180 degrees"), std::string::npos);
    EXPECT_EQ(rows.error().mend.find("add rows before"), 0u);
  }
  for (const double to_deg : {179.9, -179.9, 271.0, 359.0, -359.0}) {
    EXPECT_TRUE(read({0, 0, 0}, {0, 0, to_deg})) << to_deg;
  }
  EXPECT_TRUE(read({0, 0, 179}, {0, 0, -179}));
  EXPECT_TRUE(read({10, 89, 20}, {-170, 89, -160})) << "beside the pole";
  int refused = 0, anew = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> any_deg(-179, 179), step_deg(-30, 30);
    std::array<double, 3> a{any_deg(random), any_deg(random), any_deg(random)}, b = a;
    for (double& turn_deg : b) turn_deg += step_deg(random);
    b[random() % 3] += 180.0 * (static_cast<double>(random() % 5) - 2);
    if (random() % 2 == 0) b = {b[0] + 180, 180 - b[1], b[2] - 180};  // the same, otherwise
    const Matrix from = matrix_of(a), to = matrix_of(b);
    double trace = 0, max_deg = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      max_deg = std::max(max_deg, std::abs(b[i] - a[i]));
      for (std::size_t j = 0; j < 3; ++j) trace += from[i][j] * to[i][j];
    }
    const double angle_deg = std::acos(std::clamp((trace - 1) / 2, -1.0, 1.0)) * 180 / M_PI;
    const bool wanted = max_deg < 180 || (max_deg < 360 && angle_deg <= 90);
    EXPECT_EQ(read(a, b).ok(), wanted) << "seed " << seed << ": " << max_deg << ", " << angle_deg;
    refused += !wanted;
    anew += wanted && max_deg >= 180;
  }
  EXPECT_GT(refused, 40);
  EXPECT_GT(anew, 40);
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
  EXPECT_EQ(facts.length_m, 2);
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

// A wait and a straight stretch are two rows each, and no pose is off by more than is allowed.
TEST(Path, AThinnedPathIsTheSameMotion) {
  constexpr double kWithinM = 1e-6, kRadiusM = 0.1;
  const std::array<double, 3> center_m{0.01, 0.02, 0.03};
  std::vector<PathRow> rows;
  for (int i = 0; i <= 3000; ++i) {
    const double time_s = 1e-3 * i, out_m = std::clamp(time_s - 1, 0.0, 1.0);
    const double turn = std::max(0.0, time_s - 2);
    rows.push_back({time_s, {0, 0, out_m}, {std::cos(turn / 2), 0, 0, std::sin(turn / 2)}});
  }
  // The turn is about the origin, not about the center, so that it takes more rows.
  const auto few = thinned(rows, center_m, kRadiusM, kWithinM);
  EXPECT_GT(few.size(), 20u);
  EXPECT_LT(few.size(), 120u);
  EXPECT_EQ(thinned(std::span(rows).first(2001), center_m, kRadiusM, kWithinM).size(), 3u);
  EXPECT_EQ(thinned(std::span(rows).first(1), center_m, kRadiusM, kWithinM).size(), 1u);
  for (const PathRow& row : rows) {
    const PathRow there = pose_at(few, row.time_s, center_m);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_NEAR(there.position_m[axis], row.position_m[axis], kWithinM) << row.time_s;
    }
  }
}

// No corner and no dip is lost, however the period falls; rows are as they were.
TEST(Path, AResampledPathHasAllItsRows) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> any(-1, 1);
    std::vector<PathRow> rows;
    double time_s = any(random) * 10;
    for (std::size_t i = random() % 6 + 1; i > 0; --i) {
      PathRow row{time_s, {any(random), any(random), any(random)}, {1, 0, 0, 0}};
      if (random() % 2 == 0) row.orientation_wxyz = {0.6, 0, 0.8, 0};
      rows.push_back(row);
      // Some of them at a sample's time, but for rounding.
      time_s += random() % 2 == 0 ? 0.1 * static_cast<double>(random() % 9 + 1) : 1.1 + any(random);
    }
    const std::array<double, 3> center_m{any(random), any(random), any(random)};
    const auto samples = resampled(rows, 0.1, center_m);
    std::size_t row = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (i > 0) {
        const double step_s = samples[i].time_s - samples[i - 1].time_s;
        ASSERT_GT(step_s, 1e-11) << "seed " << seed;
        ASSERT_LT(step_s, 0.1 + 1e-9) << "seed " << seed;
      }
      if (row < rows.size() && samples[i].time_s == rows[row].time_s) {
        ASSERT_EQ(samples[i].position_m, rows[row].position_m) << "seed " << seed;
        ASSERT_EQ(samples[i].orientation_wxyz, rows[row].orientation_wxyz) << "seed " << seed;
        ++row;
      } else {
        const double n = (samples[i].time_s - rows[0].time_s) / 0.1;
        ASSERT_NEAR(n, std::round(n), 1e-9) << "seed " << seed;
        const PathRow there = pose_at(rows, samples[i].time_s, center_m);
        ASSERT_EQ(samples[i].position_m, there.position_m) << "seed " << seed;
      }
    }
    EXPECT_EQ(row, rows.size()) << "seed " << seed;
  }
}

// The facts are those of the point that is asked for: a part that turns about its frame's origin.
TEST(Path, FactsAreThoseOfAPoint) {
  const std::vector<PathRow> rows = {{0, {0, 0, 0}, {1, 0, 0, 0}},
                                     {1, {0, 0, 0}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}};
  EXPECT_EQ(path_facts(rows).length_m, 0);
  const auto facts = path_facts(rows, {2, 0, 1});
  EXPECT_NEAR(facts.length_m, 2 * std::sqrt(2), 1e-15);
  EXPECT_NEAR(facts.max_mps, 2 * std::sqrt(2), 1e-15);
  EXPECT_NEAR(facts.high_m[0], 2, 1e-15);
  EXPECT_NEAR(facts.high_m[1], 2, 1e-15);
  EXPECT_EQ(facts.low_m[2], 1);
}

// The slow twin: both ways, looked at in many places.
TEST(Path, AWideStepIsWhereTheOriginOrTheCentroidGoesStraight) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> any;
    std::vector<PathRow> rows;
    for (int i = 0; i < 4; ++i) {
      PathRow row{double(i), {any(random), any(random), any(random)}, {1, 0, 0, 0}};
      auto& q = row.orientation_wxyz;
      for (double& part : q) part = any(random);
      const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
      for (double& part : q) part /= norm;
      rows.push_back(row);
    }
    rows[3].orientation_wxyz = rows[2].orientation_wxyz;  // no turn
    const std::array<double, 3> center_m{any(random), any(random), any(random)};
    double aside_m = 0;
    std::size_t at = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (int n = 0; n <= 100; ++n) {
        const double time_s = double(i) + 0.01 * n;
        const PathRow a = pose_at(rows, time_s, center_m), b = pose_at(rows, time_s, {});
        const double apart_m =
            std::hypot(a.position_m[0] - b.position_m[0], a.position_m[1] - b.position_m[1],
                       a.position_m[2] - b.position_m[2]);
        if (apart_m > aside_m + 1e-12) {
          aside_m = apart_m;
          at = i;
        }
      }
    }
    const WideStep step = widest_step(rows, center_m);
    EXPECT_EQ(step.row, at) << "seed " << seed;
    EXPECT_NEAR(step.aside_m, aside_m, 1e-12) << "seed " << seed;
    EXPECT_NEAR(step.shift_m, path_facts(std::span(rows).subspan(at, 2), center_m).length_m, 1e-12);
    EXPECT_NEAR(step.turn_rad, path_facts(std::span(rows).subspan(at, 2)).turn_rad, 1e-12);
  }
  const std::vector<PathRow> still = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {1, 0, 0}, {1, 0, 0, 0}}};
  EXPECT_EQ(widest_step(still, {1, 2, 3}).aside_m, 0);
  EXPECT_EQ(widest_step(std::span(still).first(1), {1, 2, 3}).aside_m, 0);
}

// Between the rows that are added the centroid goes straight, and no point is off by more than
// allowed: every orientation is the same, so all points of the part are off as the centroid is.
// With one row fewer in the longest turn it would be off by more than half of that.
TEST(Path, TurnsAboutAPivotAsCloselyAsAllowed) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-0.1, 0.1);
    std::vector<PathRow> rows;
    for (int n = 0; n < 4; ++n) {
      PathRow row{double(n), {}, {}};
      for (double& x : row.position_m) x = any(random);
      double square = 0;
      for (double& q : row.orientation_wxyz) q = any(random), square += q * q;
      for (double& q : row.orientation_wxyz) q /= std::sqrt(square);
      rows.push_back(row);
    }
    std::array<double, 3> center_m{}, pivot_m{};
    for (double& x : center_m) x = any(random);
    for (double& x : pivot_m) x = any(random);
    constexpr double kWithinM = 1e-5;
    const auto turned = turned_about(rows, pivot_m, center_m, kWithinM);
    ASSERT_TRUE(turned) << to_line(turned.error());
    double off_m = 0;
    for (int n = 0; n <= 30000; ++n) {
      const double time_s = 1e-4 * n;
      const PathRow a = pose_at(*turned, time_s, center_m), b = pose_at(rows, time_s, pivot_m);
      off_m = std::max(
          off_m, std::hypot(a.position_m[0] - b.position_m[0], a.position_m[1] - b.position_m[1],
                            a.position_m[2] - b.position_m[2]));
    }
    EXPECT_LE(off_m, kWithinM) << "seed " << seed;
    EXPECT_GT(off_m, kWithinM / 2) << "seed " << seed;
  }
}

// About the centroid, and where nothing turns, no row is added; too many are refused.
TEST(Path, TurnsAboutAPivotByNoMoreRowsThanItNeeds) {
  const std::vector<PathRow> half = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {1, 0, 0}, {0, 0, 0, 1}}};
  EXPECT_EQ(turned_about(half, {1, 2, 3}, {1, 2, 3}, 1e-9)->size(), 2u);
  EXPECT_EQ(turned_about(half, {1, 2, 0}, {1, 2, 3}, 1e-9)->size(), 2u);  // along the axis
  const std::vector<PathRow> still = {{0, {0, 0, 0}, {1, 0, 0, 0}}, {1, {1, 0, 0}, {1, 0, 0, 0}}};
  EXPECT_EQ(turned_about(still, {}, {1, 2, 3}, 1e-9)->size(), 2u);
  EXPECT_EQ(turned_about(half, {}, {1e9, 0, 0}, 1e-9).error().code, ErrorCode::kUsage);
  std::vector<PathRow> late = half;
  for (PathRow& row : late) row.time_s = 1e12 + 2e-4 * row.time_s;
  EXPECT_EQ(turned_about(late, {}, {1, 0, 0}, 1e-6).error().code, ErrorCode::kUsage);
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
