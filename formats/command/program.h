// Another program of this project, started by one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::command {

enum class ProgramOutput { kTaken, kShown };

struct ProgramEnd {
  int status = 0;      // its exit status; 128+n on signal n
  std::string output;  // what it wrote to the standard output, where that was taken
};

// Where a program of this project stands: beside the running one, else, in PATH; empty where it is
// in neither.
std::string program_path(const std::string& name);

// From here on the first SIGINT, SIGTERM or SIGHUP does not end this process: it ends the program
// that run_program() waits for, and stop_signal() names it. run_program() then starts nothing more.
// A later signal ends the process. A signal that the caller ignores stays ignored.
void stop_programs_on_signals();

// From here on this program, and those that it starts, do not print a warning that one of them has
// printed already. Where the system gives no memory for that, they print all.
void share_warnings();

// Whether none of them has printed this warning: from now on, one has. True where none are shared.
bool is_new_warning(const std::string& text);

// From here on the programs that this one starts leave an error that they have written into their
// report of --json to this one, and do not print it. Their warnings name only these `options`
// ("--seat"), which are the ones that this program's user can give.
void take_errors(const std::vector<std::string>& options);

// Whether the program that started this one takes its errors.
bool leaves_errors();

// The text without the parts that name an option which that program, or this one if it takes
// errors, does not have. Parts are divided by "; " and ", or ".
std::string with_known_options(const std::string& text);

// Runs the program to its end; it is sent SIGTERM if this one ends before. `input` is its standard
// input; without one it reads this one's. Its standard error is this one's.
// Errors: kFileNotFound, with `package` as the mend, where it is not installed; kInternal where the
// system refuses to start it.
Result<ProgramEnd> run_program(const std::string& name, const std::vector<std::string>& arguments,
                               const std::optional<std::string>& input, ProgramOutput output,
                               const std::string& package);

}  // namespace forcelayer::command
