// Playing, stepping and jumping in a run.
#include <gtest/gtest.h>

#include "workbench/viewer/run/playback.h"
#include "workbench/viewer/run/run_rows.h"

namespace forcelayer {
namespace {

// 100 frames, 10 ms each; contact in frames 20-29 and 60-69, a guard cut in 65.
std::vector<viewer::TraceRow> rows() {
  std::vector<viewer::TraceRow> result(100);
  for (std::size_t n = 0; n < result.size(); ++n) {
    result[n].time_s = 0.01 * static_cast<double>(n);
    result[n].contacts = (n >= 20 && n < 30) || (n >= 60 && n < 70) ? 3 : 0;
    result[n].guard_cuts = n == 65 ? 1 : 0;
  }
  return result;
}

TEST(Playback, PlaysPausesAndEnds) {
  const std::vector<viewer::TraceRow> run = rows();
  viewer::Playback playback(run);
  playback.advance(0.5);
  EXPECT_EQ(playback.index(), 0u);  // not yet playing
  playback.toggle();
  playback.advance(0.105);
  EXPECT_EQ(playback.index(), 10u);
  playback.toggle();
  playback.advance(1);
  EXPECT_EQ(playback.index(), 10u);
  playback.toggle();
  playback.advance(5);
  EXPECT_EQ(playback.index(), 99u);
  EXPECT_FALSE(playback.playing());
  playback.toggle();  // from the start again
  EXPECT_EQ(playback.index(), 0u);
}

TEST(Playback, StepsAndSeeksWithinTheRun) {
  const std::vector<viewer::TraceRow> run = rows();
  viewer::Playback playback(run);
  playback.step(-1);
  EXPECT_EQ(playback.index(), 0u);
  playback.step(10);
  EXPECT_EQ(playback.index(), 10u);
  playback.step(1000);
  EXPECT_EQ(playback.index(), 99u);
  playback.seek(0.333);
  EXPECT_EQ(playback.index(), 33u);
}

TEST(Playback, JumpsToWhatHappened) {
  const std::vector<viewer::TraceRow> run = rows();
  viewer::Playback playback(run);
  playback.jump_to_contact(true);
  EXPECT_EQ(playback.index(), 20u);
  playback.jump_to_contact(true);
  EXPECT_EQ(playback.index(), 60u);
  playback.jump_to_contact(true);
  EXPECT_EQ(playback.index(), 60u);
  playback.jump_to_contact(false);
  EXPECT_EQ(playback.index(), 20u);
  playback.jump_to_guard_cut(true);
  EXPECT_EQ(playback.index(), 65u);
}

TEST(Live, RefusesWhatIsNoPort) {
  for (const char* text : {"", "port", "70000", "127.0.0.1:", "127.0.0.1:x"}) {
    const auto receiver = viewer::listen_at(text);
    ASSERT_FALSE(receiver) << text;
    EXPECT_EQ(receiver.error().code, ErrorCode::kUsage) << text;
  }
  const auto receiver = viewer::listen_at("127.0.0.1:0");  // any free port
  ASSERT_TRUE(receiver) << to_line(receiver.error());
  EXPECT_NE(receiver->port(), 0);
}

}  // namespace
}  // namespace forcelayer
