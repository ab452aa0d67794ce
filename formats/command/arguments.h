// The command line: its parsing, and the kinds of options that several commands have. Sources that
// declare options by these alone need not compile CLI11.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "formats/command/quantity.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace forcelayer::command {

// Parses argv into `app`; --help and --version print and end with status 0 (returns false with
// `exit_code` 0), a wrong command line gives one line on stderr and status 2.
bool parse_arguments(CLI::App& app, int argc, char** argv, int& exit_code);

// The same for an app with subcommands: a first argument that is no file, but spelled nearly like
// one of them, is a wrong command line.
bool parse_subcommands(CLI::App& app, int argc, char** argv, int& exit_code);

// "HELP, default 1000"; HELP where the number is 0.
std::string with_default(const std::string& help, double number);
inline double to_default(double value) { return value; }
inline double to_default(const std::optional<double>& value) { return value.value_or(0); }

// Declares an option that takes a number within `bounds`, which its help names, and hands it to
// `take`. What is not finite or outside is a wrong command line (quantity.h: parse_number).
CLI::Option* add_number(CLI::App& app, const std::string& name, const std::string& help,
                        const Bounds& bounds, std::function<void(double)> take);

// The same into a variable. Its help names the value so far as the default, where that is a number
// other than 0.
template <typename T>
CLI::Option* add_number(CLI::App& app, const std::string& name, T& value, const std::string& help,
                        const Bounds& bounds) {
  const std::string known = with_default(help, to_default(value));
  return add_number(app, name, known, bounds, [&value](double number) { value = number; });
}

// Declares an option that takes a size in bytes, such as 2GiB, from `least` to `most`.
CLI::Option* add_bytes(CLI::App& app, const std::string& name, std::uint64_t& bytes,
                       const std::string& help, std::uint64_t least, std::uint64_t most);

// Declares an option that takes a text as it is typed.
CLI::Option* add_text(CLI::App& app, const std::string& name, std::string& text,
                      const std::string& help);

// Declares an option without a value.
CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& given, const std::string& help);

}  // namespace forcelayer::command
