// The help of a command: options in groups, examples, lines that fit on a terminal.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace forcelayer::command {

inline constexpr std::size_t kHelpColumns = 100;

// Options that stand under one heading, by the names that begin with "--" or "-".
struct HelpGroup {
  const char* title;
  std::vector<const char*> options;
};

// Puts options under headings, in this order, and examples at the end, a line each. Options that
// are in no group stand under "Options"; --json, --quiet, --help and --version under a heading of
// their own. A name that is no option is a bug: std::logic_error.
void arrange_help(CLI::App& app, std::initializer_list<HelpGroup> groups,
                  const std::string& examples);

// Puts a table before the examples of the help. `rows`: "NAME\tMEANING\n" each.
void add_help_table(CLI::App& app, const char* title, std::string_view rows);

// Makes --help of `app` and its subcommands wrap at kHelpColumns, with bounds and choices in words,
// headings bold on a terminal.
void wrap_help(CLI::App& app);

// "did you mean --voxel-size?": of the arguments that were not expected, the first that is spelled
// like an option of `app` or of the subcommand in use; empty where none is.
std::string did_you_mean(const CLI::App& app);

// "did you mean verify?": where `word`, the first argument, names no file and is spelled nearly
// like a subcommand of `app`; empty where not.
std::string meant_subcommand(const CLI::App& app, const char* word);

// Whether what is written to this file descriptor may have colors: it is a terminal that has them,
// and the user did not set NO_COLOR (no-color.org).
bool wants_color(int descriptor);

}  // namespace forcelayer::command
