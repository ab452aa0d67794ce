// The reader of traces.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/scratch_folder.h"
#include "workbench/viewer/run/trace.h"

namespace forcelayer {
namespace {

const std::string kHeader =
    "t_s,handle_x_m,handle_y_m,handle_z_m,handle_qw,handle_qx,handle_qy,handle_qz,part_x_m,"
    "part_y_m,part_z_m,part_qw,part_qx,part_qy,part_qz,force_x_n,force_y_n,force_z_n,torque_x_nm,"
    "torque_y_nm,torque_z_nm,points_proximity,points_surface,points_interior,contacts,guard_cuts,"
    "step_ns,more";

std::string row(double time_s, double force_n) {
  return std::to_string(time_s) + ",1,2,3,1,0,0,0,4,5,6,0,0,0,2," + std::to_string(force_n) +
         ",0,0,0.1,0.2,0.3,7,8,9,10,11,1200.5,x";
}

Result<std::vector<viewer::TraceRow>> read_text(const std::string& text) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "trace.csv") << text;
  return viewer::read_trace(folder / "trace.csv");
}

TEST(Trace, ReadsEveryColumnByName) {
  const auto rows = read_text(kHeader + "\r\n" + row(0.5, 2) + "\r\n" + row(0.501, -3) + "\n");
  ASSERT_TRUE(rows) << to_line(rows.error());
  ASSERT_EQ(rows->size(), 2u);
  const viewer::TraceRow& first = rows->front();
  EXPECT_EQ(first.time_s, 0.5);
  EXPECT_EQ(first.world_from_handle.position_m, glm::dvec3(1, 2, 3));
  EXPECT_EQ(first.world_from_part.position_m, glm::dvec3(4, 5, 6));
  EXPECT_EQ(first.world_from_part.orientation.z, 1);  // normalized
  EXPECT_EQ(first.on_hand->force_n, glm::dvec3(2, 0, 0));
  EXPECT_EQ(first.on_hand->torque_nm, glm::dvec3(0.1, 0.2, 0.3));
  EXPECT_EQ(first.points_proximity, 7u);
  EXPECT_EQ(first.points_surface, 8u);
  EXPECT_EQ(first.points_interior, 9u);
  EXPECT_EQ(first.contacts, 10u);
  EXPECT_EQ(first.guard_cuts, 11u);
  EXPECT_EQ(first.step_ns, 1200.5);
}

// A row of a run: its force, its contacts, and its clearance where one is proven.
viewer::TraceRow moment(double force_n, std::uint32_t contacts,
                        std::optional<viewer::RowClearance> clearance = std::nullopt) {
  viewer::TraceRow row;
  row.on_hand = Wrench{{0, force_n, 0}, {}};
  row.contacts = contacts;
  row.clearance = std::move(clearance);
  return row;
}

TEST(Trace, ShowsTheLeastClearanceElseTheStrongestForce) {
  // In its seat, held; out of it, past something near; pressed against something behind that.
  const std::vector<viewer::TraceRow> out = {moment(2, 9),
                                             moment(15, 9),
                                             moment(0, 0, {{0.003, false, "a"}}),
                                             moment(1, 0, {{0.001, false, "b"}}),
                                             moment(1, 2, {{0.001, false, "c"}}),
                                             moment(0, 0, {{0.02, true, ""}})};
  const viewer::NotableRows notable = viewer::notable_rows(out);
  EXPECT_EQ(notable.usual(), 3u);  // the first, as voxrun reports it
  EXPECT_EQ(notable.name_of(3), "the least proven clearance");
  EXPECT_EQ(notable.name_of(1), "the strongest force");
  EXPECT_EQ(notable.name_of(4), "");

  // Nothing was proven: the strongest force, of rows with a contact; braking is felt without one.
  const std::vector<viewer::TraceRow> held = {moment(0, 0), moment(3, 1), moment(-5, 1),
                                              moment(9, 0)};
  EXPECT_EQ(viewer::notable_rows(held).usual(), 2u);
  EXPECT_EQ(viewer::notable_rows(held).name_of(2), "the strongest force");

  // Nothing was measured and nothing felt: the start, which is not called anything.
  const std::vector<viewer::TraceRow> far(3, moment(0, 0, {{0.02, true, ""}}));
  EXPECT_EQ(viewer::notable_rows(far).usual(), 0u);
  EXPECT_EQ(viewer::notable_rows(far).name_of(0), "");
}

TEST(Trace, ReadsTheClearanceWhereItIsTold) {
  const std::string header = kHeader + ",clearance_m,clearance_at_least,output,nearest_object\n";
  const auto rows = read_text(header + row(0, 2) + ",0.0125,0,1,\"beam, \"\"left\"\"\"\r\n" +
                              row(1, 2) + ",0.02,1,1,\n" + row(2, 2) + ",,,1,\n");
  ASSERT_TRUE(rows) << to_line(rows.error());
  ASSERT_TRUE((*rows)[0].clearance);
  EXPECT_EQ((*rows)[0].clearance->clearance_m, 0.0125);
  EXPECT_FALSE((*rows)[0].clearance->at_least);
  EXPECT_EQ((*rows)[0].clearance->object, "beam, \"left\"");
  ASSERT_TRUE((*rows)[1].clearance);
  EXPECT_TRUE((*rows)[1].clearance->at_least);
  EXPECT_FALSE((*rows)[2].clearance);
  EXPECT_FALSE(read_text(kHeader + "\n" + row(1, 0) + "\n")->front().clearance);
}

TEST(Trace, FindsTheRowAtATime) {
  const auto rows = read_text(kHeader + "\n" + row(1, 0) + "\n" + row(2, 0) + "\n" + row(3, 0));
  ASSERT_TRUE(rows);
  EXPECT_EQ(viewer::row_at(*rows, 0), 0u);
  EXPECT_EQ(viewer::row_at(*rows, 2), 1u);
  EXPECT_EQ(viewer::row_at(*rows, 2.9), 1u);
  EXPECT_EQ(viewer::row_at(*rows, 99), 2u);
}

TEST(Trace, RefusesWhatItCannotRead) {
  EXPECT_EQ(viewer::read_trace("/nowhere/trace.csv").error().code, ErrorCode::kFileNotFound);
  EXPECT_EQ(read_text("").error().code, ErrorCode::kNotThisFormat);
  EXPECT_EQ(read_text("t_s,force\n1,2\n").error().code, ErrorCode::kNotThisFormat);
  EXPECT_EQ(read_text(kHeader + "\n").error().code, ErrorCode::kNotThisFormat);
  const auto cut = read_text(kHeader + "\n" + row(1, 0) + "\n1,2,3\n");
  EXPECT_EQ(cut.error().code, ErrorCode::kFieldInvalid);
  EXPECT_EQ(cut.error().where, "line 3");
  EXPECT_EQ(read_text(kHeader + "\nnan" + row(1, 0).substr(8)).error().code,
            ErrorCode::kFieldInvalid);
  for (const char* const count : {",-1,", ",5e9,", ",1e300,"}) {
    std::string line = row(1, 0);
    line.replace(line.find(",10,"), 4, count);
    const auto counted = read_text(kHeader + "\n" + line);
    ASSERT_FALSE(counted) << count;
    EXPECT_EQ(counted.error().what, "contacts is not a whole number of zero or more");
  }
}

}  // namespace
}  // namespace forcelayer
