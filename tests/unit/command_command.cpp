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

#include "formats/command/progress_line.h"
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

struct ParseOutcome {
  bool parsed;
  int status;
  std::string out, err;
};

ParseOutcome parse(std::vector<std::string> words) {
  CLI::App app{"A tool", "tool"};
  int number = 0;
  app.add_option("--number", number, "a number")->required();
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
  EXPECT_EQ(help.err, "");
  const ParseOutcome version = parse({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_EQ(version.out, std::string("tool ") + command::kVersion + "\n");
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"--number"},
                                                       {"--number", "x"},
                                                       {"--number", "1", "--color"},
                                                       {"--number", "1", "extra"}};
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
