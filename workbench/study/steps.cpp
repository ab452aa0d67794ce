#include "workbench/study/steps.h"

#include <cctype>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include "formats/command/command.h"
#include "formats/command/program.h"
#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"
#include "formats/command/version.h"
#include "formats/digest/file_digest.h"
#include "formats/file/named_file.h"

namespace forcelayer::study {
namespace {

using Json = nlohmann::ordered_json;

std::string quoted(const std::string& word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                          "0123456789_-+=.,:/@%") == std::string::npos;
  if (plain) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

enum class Missing { kIsError, kIsNoted };  // a search that finds no path writes none

Result<Json> digests_of(const std::vector<std::string>& paths,
                        Missing missing = Missing::kIsError) {
  Json digests = Json::object();
  for (const std::string& path : paths) {
    if (missing == Missing::kIsNoted && !std::filesystem::exists(path)) {
      digests[path] = nullptr;
      continue;
    }
    const auto digest = digest::sha256_of_file(path);
    if (!digest) return digest.error();
    digests[path] = *digest;
  }
  return digests;
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Every text under a key "mesh" or "uri", however deep.
void collect(const nlohmann::json& json, std::set<std::string>& names) {
  if (json.is_object()) {
    for (const auto& [key, value] : json.items()) {
      const bool is_name = (key == "mesh" || key == "uri") && value.is_string();
      if (is_name) names.insert(value.get<std::string>());
      collect(value, names);
    }
  } else if (json.is_array()) {
    for (const auto& value : json) collect(value, names);
  }
}

std::set<std::string> names_in(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::set<std::string> names;
  if (ending == ".json" || ending == ".gltf") {
    const auto json = nlohmann::json::parse(content_of(file), nullptr, false);
    if (!json.is_discarded()) collect(json, names);
  } else if (ending == ".step" || ending == ".stp") {
    const std::string text = content_of(file);
    static const std::regex name("'([^'\n]+\\.(?:stp|step|p21))'", std::regex::icase);
    for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at) {
      names.insert((*at)[1]);
    }
  }
  return names;
}

Step with_time_left(const Step& step) {
  Step limited = step;
  if (step.left_s) limited.arguments.back() = command::text("%.4gs", *step.left_s);
  return limited;
}

// The lines without advice to use options that a study does not have.
std::string in_words_of_study(const std::string& output) {
  std::string kept;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    const std::string words = command::with_known_options(line);
    if (!words.empty() || line.empty()) kept += words + "\n";
  }
  return kept;
}

// Other programs may answer otherwise.
std::string version() { return std::string(command::kVersion) + " " + command::commit(); }

}  // namespace

std::string command_line(const Step& step) {
  std::string line = step.program;
  for (const std::string& argument : step.arguments) line += " " + quoted(argument);
  return line;
}

std::vector<std::string> with_references(const std::string& file) {
  std::set<std::string> seen;
  const std::function<void(const std::filesystem::path&)> add = [&](const auto& path) {
    std::error_code failure;
    if (!std::filesystem::is_regular_file(path, failure)) return;
    if (!seen.insert(path.lexically_normal()).second) return;
    for (const std::string& name : names_in(path)) {
      add(file_of((path.parent_path() / name).string()));
    }
  };
  add(file);
  if (seen.empty()) return {file};
  return {seen.begin(), seen.end()};
}

Result<Steps> Steps::open(const std::string& memory, bool quiet) {
  Steps steps(memory, quiet);
  const auto json = Json::parse(content_of(memory), nullptr, false);
  if (json.is_object() && json.value("version", "") == version() && json.contains("steps") &&
      json["steps"].is_object()) {
    steps.known_ = json["steps"];
  }
  return steps;
}

void Steps::say(const std::string& text) const {
  if (quiet_) return;
  std::fputs(text.c_str(), stdout);
  std::fflush(stdout);
}

bool Steps::is_known(const Step& step) const {
  const auto last = known_.find(command_line(step));
  if (last == known_.end()) return false;
  const auto inputs = digests_of(step.inputs), outputs = digests_of(step.outputs);
  return inputs && outputs && (*last)["inputs"] == *inputs && (*last)["outputs"] == *outputs;
}

Status Steps::remember(const Step& step) {
  const auto inputs = digests_of(step.inputs), outputs = digests_of(step.outputs);
  if (!inputs || !outputs) return inputs ? outputs.error() : inputs.error();
  kept_[command_line(step)] = {{"inputs", *inputs}, {"outputs", *outputs}};
  return write();
}

Result<StepEnd> Steps::run(const Step& step, const std::function<Status()>& begins) {
  const std::string line = command_line(step);
  const Step limited = with_time_left(step);
  const auto inputs = digests_of(step.inputs);
  if (!inputs) return inputs.error();
  const bool is_own = kept_.contains(line);  // run before in this study
  const Json& known = is_own ? kept_ : known_;
  if (const auto last = known.find(line); last != known.end() && (*last)["inputs"] == *inputs) {
    const auto outputs = digests_of(step.outputs, Missing::kIsNoted);
    if (outputs && (*last)["outputs"] == *outputs) {
      const std::string shown = last->value("command", line);
      say("unchanged: " + shown + "\n");
      const StepEnd end{(*last)["status"], (*last)["output"], true,
                        is_own ? 0 : last->value("seconds", 0.0)};
      lines_.push_back({shown, end.status, true});
      if (!is_own) kept_[line] = *last;
      return end;
    }
  }
  const std::string shown = command_line(limited);
  say("$ " + shown + "\n");
  if (Status s = begins(); !s) return s.error();
  const auto begun = std::chrono::steady_clock::now();
  const auto end = command::run_program(step.program, limited.arguments, "",
                                        command::ProgramOutput::kTaken, step.package);
  if (!end) return end.error();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;
  StepEnd ended{end->status, end->output, false, took.count()};
  if (step.shows) say(in_words_of_study(end->output));
  lines_.push_back({shown, end->status});
  // Where it failed, the files are those of an earlier step.
  if (!command::is_answer(end->status)) return ended;
  const auto outputs =
      digests_of(step.outputs, end->status == 0 ? Missing::kIsError : Missing::kIsNoted);
  if (!outputs) {
    ended.status = end->status == 0 ? 1 : end->status;
    return ended;
  }
  kept_[line] = {{"command", shown},         {"status", end->status}, {"output", end->output},
                 {"seconds", ended.seconds}, {"inputs", *inputs},     {"outputs", *outputs}};
  if (Status written = write(); !written) return written.error();
  return ended;
}

Status Steps::write() const {
  return command::write_report(memory_, Json{{"version", version()}, {"steps", kept_}});
}

nlohmann::json Steps::recall(const std::string& question, const std::vector<std::string>& inputs) {
  const auto last = known_.find(question);
  const auto digests = digests_of(inputs);
  if (last == known_.end() || !digests || (*last)["inputs"] != *digests) return nullptr;
  kept_[question] = *last;
  return (*last)["answer"];
}

Status Steps::keep(const std::string& question, const std::vector<std::string>& inputs,
                   const nlohmann::json& answer) {
  const auto digests = digests_of(inputs);
  if (!digests) return digests.error();
  kept_[question] = {{"inputs", *digests}, {"answer", answer}};
  return write();
}

}  // namespace forcelayer::study
