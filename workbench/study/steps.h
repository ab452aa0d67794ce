// The steps of a study: commands, each shown before it runs, and none run again whose command and
// inputs are those of the last time.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::study {

struct Step {
  std::string program;
  std::vector<std::string> arguments;
  std::vector<std::string> inputs;   // files that its outcome depends on
  std::vector<std::string> outputs;  // files that it writes
  std::string package;               // that it is installed with
  bool shows = true;  // whether its output is for the reader: not that of a measurement
  // Its last argument is the --time of the study; this much of it is left for the step, s.
  std::optional<double> left_s = {};
};

// The end of a step.
struct StepEnd {
  int status = 0;
  std::string output;  // on the standard output
  bool again = false;  // not run: as the last time
  double seconds = 0;  // that it took, now or in an earlier study; 0: earlier in this study
};

// "voxelize gearbox.glb --without Lid", as a shell takes it.
std::string command_line(const Step& step);

class Steps {
 public:
  // Remembers in this file what was run.
  static Result<Steps> open(const std::string& memory, bool quiet);

  // Runs a step to its end, and prints its command and output; `begins` is called before. Errors:
  // kFileNotFound for a program or an input that is not there. A step that fails is forgotten, and
  // its status reported. The time that is left is no part of the question: a step that has answered
  // is not run again with more or less of it.
  Result<StepEnd> run(const Step& step, const std::function<Status()>& begins);

  // Whether an earlier study remembered this step with the inputs and outputs as they are now.
  bool is_known(const Step& step) const;
  Status remember(const Step& step);

  // The answer that an earlier study kept to a question with these inputs; null: none.
  nlohmann::json recall(const std::string& question, const std::vector<std::string>& inputs);
  Status keep(const std::string& question, const std::vector<std::string>& inputs,
              const nlohmann::json& answer);

  // Prints it, unless the study is quiet.
  void say(const std::string& text) const;

  // Those since the last forget_lines(), in their order.
  struct Line {
    std::string command;
    int status = 0;
    bool again = false;
  };
  const std::vector<Line>& lines() const { return lines_; }
  void forget_lines() { lines_.clear(); }

 private:
  Steps(std::string memory, bool quiet) : memory_(std::move(memory)), quiet_(quiet) {}

  std::string memory_;
  bool quiet_;
  nlohmann::ordered_json known_ = nlohmann::ordered_json::object();  // by command line
  nlohmann::ordered_json kept_ = nlohmann::ordered_json::object();   // of this time
  Status write() const;

  std::vector<Line> lines_;
};

// The file and those that it refers to: meshes of a manifest, buffers of a glTF file, parts of a
// STEP assembly.
std::vector<std::string> with_references(const std::string& file);

}  // namespace forcelayer::study
