// The voxel size that a study chooses: from the part, its play and the time allowed.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "workbench/study/voxel_size.h"

namespace forcelayer::study {
namespace {

const SizeCost kLook{1e-3, 2.867e-3, 1000, 20e6, 0.1};

TEST(StudyVoxels, EachSizeIsOneTwoOrFiveTimesAPowerOfTen) {
  double size_m = 1e-3;
  for (const char* text : {"1mm", "0.5mm", "0.2mm", "0.1mm", "0.05mm", "0.02mm", "0.01mm"}) {
    EXPECT_EQ(size_option(size_m), text);
    size_m = smaller_size_m(size_m);
  }
}

TEST(StudyVoxels, FirstSizeComesFromThePartOrItsPlay) {
  const SizeQuestion question{0.1, 1e-3, 1e6, 1e15};
  const SizeChoice part = choose_size(question, kLook, {});
  EXPECT_EQ(size_option(part.first_m), "1mm");  // a hundredth of it
  // A play of 2.867 voxels of 0.2 mm, a little more, and a little less.
  Play play{0.2 * 2.867e-3, "plate", {}, 0, true};
  EXPECT_EQ(size_option(choose_size(question, kLook, play).first_m), "0.2mm");
  play.play_m *= 1 + 1e-6;
  EXPECT_EQ(size_option(choose_size(question, kLook, play).first_m), "0.2mm");
  play.play_m *= 1 - 1e-5;
  const SizeChoice less = choose_size(question, kLook, play);
  EXPECT_EQ(size_option(less.first_m), "0.1mm");
  EXPECT_EQ(size_option(less.last_m),
            "0.1mm");  // the part fits, and smaller voxels are for nothing
}

TEST(StudyVoxels, FilesStoreHowDeepThePartOverlaps) {
  const SizeQuestion question{0.1, 1e-3, 1e6, 1e15};
  Play play{0.2 * 2.867e-3, "plate", {"table"}, 0.2e-3 * (kDeepestVoxels - 4), true};
  EXPECT_EQ(size_option(choose_size(question, kLook, play).first_m), "0.2mm");
  play.overlap_m *= 1 + 1e-6;
  const SizeChoice deep = choose_size(question, kLook, play);
  EXPECT_EQ(size_option(deep.first_m), "0.5mm");
  EXPECT_NE(deep.why_first.find("how deep the part overlaps"), std::string::npos);
}

TEST(StudyVoxels, TimeLimitsBothSizesOnBothSidesOfTheBound) {
  const Play play{1e-6, "plate", {}, 0, true};  // the smaller the better
  for (const double off : {1 - 1e-6, 1 + 1e-6}) {
    // Voxels of 0.5 mm take 0.4 s, and of 0.2 mm 2.5 s.
    const SizeChoice first = choose_size({0.1, 0, 4 * off, 1e15}, kLook, play);
    EXPECT_EQ(size_option(first.first_m), off > 1 ? "0.5mm" : "1mm");
    const SizeChoice last = choose_size({0.1, 0, 2.5 * off, 1e15}, kLook, play);
    EXPECT_EQ(size_option(last.last_m), off > 1 ? "0.2mm" : "0.5mm");
    EXPECT_NE(last.why_last.find("allowed"), std::string::npos) << last.why_last;
  }
}

TEST(StudyVoxels, NoChoiceTakesMoreThanIsAllowed) {
  const unsigned seed = 7;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution(std::log(low), std::log(high))(random));
  };
  for (int n = 0; n < 2000; ++n) {
    SizeQuestion question;
    question.part_m = between(1e-4, 10);
    question.required_m = between(1e-6, 0.1);
    question.time_s = between(0.1, 1e4);
    question.memory_bytes = between(1e8, 1e12);
    Play play;
    if (n % 2 == 0) play = {between(1e-6, 0.1), "plate", {}, 0, true};
    SizeCost look;
    look.voxel_size_m = look_size_m(question.part_m, 2 * question.part_m, question.required_m);
    look.fits_m = 2.867 * look.voxel_size_m;
    look.bytes = between(1e7, 1e9);
    look.thread_s = between(1e-3, 100);
    const SizeChoice choice = choose_size(question, look, play);
    ASSERT_LE(choice.last_m, choice.first_m);
    ASSERT_FALSE(choice.why_first.empty() || choice.why_last.empty());
    for (const SizeCost& size : sizes_of(choice, look)) {
      if (size.voxel_size_m == choice.first_m) continue;
      ASSERT_LE(size.thread_s, question.time_s * (1 + 1e-6));
      ASSERT_LE(size.bytes, question.memory_bytes / 2 * (1 + 1e-6));
      ASSERT_LE(question.required_m, 0.9 * 160 * size.voxel_size_m * (1 + 1e-6));
    }
    const SizeCost first = cost_at(look, choice.first_m);
    ASSERT_TRUE(first.thread_s <= 0.1 * question.time_s * (1 + 1e-6) ||
                choice.first_m == look.voxel_size_m);
    if (play.object.empty()) continue;
    const bool fits = cost_at(look, choice.last_m).fits_m <= play.play_m * (1 + 1e-6);
    ASSERT_TRUE(fits || choice.why_last != "small enough for the smallest gap");
  }
}

TEST(StudyVoxels, PlayIsTheSmallestGapThatIsNoContact) {
  const auto report = nlohmann::json::parse(R"({"exact": {}, "seat_depths": [
    {"object": "far", "gap_m": 0.002, "installed_m": 0},
    {"object": "a/pressed", "shown_as": "pressed", "gap_m": 0, "installed_m": 0.0001},
    {"object": "near", "gap_m": 0.0001, "installed_m": 0},
    {"object": "flush", "gap_m": 1e-9, "installed_m": 0}]})");
  const Play play = play_of(report);
  EXPECT_EQ(play.play_m, 0.0001);
  EXPECT_EQ(play_text(play),
            "smallest gap when installed: 0.1 mm, to near; in contact with pressed, flush");
  EXPECT_EQ(play.touched.front(), "a/pressed");
  EXPECT_FALSE(play_of(nlohmann::json::object()).is_measured);
}

// A gap that was not measured is not called large.
TEST(StudyVoxels, PlaySaysWhereTheTimeEndedTheMeasurement) {
  nlohmann::json report = {{"exact", nlohmann::json::object()}};
  EXPECT_EQ(play_text(play_of(report)),
            "when installed, no object is nearer than the required clearance");
  report["violations"] = {{{"out_of_time", false}}, {{"out_of_time", true}}};
  EXPECT_EQ(play_text(play_of(report)), "when installed, not all gaps were measured in time");
  report["seat_depths"] = {{{"object", "flush"}, {"gap_m", 0}, {"installed_m", 0}}};
  EXPECT_EQ(play_text(play_of(report)),
            "when installed: in contact with flush; not all gaps were measured in time");
  report["seat_depths"].push_back({{"object", "near"}, {"gap_m", 1e-4}, {"installed_m", 0}});
  EXPECT_EQ(play_text(play_of(report)),
            "smallest gap measured when installed: 0.1 mm, to near; in contact with flush; not all "
            "gaps were measured in time");
}

}  // namespace
}  // namespace forcelayer::study
