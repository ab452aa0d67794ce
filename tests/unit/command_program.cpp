#include "formats/command/program.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

namespace forcelayer {
namespace {

TEST(RunProgram, GivesInputAndTakesOutput) {
  const auto end = command::run_program("cat", {}, "some text", command::ProgramOutput::kTaken, "");
  ASSERT_TRUE(end) << to_line(end.error());
  EXPECT_EQ(end->status, 0);
  EXPECT_EQ(end->output, "some text");
}

// The input then gets the number of the standard input itself.
TEST(RunProgram, GivesInputWhereItsOwnIsClosed) {
  const int standard_input = dup(STDIN_FILENO);
  close(STDIN_FILENO);
  const auto end = command::run_program("cat", {}, "some text", command::ProgramOutput::kTaken, "");
  dup2(standard_input, STDIN_FILENO);
  close(standard_input);
  ASSERT_TRUE(end) << to_line(end.error());
  EXPECT_EQ(end->status, 0);
  EXPECT_EQ(end->output, "some text");
}

// A signal between fork and exec ends the child: noted by the handler of its parent, it would be
// lost and the program would run to its end.
TEST(RunProgram, IsStoppedBeforeItsProgramStarts) {
  const pid_t runner = fork();
  if (runner == 0) {
    pthread_atfork(nullptr, nullptr, [] { raise(SIGTERM); });
    command::stop_programs_on_signals();
    const auto end = command::run_program("cat", {}, "", command::ProgramOutput::kTaken, "");
    _exit(end ? end->status : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(runner, &status, 0), runner);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 128 + SIGTERM);
}

TEST(RunProgram, NamesThePackageOfOneThatIsMissing) {
  const auto end = command::run_program("no-such-program", {}, "", command::ProgramOutput::kTaken,
                                        "forcelayer-x");
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, ErrorCode::kFileNotFound);
}

// A study has options of its own: of advice, the parts that name others are left out.
TEST(Program, LeavesOutAdviceAboutOptionsThatItsUserDoesNotHave) {
  const std::string text =
      "the part touches A; check --start and --units; use --voxel-size 1m or more, or --roi, or "
      "bake anew (--seat)";
  ASSERT_EQ(::unsetenv("FORCELAYER_OPTIONS"), 0);
  EXPECT_EQ(command::with_known_options(text), text);
  EXPECT_FALSE(command::leaves_errors());
  command::take_errors({"--units", "--voxel-size", "--seat"});
  EXPECT_EQ(command::with_known_options(text),
            "the part touches A; use --voxel-size 1m or more, or bake anew (--seat)");
  EXPECT_EQ(command::with_known_options("check --start; or --seat-depth"),
            "");  // no option by its beginning
  EXPECT_EQ(command::with_known_options(""), "");
  EXPECT_FALSE(command::leaves_errors());  // it is the one that takes them
  ::unsetenv("FORCELAYER_OPTIONS");
}

}  // namespace
}  // namespace forcelayer
