#include "formats/command/program.h"

#include <gtest/gtest.h>
#include <unistd.h>

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

TEST(RunProgram, NamesThePackageOfOneThatIsMissing) {
  const auto end = command::run_program("no-such-program", {}, "", command::ProgramOutput::kTaken,
                                        "forcelayer-x");
  ASSERT_FALSE(end);
  EXPECT_EQ(end.error().code, ErrorCode::kFileNotFound);
}

}  // namespace
}  // namespace forcelayer
