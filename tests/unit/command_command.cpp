// The habits of all commands: exit status, one line on stderr, reports, signals.
#include "formats/command/command.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "formats/command/arguments.h"
#include "formats/command/progress_line.h"
#include "formats/command/provenance.h"
#include "formats/file/atomic_file.h"
#include "formats/result.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer {
namespace {

namespace fs = std::filesystem;

TEST(ErrorLine, IsOneLineWithFilePlaceReasonAndMend) {
  const Error error{ErrorCode::kMeshUnreadable, "part.stl", "line 7", "no number", "write one"};
  EXPECT_EQ(to_line(error), "part.stl: line 7: no number; write one");
  EXPECT_EQ(to_line({ErrorCode::kUsage, "", "", "what", ""}), "what");
  EXPECT_EQ(to_line({ErrorCode::kUsage, "a\nb\x1b[31m\x7f", "", "c\td", ""}),
            "a\\x0ab\\x1b[31m\\x7f: c\\x09d");
}

TEST(Provenance, CountsMissingFacesOfWhateverStandsThere) {
  using command::missing_faces_in;
  EXPECT_EQ(missing_faces_in(R"({"missing_faces": [{"node": "a", "size": [1, 2]}, {}]})"), 2u);
  EXPECT_EQ(missing_faces_in(R"({"a": {"missing_faces": [1]}, "missing_faces": [[1, 2], 3, "x"]})"),
            3u);
  EXPECT_EQ(missing_faces_in(R"({"missing_faces": [1, 2], "missing_faces": {"a": [1]}})"), 0u);
  for (const char* none :
       {"", "{}", "[]", "7", R"({"missing_faces": []})", R"({"missing_faces": 3})",
        R"([{"missing_faces": [1]}])", R"(["missing_faces", [1]])", R"({"missing_faces": [1,2)"}) {
    EXPECT_EQ(missing_faces_in(none), 0u) << none;
  }
  std::string deep = R"({"missing_faces": [)" + std::string(100'000, '[');
  EXPECT_EQ(missing_faces_in(deep), 0u);
  deep += std::string(100'000, ']') + "]}";
  EXPECT_EQ(missing_faces_in(deep), 1u);
}

TEST(ErrorCodes, ExitStatusIsTheHundreds) {
  EXPECT_EQ(exit_status(ErrorCode::kFileNotFound), 1);
  EXPECT_EQ(exit_status(ErrorCode::kUsage), 2);
  EXPECT_EQ(exit_status(ErrorCode::kBakeTooLarge), 3);
  EXPECT_EQ(exit_status(ErrorCode::kChecksumMismatch), 4);
  EXPECT_EQ(exit_status(ErrorCode::kDeviceFailed), 5);
}

// Runs a body and gives its status and what it wrote to stderr.
std::pair<int, std::string> outcome_of(const std::function<Status()>& body) {
  ::testing::internal::CaptureStderr();
  const int status = command::run_command("tool", body);
  return {status, ::testing::internal::GetCapturedStderr()};
}

TEST(RunCommand, TurnsOutcomesIntoStatusAndOneLine) {
  EXPECT_EQ(outcome_of([] { return Status(); }), std::pair(0, std::string()));
  EXPECT_EQ(outcome_of([]() -> Status {
              return Error{ErrorCode::kMeshEmpty, "a.stl", "", "no triangles", ""};
            }),
            std::pair(3, std::string("tool: a.stl: no triangles\n")));
  EXPECT_EQ(outcome_of([]() -> Status { throw std::runtime_error("two\nlines"); }),
            std::pair(1, std::string("tool: two\\x0alines\n")));
  EXPECT_EQ(outcome_of([]() -> Status { throw 7; }),
            std::pair(1, std::string("tool: unknown exception\n")));
  const auto [status, text] = outcome_of([]() -> Status { throw std::bad_alloc(); });
  EXPECT_EQ(status, 1);
  EXPECT_EQ(text.rfind("tool: out of memory", 0), 0u);
}

// What a terminal would do with a text is not left to who wrote the text.
TEST(Escaped, WhatATerminalDoesNotShowInItsPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {"plain, \xc3\xa4 \xe6\xbc\xa2 \xf0\x9f\x98\x80",
       "plain, \xc3\xa4 \xe6\xbc\xa2 \xf0\x9f\x98\x80"},
      {"\x1b[2J\n\x7f", "\\x1b[2J\\x0a\\x7f"},
      {"\xc2\x85\xc2\x9b"
       "31m",
       "\\xc2\\x85\\xc2\\x9b"
       "31m"},                                     // C1: next line, control sequence
      {"\xc2\xa0|\xc2\xa1", "\xc2\xa0|\xc2\xa1"},  // the first that are none
      {"\xe2\x80\xa8\xe2\x80\xa9", "\\xe2\\x80\\xa8\\xe2\\x80\\xa9"},  // U+2028, U+2029
      {"\xe2\x80\xae"
       "gpj.exe",
       "\\xe2\\x80\\xae"
       "gpj.exe"},  // U+202E
      {"\xe2\x81\xa6\xe2\x80\x8f\xd8\x9c", "\\xe2\\x81\\xa6\\xe2\\x80\\x8f\\xd8\\x9c"},
      {"\x9b"
       "31m \xff",
       "\\x9b"
       "31m \\xff"},                                 // no UTF-8: C1 in Latin-1
      {"\xc3", "\\xc3"},                             // cut off
      {"\xc0\x8a", "\\xc0\\x8a"},                    // a line end, written too long
      {"\xe0\x82\x85", "\\xe0\\x82\\x85"},           // the same of C1
      {"\xed\xa0\x80", "\\xed\\xa0\\x80"},           // a surrogate
      {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"},  // beyond the last character
  };
  for (const auto& [text, shown] : cases) EXPECT_EQ(escaped(text), shown);
  EXPECT_EQ(escaped(std::string_view("a\0b", 3)), "a\\x00b");
  EXPECT_EQ(to_line({ErrorCode::kUsage, "\xe2\x80\xae", "", "\xc2\x9b", ""}),
            "\\xe2\\x80\\xae: \\xc2\\x9b");
}

struct ParseOutcome {
  bool parsed;
  int status;
  std::string out, err;
};

ParseOutcome parse(std::vector<std::string> words) {
  CLI::App app{"A tool", "tool"};
  int number = 0;
  double speed = 0;
  app.add_option("--number", number, "a number")->required();
  command::add_number(app, "--speed", speed, "of a hand", {0.5, 10});
  std::vector<char*> argv;
  words.insert(words.begin(), "tool");
  for (auto& word : words) argv.push_back(word.data());
  ParseOutcome outcome{};
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  outcome.parsed =
      command::parse_arguments(app, static_cast<int>(argv.size()), argv.data(), outcome.status);
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.err = ::testing::internal::GetCapturedStderr();
  return outcome;
}

TEST(ParseArguments, HelpVersionAndWrongUsage) {
  EXPECT_TRUE(parse({"--number", "4"}).parsed);
  const ParseOutcome help = parse({"--help"});
  EXPECT_FALSE(help.parsed);
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.out.find("--number"), std::string::npos);
  EXPECT_NE(help.out.find("of a hand (0.5 to 10)"), std::string::npos) << help.out;
  EXPECT_TRUE(parse({"--number", "4", "--speed", "0.5"}).parsed);
  EXPECT_EQ(help.err, "");
  const ParseOutcome version = parse({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_EQ(version.out, std::string("tool ") + command::kVersion + "\n");
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"--number"},
                                                       {"--number", "x"},
                                                       {"--number", "1", "--color"},
                                                       {"--number", "1", "extra"},
                                                       {"--number", "1", "--speed", "nan"},
                                                       {"--number", "1", "--speed", "inf"},
                                                       {"--number", "1", "--speed", "1e400"},
                                                       {"--number", "1", "--speed", "10.1"},
                                                       {"--number", "1", "--speed", "0.4"},
                                                       {"--number", "1", "--speed", "-1"},
                                                       {"--number", "1", "--speed", "5mm"},
                                                       {"--number", "1", "--speed="}};
  for (const auto& words : wrong) {
    const ParseOutcome outcome = parse(words);
    EXPECT_FALSE(outcome.parsed);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_EQ(outcome.err.rfind("tool: ", 0), 0u) << outcome.err;
  }
}

TEST(Report, IsIndentedJsonAndNeverFailsOnBadText) {
  const test::ScratchFolder folder;
  const std::string path = folder / "report.json";
  nlohmann::ordered_json report;
  report["b"] = 1;
  report["a"] = "not UTF-8: \xff";
  ASSERT_TRUE(command::write_report(path, report));
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), "{\n  \"b\": 1,\n  \"a\": \"not UTF-8: \xef\xbf\xbd\"\n}\n");
  const Status failed = command::write_report(folder / "missing/report.json", report);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kWriteFailed);
}

// A child that is writing when a signal comes: its status, and what is left in the folder.
void expect_clean_end(int number) {
  SCOPED_TRACE(number);
  const test::ScratchFolder folder;
  std::ofstream(folder / "scene.vox") << "old";
  const pid_t child = ::fork();
  if (child == 0) {
    command::exit_cleanly_on_signals();
    auto first = AtomicFile::create(folder / "scene.vox");
    auto second = AtomicFile::create(folder / "part.pshell");
    if (!first || !second || test::entries_of(folder.path()) != 3) ::_exit(1);
    ::raise(number);
    ::_exit(2);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + number);
  EXPECT_EQ(test::entries_of(folder.path()), 1);
  std::stringstream text;
  text << std::ifstream(folder / "scene.vox").rdbuf();
  EXPECT_EQ(text.str(), "old");
}

TEST(Signals, EndWithTheirStatusAndLeaveNoTemporaryFile) {
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) expect_clean_end(number);
}

TEST(Signals, AnIgnoredSignalStaysIgnored) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGINT, SIG_IGN);
    command::exit_cleanly_on_signals();
    ::raise(SIGINT);
    ::_exit(7);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 7);
}

TEST(ProgressLine, IsSilentWithoutATerminal) {
  ::testing::internal::CaptureStderr();
  {
    command::ProgressLine progress(false);
    progress.show("baking", 0.5);
    progress.clear();
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace forcelayer
