// A verdict says the same on the terminal, in JSON, JUnit, GitHub, GitLab and as exit status.
#include "formats/command/verdict/verdict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>

#include "formats/command/verdict/hosts.h"

namespace forcelayer::command {
namespace {

using Known = VerdictDistance::Known;

std::size_t count(const std::string& text, const std::string& words) {
  std::size_t n = 0;
  for (std::size_t at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
    ++n;
  return n;
}

// Words with which a first sentence says no, written here a second time.
bool begins_with_a_no(const std::string& line) {
  for (const char* words :
       {"Does not keep the clearance", "Collides", "Does not come out", "Too close to call",
        "Undecided", "Never near the scene", "No path found", "Is held", "Penetrates", "Refused"}) {
    if (line.starts_with(words)) return true;
  }
  return false;
}
bool needs_force(const std::string& line) {
  return line.find(", if force overcomes its overlap with Plug ") != std::string::npos ||
         line.find(", and overlaps Plug ") != std::string::npos;
}
bool begins_with_a_yes(const std::string& line) {
  for (const char* words : {"Comes out", "Keeps the clearance", "Passes without a collision",
                            "Leaves its seat", "Is still in its seat"}) {
    if (line.starts_with(words)) return true;
  }
  return false;
}

// All kinds, each with every kind of distance and several numbers of slides, blockers and
// stretches.
std::vector<Verdict> many_verdicts() {
  std::mt19937 random(1);
  const auto up_to = [&](int n) { return std::uniform_int_distribution<int>(0, n)(random); };
  const auto length_m = [&] { return std::exp2(std::uniform_real_distribution(-20., 1.)(random)); };
  std::vector<Verdict> all;
  for (const VerdictKind kind : kAllVerdictKinds) {
    for (const Known known : {Known::kNot, Known::kAtLeast, Known::kProven, Known::kMeasured}) {
      for (int repeat = 0; repeat < 3; ++repeat) {
        Verdict v;
        v.kind = kind;
        v.required_m = repeat == 0 ? 0 : length_m();
        v.motion = repeat == 1 ? "" : "straight along +z";
        v.path_m = length_m();
        v.nearest = {known, length_m(), repeat == 1 ? "" : "a\nb<c>&\"", length_m()};
        for (int n = up_to(2); n > 0; --n) {
          v.slides.push_back({0, v.path_m * n / 3, {"Bolt", "Bolt[2]"}, {"Pin"}, length_m()});
        }
        for (int n = up_to(7); n > 0; --n)
          v.blocked_by.push_back("Bolt[" + std::to_string(n) + "]");
        if (up_to(1) == 1) v.finding = "meets Bolt[2], 50% deep";
        if (without_overlap(kind) != kind) {
          v.overlapped = {"Plug"};
          v.overlap_m = length_m();
        }
        if (repeat == 2) {  // of a run, which checks no clearance that was asked for
          v.is_asked = false;
          v.finding = "the hand pulled 60 mm, the part moved 37.1 mm";
        }
        v.advice = up_to(1) == 1 ? "give --seat 0,0,0m" : "";
        if (!is_yes(kind))
          v.more.resize(static_cast<std::size_t>(up_to(2)), "3 to 4 mm: meets a wall");
        v.notes.resize(static_cast<std::size_t>(up_to(2)), "a note");
        v.remarks.resize(static_cast<std::size_t>(up_to(2)), "it overlaps Bolt");
        all.push_back(v);
      }
    }
  }
  return all;
}

TEST(Verdict, AllReportsSayTheSame) {
  const Subject subject{"voxcheck", "part.pshell", "path.csv"};
  const auto all = many_verdicts();
  ASSERT_GE(all.size(), 50u);
  for (const Verdict& v : all) {
    const std::string first = sentence(v);
    SCOPED_TRACE(first);
    // A yes that needs force is none: each report and the status say so.
    const bool passes = begins_with_a_yes(first), yes = passes && !needs_force(first);
    ASSERT_NE(passes, begins_with_a_no(first));
    EXPECT_EQ(first.find('\n'), std::string::npos);
    EXPECT_TRUE(first.ends_with("."));

    const Status status = exit_of(v, "path.csv");
    EXPECT_EQ(yes, status.ok());
    if (!yes) {
      EXPECT_EQ(exit_status(status.error().code), passes ? 7 : 6);
      EXPECT_EQ(status.error().what, gist(v));
      EXPECT_EQ(status.error().mend, v.advice);
      // The line of an error and the sentence have the same words.
      const std::string head = gist(v).substr(0, gist(v).find(": "));
      EXPECT_TRUE(passes ? needs_force(head) : head == to_text(v.kind)) << gist(v);
      EXPECT_NE(first.find(gist(v).substr(head.size() + 2)), std::string::npos) << gist(v);
    }

    EXPECT_TRUE(terminal_text(v).starts_with(first + "\n"));
    EXPECT_EQ(heading(v) + ": " + explanation(v) + ".", first);
    EXPECT_NE(begins_with_a_yes(heading(v)), begins_with_a_no(heading(v)));
    EXPECT_EQ(begins_with_a_yes(heading(v)) && !needs_force(heading(v)), yes);

    const auto json = verdict_json(v);
    EXPECT_EQ(json["verdict"], yes ? "clear" : "not clear");
    EXPECT_EQ(json["sentence"], first);
    EXPECT_EQ(json["heading"], heading(v));
    EXPECT_EQ(json["kind"].get<std::string>().ends_with(" with overlap"), needs_force(first));
    EXPECT_EQ(json["required_clearance_m"], v.required_m);
    EXPECT_EQ(verdict_kind(json["kind"].get<std::string>()), v.kind);

    const std::string junit = junit_text(subject, v, 1.5);
    EXPECT_EQ(count(junit, yes ? "failures=\"0\"" : "failures=\"1\""), 1u);
    EXPECT_EQ(count(junit, "errors=\"0\""), 1u);
    EXPECT_EQ(count(junit, "<failure"), yes ? 0u : 1u);
    EXPECT_EQ(count(junit, "<system-out"), yes ? 1u : 0u);
    const std::string plain = heading(v);
    EXPECT_EQ(count(junit, plain), yes ? 1u : 2u);  // beside the message in the text too

    const std::string lines = annotations(subject, v);
    EXPECT_EQ(count(lines, "::error "), yes ? 0 : 1 + v.more.size());
    EXPECT_EQ(count(lines, "::warning "), v.remarks.size());
    EXPECT_EQ(count(lines, "::" + plain), yes ? 0u : 1u);

    std::size_t major = 0, minor = 0;
    bool is_said = false;
    for (const auto& issue : issues(subject, v)) {
      major += issue["severity"] == "major";
      minor += issue["severity"] == "minor";
      is_said |= issue["description"] == first;
    }
    EXPECT_EQ(major, yes ? 0 : 1 + v.more.size());
    EXPECT_EQ(minor, v.remarks.size());
    EXPECT_EQ(is_said, !yes);
  }
}

TEST(Verdict, EachKindHasWordsOfItsOwn) {
  std::set<std::string> words;
  for (const VerdictKind kind : kAllVerdictKinds) {
    words.insert(to_text(kind));
    EXPECT_EQ(verdict_kind(to_text(kind)), kind);
  }
  EXPECT_EQ(words.size(), std::size(kAllVerdictKinds));
  EXPECT_EQ(verdict_kind("clear"), VerdictKind::kUndecided);  // a word of no kind is no yes
}

TEST(Verdict, SaysWhatWasFoundInOneSentence) {
  Verdict v;
  v.kind = VerdictKind::kComesOut;
  v.required_m = 0.001;
  v.motion = "straight along +z";
  v.path_m = 0.06;
  v.slides = {{0, 0.0516, {}, {"A", "B"}, 96e-6}};
  v.nearest = {Known::kMeasured, 0.001523, "Clip/Half", 0.0516, 0.001523};
  EXPECT_EQ(sentence(v),
            "Comes out, straight along +z: passes A and B with a gap of 0.096 mm for the first "
            "51.6 mm, otherwise stays 1.523 mm away or more (measured to Clip/Half, after 51.6 of "
            "60 mm; 1 mm required).");
  // Where they touch, and where the meshes are less exact than the measurement.
  v.slides[0] = {0, 0.0516, {"A"}, {"B"}, 96e-6};
  v.nearest.proven_m = 0.0014;
  EXPECT_EQ(sentence(v),
            "Comes out, straight along +z: slides along A and passes B with a gap of 0.096 mm for "
            "the first 51.6 mm, otherwise stays 1.4 mm away or more (proven; "
            "nearest to Clip/Half, after 51.6 of 60 mm; 1 mm "
            "required).");
  // The distance is the least beside the slides, also just where one of them ends.
  v.slides[0].passed = {"B", "Clip/Half"};
  EXPECT_NE(sentence(v).find("otherwise stays 1.4 mm away or more (proven; nearest to Clip/Half, "),
            std::string::npos);
  v.nearest = {Known::kMeasured, 0.001523, "Post", 0.0516, 0.001523};
  // It moves off what it touches, or onto it, where the clearance is gained or lost within twice
  // its length. It may leave one thing soon while it slides along another.
  const auto says = [&](const VerdictSlide& slide, const std::string& words) {
    v.slides[0] = slide;
    EXPECT_NE(sentence(v).find(": " + words + ", otherwise stays"), std::string::npos)
        << sentence(v);
  };
  says({0, 0.0021, {"A"}, {"B"}, 96e-6},
       "slides along A and passes B with a gap of 0.096 mm for the first 2.1 mm");
  says({0, 0.0019, {"A"}, {"B"}, 96e-6},
       "leaves A and passes B with a gap of 0.096 mm within the first 1.9 mm");
  says({0.0581, 0.06, {"A"}, {}, 0}, "reaches A within the last 1.9 mm");
  says({0.0579, 0.06, {"A"}, {}, 0}, "slides along A for the last 2.1 mm");
  says({0, 0.0516, {"B"}, {}, 0, {"A"}, 0.002},
       "leaves A within the first 2 mm and slides along B for the first 51.6 mm");
  says({0.01, 0.06, {"B"}, {}, 0, {"A"}, 0.002},
       "reaches A within the last 2 mm and slides along B for the last 50 mm");
  says({0, 0.0516, {}, {"C"}, 96e-6, {"A"}, 0.002},
       "leaves A within the first 2 mm and passes C with a gap of 0.096 mm for the first 51.6 mm");
  says({0, 0.0019, {"B"}, {}, 0, {"A"}}, "leaves B and A within the first 1.9 mm");
  // A part that overlaps as installed comes out only by force: the first words say so.
  v.slides = {{0, 0.0516, {"A"}, {}, 0}};
  v.kind = VerdictKind::kComesOutWithOverlap;
  v.overlapped = {"A", "B"};
  v.overlap_m = 1.5e-4;
  EXPECT_EQ(heading(v),
            "Comes out, straight along +z, if force overcomes its overlap with A and B (at least "
            "0.15 mm when installed)");
  EXPECT_EQ(sentence(v).find(heading(v) + ": slides along A for the first 51.6 mm, otherwise"), 0u);
  v.slides.clear();
  v.kind = VerdictKind::kStaysWithOverlap;
  EXPECT_EQ(heading(v),
            "Is still in its seat, straight along +z, and overlaps A and B (at least 0.15 mm when "
            "installed)");
  v.kind = VerdictKind::kTooNear;
  EXPECT_EQ(heading(v), "Does not keep the clearance, straight along +z");
  v.overlapped.clear();
  v.nearest = {Known::kMeasured, 0.0009, "Clip/Half", 0.0516};
  EXPECT_EQ(sentence(v),
            "Does not keep the clearance, straight along +z: comes as near as 0.9 mm (measured to "
            "Clip/Half, after 51.6 of 60 mm; 1 mm required).");
  // The way out of the seat is no news behind what was found before its end.
  v.slides = {{0, 0.0517, {"Floor"}, {}, 0}};
  EXPECT_EQ(sentence(v),
            "Does not keep the clearance, straight along +z: comes as near as 0.9 mm (measured to "
            "Clip/Half, after 51.6 of 60 mm; 1 mm required).");
  v.kind = VerdictKind::kDoesNotComeOut;
  v.slides = {{0, 0.0424, {"Floor"}, {}, 0}};
  v.finding = "meets Wall, at least 0.2 mm deep";
  EXPECT_EQ(sentence(v),
            "Does not come out, straight along +z: gets 1 mm away from its seat after 42.4 mm, "
            "but meets Wall, at least 0.2 mm deep (after 51.6 of 60 mm; 1 mm required).");
  // Nothing that comes after the beginning of a collision matters.
  v.begin = {0.022, "too near"};
  EXPECT_EQ(sentence(v),
            "Does not come out, straight along +z: meets Wall, at least 0.2 mm deep (too near from "
            "22 mm on, worst after 51.6 of 60 mm).");
  // The object that the finding names is not named twice.
  v.nearest.object = "Wall";
  v.blocked_by = {"Post", "Wall"};
  EXPECT_EQ(sentence(v),
            "Does not come out, straight along +z: meets Wall, at least 0.2 mm deep (too near from "
            "22 mm on, worst after 51.6 of 60 mm); also blocked by Post.");
  v.blocked_by = {"Post"};
  EXPECT_NE(sentence(v).find("; blocked by Post."), std::string::npos);
  v.blocked_by = {"Wall"};
  EXPECT_EQ(sentence(v).find("blocked by"), std::string::npos);
  // Where the time was over there may be more.
  v.unchecked = "other objects may block it before";
  EXPECT_NE(sentence(v).find(" of 60 mm); other objects may block it before."), std::string::npos);
  EXPECT_NE(gist(v).find("; other objects may block it before"), std::string::npos);
  v.unchecked.clear();
  v.blocked_by.clear();
  v.begin.reset();
  v.slides[0].to_m = 0.06;
  v.kind = VerdictKind::kStaysInstalled;
  v.finding.clear();
  v.nearest = {Known::kAtLeast, 0.005, "", 0};
  EXPECT_EQ(
      sentence(v),
      "Is still in its seat, straight along +z: slides along Floor for the whole path of 60 mm, "
      "otherwise stays 5 mm away or more (nothing is nearer; 1 mm required).");
}

// A name of a long path is cut in the sentence, at one of its slashes, and nowhere else.
TEST(Verdict, NamesTheEndOfALongPath) {
  Verdict v;
  v.kind = VerdictKind::kDoesNotComeOut;
  v.required_m = 0.001;
  v.finding = "meets X";
  v.nearest.known = Known::kMeasured;
  const std::string end = "/Plate:1";
  v.blocked_by = {std::string(64 - end.size(), 'a') + end};
  EXPECT_NE(sentence(v).find("blocked by aaa"), std::string::npos);
  v.blocked_by = {"b/" + std::string(64 - end.size(), 'a') + end};
  EXPECT_NE(sentence(v).find("blocked by .../Plate:1."), std::string::npos) << sentence(v);
  v.blocked_by = {"b/" + std::string(65, 'a')};
  EXPECT_NE(sentence(v).find("blocked by .../aaa"), std::string::npos) << sentence(v);
  v.blocked_by = {std::string(65, 'a')};
  EXPECT_NE(sentence(v).find("blocked by aaa"), std::string::npos) << sentence(v);
  EXPECT_EQ(verdict_json(v)["blocked_by"][0], v.blocked_by[0]);
}

// The end of a name that a sentence shows means one object of the scene, and no shorter end does.
TEST(Verdict, ShowsTheShortestEndOfANameThatMeansOneObject) {
  std::mt19937 random(5);
  const auto pick = [&](int n) { return static_cast<int>(random() % n); };
  for (int scene = 0; scene < 300; ++scene) {
    std::set<std::string> all;
    for (int n = 0; n < 1 + pick(12); ++n) {
      std::string name;
      for (int depth = 1 + pick(4); depth > 0; --depth) {
        name += std::string(name.empty() ? "" : "/") + "ab"[pick(2)] + (pick(4) == 0 ? "b" : "");
      }
      all.insert(name);
    }
    const std::vector<std::string> names(all.begin(), all.end());
    const auto meant = [&](const std::string& end) {
      return std::count_if(names.begin(), names.end(), [&](const std::string& name) {
        return name == end || name.ends_with("/" + end);
      });
    };
    for (const std::string& name : names) {
      const std::string shown = short_name(name, names);
      ASSERT_TRUE(name == shown || name.ends_with("/" + shown)) << name << ": " << shown;
      // A whole name means its object, whatever others end with.
      EXPECT_TRUE(shown == name || meant(shown) == 1) << name << ": " << shown;
      if (const auto slash = shown.find('/'); slash != std::string::npos) {
        EXPECT_GT(meant(shown.substr(slash + 1)), 1) << name << ": " << shown;
      }
    }
  }
  EXPECT_EQ(short_name("Engine/Bolt", std::vector<std::string>{"Engine/Bolt", "Engine/Bolt[2]"}),
            "Bolt[1]");
  // The whole name has the same number, and a name that has one gets no other.
  EXPECT_EQ(numbered_name("Engine/Bolt", std::vector<std::string>{"Engine/Bolt", "Engine/Bolt[2]"}),
            "Engine/Bolt[1]");
  EXPECT_EQ(
      short_name("Engine/Bolt[1]", std::vector<std::string>{"Engine/Bolt[1]", "Engine/Bolt[2]"}),
      "Bolt[1]");
  EXPECT_EQ(short_name("Engine/Bolt[2]", std::vector<std::string>{"Engine/Bolt", "Engine/Bolt[2]"}),
            "Bolt[2]");
}

// A sentence never says that one figure equals another that it does not equal, nor turns them
// round.
TEST(Verdict, UnequalLengthsHaveUnequalTexts) {
  std::mt19937 random(2);
  const auto mm_of = [](const std::string& text) { return std::stold(text); };
  const auto hold = [&](double a_m, double b_m) {
    const auto [a, b] = length_texts(a_m, b_m);
    SCOPED_TRACE(a + " and " + b);
    EXPECT_EQ(a == b, a_m == b_m);
    EXPECT_EQ(mm_of(a) < mm_of(b), a_m < b_m);
  };
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const double a_m = std::exp2(std::uniform_real_distribution(-25., 6.)(random));
    hold(a_m, a_m);
    for (const double by : {1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.1}) {
      hold(a_m, a_m * (1 + by));
      hold(a_m * (1 + by), a_m);
    }
    hold(a_m, std::nextafter(a_m, 1e9));
    const double than_m = a_m * 1.0001;
    EXPECT_LT(mm_of(upper_length_text(a_m, than_m)), 1e3 * than_m);
    EXPECT_GE(mm_of(upper_length_text(a_m, than_m)), 1e3 * a_m * (1 - 1e-9));
  }
  // A bound is never stated tighter than it is, and a decimal number stays as it is.
  for (int repeat = 0; repeat < 2000; ++repeat) {
    const double a_m = std::exp2(std::uniform_real_distribution(-25., 6.)(random));
    EXPECT_GE(mm_of(at_most_text(a_m)), 1e3 * a_m * (1 - 1e-12)) << at_most_text(a_m);
    EXPECT_LE(mm_of(length_text(a_m)), 1e3 * a_m * (1 + 1e-12)) << length_text(a_m);
    EXPECT_EQ(bounds_text(a_m / 2, a_m),
              "at least " + length_text(a_m / 2) + " and at most " + at_most_text(a_m));
  }
  EXPECT_EQ(bounds_text(0.0003, 0.0004571), "at least 0.3 mm and at most 0.458 mm");
  EXPECT_EQ(bounds_text(0.0003, INFINITY), "at least 0.3 mm");
  EXPECT_EQ(at_most_text(0.000458), "0.458 mm");
  EXPECT_EQ(length_texts(7.5e-6, 7.6e-6),
            (std::pair<std::string, std::string>("0.0075 mm", "0.0076 mm")));
  EXPECT_EQ(length_text(0.0127), "12.7 mm");
  EXPECT_EQ(length_text(0.06), "60 mm");
  EXPECT_EQ(length_text(0.0012349), "1.234 mm");  // no larger than it is
  EXPECT_EQ(length_text(0), "0 mm");
  EXPECT_EQ(length_text(4e-8), "0.00004 mm");
  // A small length has three digits, each bound rounded to its safe side.
  EXPECT_EQ(length_text(4.998e-5), "0.0499 mm");
  EXPECT_EQ(at_most_text(4.998e-5), "0.05 mm");
  EXPECT_EQ(at_most_text(4.981e-5), "0.0499 mm");
  EXPECT_EQ(length_text(9.8e-5), "0.098 mm");
  EXPECT_EQ(length_text(1.23456e-6), "0.00123 mm");
  EXPECT_EQ(length_text(1.23456e-4), "0.123 mm");
  EXPECT_EQ(bounds_text(4.998e-5, 9.8761e-5), "at least 0.0499 mm and at most 0.0988 mm");
  for (int repeat = 0; repeat < 2000; ++repeat) {  // no more than a hundredth is rounded away
    const double a_m = std::exp2(std::uniform_real_distribution(-25., 6.)(random));
    EXPECT_GE(mm_of(length_text(a_m)), 1e3 * a_m * 0.99) << length_text(a_m);
    EXPECT_LE(mm_of(at_most_text(a_m)), 1e3 * a_m * 1.011) << at_most_text(a_m);
  }
}

}  // namespace
}  // namespace forcelayer::command
