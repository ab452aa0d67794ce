#include "formats/command/arguments.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <utility>

#include "formats/command/command.h"
#include "formats/command/help.h"
#include "formats/command/report.h"
#include "formats/command/spelling/old_options.h"
#include "formats/command/version.h"

namespace forcelayer::command {
namespace {

// "HELP, default 1000"; HELP where the number is 0.
std::string with_default(const char* help, double number) {
  if (number == 0) return help;
  char text[32];
  std::snprintf(text, sizeof text, ", default %.6g", number);
  return help + std::string(text);
}

// In place of CLI11's "--seat: At Most 1 required but received 2".
std::string in_plain_words(std::string what) {
  const std::size_t at = what.find(" At Most 1 required but");
  return at == what.npos ? what : what.replace(at, what.npos, " is given more than once");
}

// The error of the first argument that was an option in an earlier version; no mend where none was.
Error old_spelling(const CLI::App& app) {
  for (const std::string& argument : app.remaining(true)) {
    const std::string option = argument.substr(0, argument.find('='));
    const std::string_view now = new_spelling(app.get_name(), option);
    if (!now.empty()) {
      return {ErrorCode::kUsage, "", option, "is an option of an earlier version",
              (now.starts_with("leave it out") ? "" : "write ") + std::string(now)};
    }
  }
  return {};
}

}  // namespace

void set_version(CLI::App& app, const std::string& facts) {
  std::string text = app.get_name() + " " + kVersion;
  const std::string of_commit = *commit() == 0 ? "" : std::string("commit ") + commit();
  const std::string between = of_commit.empty() || facts.empty() ? "" : "; ";
  if (!of_commit.empty() || !facts.empty()) text += " (" + of_commit + between + facts + ")";
  app.set_version_flag("--version", text);
}

std::shared_ptr<CLI::App> make_app(const char* description, const char* name, const char* footer) {
  end_where_memory_lacks(name);
  auto app = std::make_shared<CLI::App>(description, name);
  app->footer(footer);
  return app;
}

bool parse_arguments(CLI::App& app, int argc, char** argv, int& exit_code) {
  if (app.get_version_ptr() == nullptr) set_version(app);
  wrap_help(app);
  expect_report(argc, argv);
  try {
    app.parse(argc, argv);
    return true;
  } catch (const CLI::Success& done) {  // --help, --version
    exit_code = app.exit(done);
  } catch (const CLI::ParseError& wrong) {
    Error error = old_spelling(app);
    if (error.mend.empty()) {
      std::string mend = did_you_mean(app);
      if (mend.empty()) {
        mend = "see " + app.get_name();
        for (const CLI::App* const sub : app.get_subcommands()) mend += " " + sub->get_name();
        mend += " --help";
      }
      error = {ErrorCode::kUsage, "", "", in_plain_words(wrong.what()), mend};
    }
    exit_code = run_command(app.get_name().c_str(), [&] { return Status(error); });
  }
  return false;
}

bool parse_subcommands(CLI::App& app, int argc, char** argv, int& exit_code) {
  const std::string meant = argc > 1 ? meant_subcommand(app, argv[1]) : "";
  if (meant.empty()) return parse_arguments(app, argc, argv, exit_code);
  expect_report(argc, argv);
  const Error error{ErrorCode::kUsage, argv[1], "", "is neither a file nor a subcommand", meant};
  exit_code = run_command(app.get_name().c_str(), [&] { return Status(error); });
  return false;
}

CLI::Option* add_number(CLI::App& app, const char* name, const std::string& help,
                        const Bounds& bounds, std::function<void(double)> take) {
  const auto read = [name, bounds, take = std::move(take)](const std::string& text) {
    const auto number = parse_number(text, bounds);
    if (!number) throw CLI::ValidationError(name, number.error().what);
    take(*number);
  };
  return app.add_option_function<std::string>(name, read, help + " (" + to_text(bounds) + ")")
      ->type_name("NUMBER");
}

CLI::Option* add_number(CLI::App& app, const char* name, double& value, const char* help,
                        const Bounds& bounds) {
  return add_number(app, name, with_default(help, value), bounds,
                    [&value](double number) { value = number; });
}

CLI::Option* add_number(CLI::App& app, const char* name, std::optional<double>& value,
                        const char* help, const Bounds& bounds) {
  return add_number(app, name, with_default(help, value.value_or(0)), bounds,
                    [&value](double number) { value = number; });
}

CLI::Option* add_count(CLI::App& app, const char* name, unsigned& count, const char* help,
                       int smallest, int largest) {
  return app.add_option(name, count, help)->check(CLI::Range(smallest, largest));
}

Result<std::uint64_t> parse_bytes(std::string text, std::uint64_t smallest, std::uint64_t largest) {
  const std::string typed = text;
  std::uint64_t bytes = 0;
  try {
    const std::string wrong = CLI::AsSizeValue(false)(text);  // makes it a number
    const bool is_number = wrong.empty() && CLI::detail::lexical_cast(text, bytes);
    if (is_number && bytes >= smallest && bytes <= largest) return bytes;
  } catch (const CLI::ValidationError&) {
  }
  return Error{ErrorCode::kUsage, "", "",
               "'" + typed + "' is not a size from " + std::to_string(smallest) + " to " +
                   std::to_string(largest) + " bytes",
               "write it like 2GiB"};
}

CLI::Option* add_text(CLI::App& app, const char* name, std::string& text, const char* help) {
  return app.add_option(name, text, help);
}

CLI::Option* add_required(CLI::App& app, const char* name, std::string& text, const char* help) {
  return add_text(app, name, text, help)->required();
}

CLI::Option* add_texts(CLI::App& app, const char* name, std::string& texts, char separator,
                       const char* help) {
  return add_text(app, name, texts, help)->join(separator);
}

CLI::Option* add_choice(CLI::App& app, const char* name, std::string& word,
                        std::initializer_list<const char*> words, const char* help) {
  return add_text(app, name, word, help)
      ->check(CLI::IsMember(std::vector<std::string>(words.begin(), words.end())));
}

CLI::Option* add_flag(CLI::App& app, const char* name, bool& given, const char* help) {
  return app.add_flag(name, given, help);
}

CLI::Option* add_flag(CLI::App& app, const char* name, std::string& text, const char* help) {
  return app.add_flag(name, text, help);
}

void group(CLI::Option* option, const char* title) { option->group(title); }

void name_value(CLI::Option* option, const char* words) { option->type_name(words); }

bool is_given(const CLI::App& app, const char* name) { return app.count(name) > 0; }

}  // namespace forcelayer::command
