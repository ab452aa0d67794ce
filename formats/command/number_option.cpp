#include "formats/command/number_option.h"

#include <CLI/CLI.hpp>
#include <utility>

namespace forcelayer::command {

CLI::Option* add_number(CLI::App& app, const std::string& name, const std::string& help,
                        const Bounds& bounds, std::function<void(double)> take) {
  const auto read = [name, bounds, take = std::move(take)](const std::string& text) {
    const auto number = parse_number(text, bounds);
    if (!number) throw CLI::ValidationError(name, number.error().what);
    take(*number);
  };
  return app.add_option_function<std::string>(name, read, help + " (" + to_text(bounds) + ")")
      ->type_name("NUMBER");
}

}  // namespace forcelayer::command
