#include "formats/command/arguments.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <utility>

#include "formats/command/command.h"

namespace forcelayer::command {

bool parse_arguments(CLI::App& app, int argc, char** argv, int& exit_code) {
  app.set_version_flag("--version", app.get_name() + " " + kVersion);
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::Success& done) {  // --help, --version
    exit_code = app.exit(done);
  } catch (const CLI::ParseError& wrong) {
    const Error error{ErrorCode::kUsage, "", "", wrong.what(), "see " + app.get_name() + " --help"};
    exit_code = run_command(app.get_name().c_str(), [&] { return Status(error); });
  }
  return false;
}

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

CLI::Option* add_bytes(CLI::App& app, const std::string& name, std::uint64_t& bytes,
                       const std::string& help, std::uint64_t least, std::uint64_t most) {
  return app.add_option(name, bytes, help)
      ->transform(CLI::AsSizeValue(false))
      ->check(CLI::Range(least, most));
}

CLI::Option* add_text(CLI::App& app, const std::string& name, std::string& text,
                      const std::string& help) {
  return app.add_option(name, text, help);
}

CLI::Option* add_flag(CLI::App& app, const std::string& name, bool& given,
                      const std::string& help) {
  return app.add_flag(name, given, help);
}

}  // namespace forcelayer::command
