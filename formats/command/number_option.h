// Options of a command line that take a number.
#pragma once

#include <functional>
#include <string>

#include "formats/command/quantity.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace forcelayer::command {

// Declares an option that takes a number within `bounds`, which its help names, and hands it to
// `take`. What is not finite or outside is a wrong command line (quantity.h: parse_number).
CLI::Option* add_number(CLI::App& app, const std::string& name, const std::string& help,
                        const Bounds& bounds, std::function<void(double)> take);

// The same into a variable.
template <typename T>
CLI::Option* add_number(CLI::App& app, const std::string& name, T& value, const std::string& help,
                        const Bounds& bounds) {
  return add_number(app, name, help, bounds, [&value](double number) { value = number; });
}

}  // namespace forcelayer::command
