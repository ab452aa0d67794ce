#include "formats/command/help.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "formats/command/spelling/spelling.h"

namespace forcelayer::command {
namespace {

constexpr const char* kCommon = "Every command";
constexpr std::size_t kNameColumns = 28;

// Text in lines of at most `width` columns, each but the first behind `indent` blanks.
std::string wrapped(std::string_view text, std::size_t width, std::size_t indent) {
  std::string lines;
  std::size_t column = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (column > 0 && column + 1 + end > width) {
      lines += '\n' + std::string(indent, ' ');
      column = 0;
    }
    if (column > 0) lines += ' ', ++column;
    lines += text.substr(0, end);
    column += end;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// A name and its meaning, in two columns.
std::string entry(const std::string& name, std::string_view what) {
  std::string line = "  " + name;
  if (line.size() + 2 > kNameColumns) {
    line += '\n' + std::string(kNameColumns, ' ');
  } else {
    line.resize(kNameColumns, ' ');
  }
  return line + wrapped(what, kHelpColumns - kNameColumns, kNameColumns) + '\n';
}

// A type as CLI11 names it, in words: what stands behind the option, and what is said of it.
struct TypeWords {
  std::string value_word, bounds;
};
TypeWords words_of(const std::string& type) {
  if (const std::size_t open = type.find('{'); open != std::string::npos) {
    std::string choices = type.substr(open + 1, type.find('}', open) - open - 1);
    std::replace(choices.begin(), choices.end(), ',', '|');
    return {choices, ""};
  }
  if (type.find("SIZE") != std::string::npos) return {"SIZE", ""};
  const std::string within = "INT in [";
  if (const std::size_t at = type.find(within); at != std::string::npos) {
    std::string range = type.substr(at + within.size(), type.find(']', at) - at - within.size());
    if (const std::size_t dash = range.find(" - "); dash != std::string::npos) {
      range.replace(dash, 3, " to ");
    }
    return {"N", " (" + range + ")"};
  }
  if (type.starts_with("UINT") || type.starts_with("INT")) return {"N", ""};
  return {type, ""};
}

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(kNameColumns); }

  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0) return "";
    std::string text = words_of(option->get_type_name()).value_word;
    if (option->get_positional()) text.clear();  // its name says what it is
    if (option->get_expected_max() == CLI::detail::expected_max_vector_size) text += "...";
    return text.empty() || text.starts_with("...") ? text : " " + text;
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    const std::string bounds = words_of(option->get_type_name()).bounds;
    std::string what = option->get_description();
    if (!option->get_default_str().empty()) what += ", default " + option->get_default_str();
    return entry(make_option_name(option, is_positional) + make_option_opts(option), what + bounds);
  }
  std::string make_subcommand(const CLI::App* sub) const override {
    return entry(sub->get_display_name(true), sub->get_description());
  }
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), kHelpColumns, 0) + "\n";
  }
  std::string make_footer(const CLI::App* app) const override {
    std::string text, footer = app->get_footer();
    for (std::string_view rest = footer; !rest.empty();) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view line = rest.substr(0, end);
      const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
      text += std::string(line.substr(0, indent)) +
              (line.size() > kHelpColumns
                   ? wrapped(line.substr(indent), kHelpColumns - indent, indent + 2)
                   : std::string(line.substr(indent))) +
              '\n';
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return text;
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    const std::string usage = CLI::Formatter::make_usage(app, std::move(name));
    constexpr std::string_view kTitle = "Usage:";
    return bold(std::string(kTitle)) + usage.substr(kTitle.size());
  }
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    std::string text = '\n' + bold(group + ":") + '\n';
    for (const CLI::Option* option : options) text += make_option(option, is_positional);
    return text;
  }
  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    std::string text = make_description(app) + make_usage(app, std::move(name)) +
                       make_positionals(app) + grouped_options(app) + make_subcommands(app, mode);
    const std::string footer = make_footer(app);
    return footer.empty() ? text : text + '\n' + footer;
  }

 private:
  // The groups in the order in which they were named first, but the common one last.
  std::string grouped_options(const CLI::App* app) const {
    std::string text;
    for (const bool common : {false, true}) {
      for (const std::string& group : app->get_groups()) {
        if (group.empty() || (group == kCommon) != common) continue;
        const auto options = app->get_options([&group](const CLI::Option* option) {
          return option->get_group() == group && option->nonpositional();
        });
        if (!options.empty()) text += make_group(group, false, options);
      }
    }
    return text;
  }

  static std::string bold(const std::string& text) {
    return wants_color(STDOUT_FILENO) ? "\x1b[1m" + text + "\x1b[0m" : text;
  }
};

}  // namespace

bool wants_color(int descriptor) {
  const char* const no = std::getenv("NO_COLOR");
  if (no != nullptr && *no != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  return isatty(descriptor) == 1 && terminal != nullptr && std::string_view(terminal) != "dumb";
}

void arrange_help(CLI::App& app, std::initializer_list<HelpGroup> groups,
                  const std::string& examples) {
  for (const HelpGroup& group : groups) {
    for (const char* const name : group.options) {
      CLI::Option* const option = app.get_option_no_throw(name);
      if (option == nullptr)
        throw std::logic_error(std::string("help: there is no option ") + name);
      option->group(group.title);
    }
  }
  std::string footer = app.get_footer();
  if (!footer.empty()) footer += "\n\n";
  app.footer(footer + "Lengths are at most 1e9m, and durations at most 10000h.\n\nExamples:\n" +
             examples);
}

void add_help_table(CLI::App& app, const char* title, std::string_view rows) {
  std::string text = app.get_footer();
  if (!text.empty()) text += "\n\n";
  text += title;
  text += ':';
  while (!rows.empty()) {
    const std::size_t tab = rows.find('\t'), end = rows.find('\n');
    const std::string line =
        entry(std::string(rows.substr(0, tab)), rows.substr(tab + 1, end - tab - 1));
    text += '\n' + line.substr(0, line.size() - 1);
    rows.remove_prefix(end + 1);
  }
  app.footer(text);
}

void wrap_help(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
  for (const char* const name : {"--json", "--quiet", "--help", "--version"}) {
    if (CLI::Option* const option = app.get_option_no_throw(name)) option->group(kCommon);
  }
  for (CLI::App* const sub : app.get_subcommands({})) wrap_help(*sub);
}

std::string meant_subcommand(const CLI::App& app, const char* word) {
  const std::string_view typed = word;
  if (typed.find_first_not_of("abcdefghijklmnopqrstuvwxyz") != typed.npos) return "";
  if (access(word, F_OK) == 0) return "";
  for (const CLI::App* const sub : app.get_subcommands({})) {
    const std::size_t distance = spelling_distance(typed, sub->get_name());
    if (distance == 0) return "";
    if (distance <= 2 && 2 * distance < typed.size())
      return "did you mean " + sub->get_name() + "?";
  }
  return "";
}

std::string did_you_mean(const CLI::App& app) {
  std::vector<const CLI::App*> asked{&app};
  for (const CLI::App* const sub : app.get_subcommands()) asked.push_back(sub);
  for (const std::string& argument : app.remaining(true)) {
    if (!argument.starts_with("-")) continue;
    const std::string typed = argument.substr(0, argument.find('='));
    std::string best;
    std::size_t smallest = std::max<std::size_t>(2, typed.size() / 3) + 1;
    for (const CLI::App* const one : asked) {
      for (const CLI::Option* const option : one->get_options()) {
        for (const std::string& name : option->get_lnames()) {
          const std::size_t distance = spelling_distance(typed, "--" + name);
          if (distance < smallest) smallest = distance, best = "did you mean --" + name + "?";
        }
      }
    }
    if (!best.empty()) return best;
  }
  return "";
}

}  // namespace forcelayer::command
