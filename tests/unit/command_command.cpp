// The habits of all commands: exit status, one line on stderr, reports, signals.
#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/output_file.h"
#include "formats/command/report.h"
#include "formats/command/version.h"

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
#include "formats/command/spelling/spelling.h"
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

TEST(Provenance, HasTheDeclaredDeviation) {
  using command::mesh_deviation_in;
  EXPECT_EQ(mesh_deviation_in(R"({"mesh_deviation_m": 0.25})"), 0.25);
  for (const char* none : {"", "[]", "{}", R"({"mesh_deviation_m": "1"})"}) {
    EXPECT_EQ(mesh_deviation_in(none), std::nullopt) << none;
  }
}

TEST(Provenance, HasTheHashesOfTheMeshes) {
  using command::object_hashes_in, command::part_hash_in;
  using Hashes = std::vector<std::string>;
  EXPECT_EQ(object_hashes_in(R"({"parts": [{"xxh128": "ab"}, {"xxh128": "cd"}]})"),
            (Hashes{"ab", "cd"}));
  for (const char* none :
       {"", "[]", "{", "7", R"({"parts": 3})", R"({"parts": ["xxh128"]})",
        R"({"parts": [{"xxh128": "ab"}, {"name": "x"}]})", R"({"parts": [{"xxh128": 5}]})"}) {
    EXPECT_EQ(object_hashes_in(none), Hashes()) << none;
  }
  EXPECT_EQ(part_hash_in(R"({"part_xxh3": "ab"})"), "ab");
  for (const char* none : {"", "[1]", "{}", R"({"part_xxh3": 1})"}) {
    EXPECT_EQ(part_hash_in(none), "") << none;
  }
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

// A text's author does not decide what a terminal does with it.
TEST(Escaped, WhatATerminalDoesNotShowInItsPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {"plain, \xc3\xa4 \xe6\xbc\xa2 \xf0\x9f\x98\x80",
       "plain, \xc3\xa4 \xe6\xbc\xa2 \xf0\x9f\x98\x80"},
      {"\x1b[2J\n\x7f", "\\x1b[2J\\x0a\\x7f"},
      {"\xc2\x85\xc2\x9b"
       "31m",
       "\\xc2\\x85\\xc2\\x9b"
       "31m"},                                     // C1: next line, control sequence
      {"\xc2\xa0|\xc2\xa1", "\xc2\xa0|\xc2\xa1"},  // the first characters that may be printed
      {"\xe2\x80\xa8\xe2\x80\xa9", "\\xe2\\x80\\xa8\\xe2\\x80\\xa9"},  // U+2028, U+2029
      {"\xe2\x80\xae"
       "gpj.exe",
       "\\xe2\\x80\\xae"
       "gpj.exe"},  // U+202E
      {"\xe2\x81\xa6\xe2\x80\x8f\xd8\x9c", "\\xe2\\x81\\xa6\\xe2\\x80\\x8f\\xd8\\x9c"},
      {"a\xc2\xad\xe2\x80\x8b\xe2\x81\xa0\xef\xbb\xbf\xef\xbf\xb9\xf3\xa0\x81\x81",
       "a\\xc2\\xad\\xe2\\x80\\x8b\\xe2\\x81\\xa0\\xef\\xbb\\xbf\\xef\\xbf\\xb9\\xf3\\xa0\\x81\\x8"
       "1"},                                                     // unseen
      {"\xe2\x80\x8c\xe2\x80\x8d", "\xe2\x80\x8c\xe2\x80\x8d"},  // joiners
      {"\x9b"
       "31m \xff",
       "\\x9b"
       "31m \\xff"},                                 // no UTF-8: C1 in Latin-1
      {"\xc3", "\\xc3"},                             // cut off
      {"\xc0\x8a", "\\xc0\\x8a"},                    // a line end, written too long
      {"\xe0\x82\x85", "\\xe0\\x82\\x85"},           // the same of C1
      {"\xed\xa0\x80", "\\xed\\xa0\\x80"},           // a surrogate
      {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"},  // beyond the last character
      {"a\xef\xbf\xbe\xef\xbf\xbf\xf0\x9f\xbf\xbe\xef\xb7\x90",
       "a\\xef\\xbf\\xbe\\xef\\xbf\\xbf\\xf0\\x9f\\xbf\\xbe\\xef\\xb7\\x90"},  // none at all
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
  const std::string commit = command::commit();
  EXPECT_EQ(version.out, std::string("tool ") + command::kVersion +
                             (commit.empty() ? "" : " (commit " + commit + ")") + "\n");
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

TEST(ParseArguments, NamesTheOptionThatWasMeant) {
  const std::pair<const char*, const char*> meant[] = {{"--nubmer", "did you mean --number?"},
                                                       {"--speeed=3", "did you mean --speed?"},
                                                       {"--velocity", "see tool --help"},
                                                       {"-x", "see tool --help"}};
  for (const auto& [typed, mend] : meant) {
    EXPECT_NE(parse({"--number", "1", typed}).err.find(mend), std::string::npos) << typed;
  }
}

TEST(ParseArguments, HelpFitsAndIsGrouped) {
  CLI::App app{
      "A tool whose description is long enough to be wrapped, which it is where a line of it "
      "would be wider than a hundred columns",
      "tool"};
  std::string text, choice;
  std::vector<std::string> many;
  int number = 0;
  bool quiet = false;
  app.add_option("INPUT", many, "files")->required();
  app.add_option("--text", text, std::string(40, 'a') + " " + std::string(60, 'b'));
  app.add_option("--choice", choice, "one of two")->check(CLI::IsMember({"left", "right"}));
  app.add_option("--number", number, "a number")->check(CLI::Range(1, 9));
  app.add_flag("--quiet", quiet, "print nothing but errors");
  command::arrange_help(app, {{"What", {"--text"}}}, "  tool x");
  EXPECT_THROW(command::arrange_help(app, {{"What", {"--none"}}}, ""), std::logic_error);
  command::wrap_help(app);
  const std::string help = app.help();
  std::stringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
  const std::string want[] = {"\nWhat:\n  --text TEXT ", "\n  --choice left|right ",
                              "\n  --number N ", "a number (1 to 9)\n", "\nExamples:\n  tool x\n"};
  for (const std::string& part : want) EXPECT_NE(help.find(part), std::string::npos) << help;
  EXPECT_LT(help.find("\nOptions:"), help.find("\nEvery command:"));
  EXPECT_EQ(help.find('\x1b'), std::string::npos) << "colors without a terminal";
}

TEST(Help, NamesADefaultThatCli11Knows) {
  CLI::App app{"Draws", "tool"};
  std::string focus = "auto", text;
  app.add_option("--focus", focus, "what fills the picture")->capture_default_str();
  app.add_option("--text", text, "words");
  command::wrap_help(app);
  EXPECT_NE(app.help().find("what fills the picture, default auto\n"), std::string::npos);
  EXPECT_NE(app.help().find("words\n"), std::string::npos) << app.help();
}

TEST(Help, KnowsWhichSubcommandWasMeant) {
  const test::ScratchFolder folder;
  CLI::App app{"Looks", "tool"};
  app.add_subcommand("verify", "looks closely");
  app.add_subcommand("path", "measures");
  EXPECT_EQ(command::meant_subcommand(app, "verfy"), "did you mean verify?");
  EXPECT_EQ(command::meant_subcommand(app, "verify"), "");
  EXPECT_EQ(command::meant_subcommand(app, "pth"), "did you mean path?");
  EXPECT_EQ(command::meant_subcommand(app, "bay"), "") << "two letters of three";
  EXPECT_EQ(command::meant_subcommand(app, "verfy.vox"), "");
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  std::ofstream("verfy") << "a file";
  EXPECT_EQ(command::meant_subcommand(app, "verfy"), "");
  std::filesystem::current_path(before);
}

TEST(Spelling, OrdersByLettersChanged) {
  EXPECT_EQ(command::spelling_distance("", "abc"), 3u);
  EXPECT_EQ(command::spelling_distance("josn", "json"), 1u);
  EXPECT_EQ(command::spelling_distance("kitten", "sitting"), 3u);
  command::NearestNames nearest("Bold");
  EXPECT_EQ(nearest.text("see --help"), "see --help");
  for (const char* const path : {"Lid/Cover", "Lid/Bolt", "Pin", "Lid", "Housing", "Clip"}) {
    nearest.add(path);
  }
  EXPECT_TRUE(nearest.text().starts_with("the nearest names are: Lid/Bolt, ")) << nearest.text();
  EXPECT_EQ(nearest.text().find("Housing"), std::string::npos) << "more than five";
}

TEST(Spelling, LeavesTheNumberOfAFirstSiblingOut) {
  EXPECT_EQ(command::without_first_numbers("A[1]/B[2]/C[1]"), "A/B[2]/C");
  for (const char* const name : {"", "/", "A", "A/B[2]", "[1]", "A[1]B", "A/", "A[11]"}) {
    EXPECT_EQ(command::without_first_numbers(name), name);
  }
}

// The pace is that since `begun`, whatever came before.
TEST(ProgressLine, TellsTheTimeLeftFromATenthOn) {
  EXPECT_FALSE(command::time_left_s(1, 0, 0));
  EXPECT_FALSE(command::time_left_s(1, 0, 0.099));
  EXPECT_NEAR(*command::time_left_s(1, 0, 0.25), 3, 1e-12);
  EXPECT_FALSE(command::time_left_s(1, 0.2, 0.27));
  EXPECT_NEAR(*command::time_left_s(1, 0.2, 0.4), 3, 1e-12);
  EXPECT_EQ(*command::time_left_s(5, 0.2, 1), 0);
}

TEST(Report, HasTheCommonHeadAndTheFailure) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "in.vox") << "abc";
  std::string path = folder / "report.json";
  const std::string inputs[] = {(folder / "in.vox").string() + "#Node", (folder / "none").string()};
  const command::OutputFile outputs[] = {{"--json", &path, command::FileKind::kReport}};
  const auto read = [&] { return nlohmann::json::parse(std::ifstream(path)); };
  ASSERT_TRUE(command::prepare_outputs(outputs, inputs));
  ASSERT_TRUE(command::write_report(path, {{"answer", 42}, {"warnings", {"w"}}}));
  nlohmann::json report = read();
  EXPECT_EQ(report["schema_version"], 1);
  EXPECT_EQ(report["tool_version"], command::kVersion);
  EXPECT_EQ(report["exit_status"], 0);
  EXPECT_EQ(report["answer"], 42);
  EXPECT_EQ(report["warnings"][0], "w");
  EXPECT_EQ(report["input_files"][0]["path"], (folder / "in.vox").string());
  EXPECT_EQ(report["input_files"][0]["xxh3"], "78af5f94892f3950");  // XXH3 of "abc"
  EXPECT_TRUE(report["input_files"][1]["xxh3"].is_null());
  const Error error{ErrorCode::kAnswerIsNo, "f", "w", "no", "mend"};
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(command::run_command("tool", [&] { return Status(error); }), 6);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "tool: f: w: no; mend\n");
  report = read();
  EXPECT_EQ(report["exit_status"], 6);
  EXPECT_EQ(report["answer"], 42) << "what was reported before stays";
  EXPECT_EQ(report["error"]["line"], "f: w: no; mend");
  command::begin_report("", {});
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
