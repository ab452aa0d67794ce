// The command line: its parsing, and the kinds of options that several commands have. Sources that
// declare options by these alone need not compile CLI11.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>

#include "formats/command/quantity.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace forcelayer::command {

// The help of --units.
inline constexpr char kUnitsHelp[] =
    "unit of the meshes (nm, um, mm, cm, dm, m, km, in, ft, yd): required if their format has no "
    "unit. It replaces the unit of a format that has one";

// A command's parser of its command line.
std::shared_ptr<CLI::App> make_app(const char* description, const char* name, const char* footer);

// Parses argv into `app`; --help and --version print and end with status 0 (returns false with
// `exit_code` 0), a wrong command line gives one line on stderr and status 2. The line of an option
// that has another name now says so (old_options.h).
bool parse_arguments(CLI::App& app, int argc, char** argv, int& exit_code);

// The same for an app with subcommands: a first argument that is no file, but spelled nearly like
// one of them, is a wrong command line.
bool parse_subcommands(CLI::App& app, int argc, char** argv, int& exit_code);

// The functions below declare options of a command. They are no templates and take texts as they
// stand in the source, so that a call takes few bytes: a command has some sixty.

// Declares an option that takes a number within `bounds`, which its help names, and hands it to
// `take`. What is not finite or outside is a wrong command line (quantity.h: parse_number).
CLI::Option* add_number(CLI::App& app, const char* name, const std::string& help,
                        const Bounds& bounds, std::function<void(double)> take);

// The same into a variable. Its help names the value so far as the default, where that is a number
// other than 0.
CLI::Option* add_number(CLI::App& app, const char* name, double& value, const char* help,
                        const Bounds& bounds);
CLI::Option* add_number(CLI::App& app, const char* name, std::optional<double>& value,
                        const char* help, const Bounds& bounds);

// Declares an option that takes a whole number from `smallest` to `largest`.
CLI::Option* add_count(CLI::App& app, const char* name, unsigned& count, const char* help,
                       int smallest, int largest);

// A size in bytes, such as 2GiB, from `smallest` to `largest`. Errors: kUsage.
Result<std::uint64_t> parse_bytes(std::string text, std::uint64_t smallest, std::uint64_t largest);

// Declares an option that takes a text as it is typed.
CLI::Option* add_text(CLI::App& app, const char* name, std::string& text, const char* help);

// The same without which the command line is wrong; a name without dashes is of an argument.
CLI::Option* add_required(CLI::App& app, const char* name, std::string& text, const char* help);

// The same for an option that may be given again and again: what was typed, separated.
CLI::Option* add_texts(CLI::App& app, const char* name, std::string& texts, char separator,
                       const char* help);

// Declares an option that takes one of some words.
CLI::Option* add_choice(CLI::App& app, const char* name, std::string& word,
                        std::initializer_list<const char*> words, const char* help);

// Declares an option without a value.
CLI::Option* add_flag(CLI::App& app, const char* name, bool& given, const char* help);

// The same that may have a value behind a "=": `text` is "true" where it has none.
CLI::Option* add_flag(CLI::App& app, const char* name, std::string& text, const char* help);

// Puts an option under a heading of the help.
void group(CLI::Option* option, const char* title);

// The text behind the option in the help: "NAME=VALUE", or "a|b|c" for choices.
void name_value(CLI::Option* option, const char* words);

// Whether the option was typed.
bool is_given(const CLI::App& app, const char* name);

}  // namespace forcelayer::command
