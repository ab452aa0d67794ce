// The steps of a study: commands, each shown before it runs, and none run again whose command and
// inputs are those of the last time.
#pragma once

#include <nlohmann/json.hpp>
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
};

// The end of a step.
struct StepEnd {
  int status = 0;
  std::string output;  // on the standard output
  bool again = false;  // not run: as the last time
};

// "voxelize gearbox.glb --without Lid", as a shell takes it.
std::string command_line(const Step& step);

class Steps {
 public:
  // Remembers in this file what was run.
  static Result<Steps> open(const std::string& memory, bool quiet);

  // Runs a step to its end, and prints its command and output. Errors: kFileNotFound for a program
  // or an input that is not there. A step that fails is forgotten, and its status reported.
  Result<StepEnd> run(const Step& step);

  // Those of this time, in their order.
  struct Line {
    std::string command;
    int status = 0;
    bool again = false;
  };
  const std::vector<Line>& lines() const { return lines_; }

 private:
  Steps(std::string memory, bool quiet) : memory_(std::move(memory)), quiet_(quiet) {}

  std::string memory_;
  bool quiet_;
  nlohmann::ordered_json known_ = nlohmann::ordered_json::object();  // by command line
  nlohmann::ordered_json kept_ = nlohmann::ordered_json::object();   // of this time
  void say(const std::string& text) const;

  std::vector<Line> lines_;
};

// The file and those that it refers to: meshes of a manifest, buffers of a glTF file, parts of a
// STEP assembly.
std::vector<std::string> with_references(const std::string& file);

}  // namespace forcelayer::study
