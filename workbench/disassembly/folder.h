// The folder of a disassembly: sequence.json and, beside it, the paths. Steps of an earlier run are
// known by the content of the parts that were there, so that a run goes on where another one ended.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/file/descriptor.h"
#include "formats/result.h"
#include "workbench/disassembly/disassembly.h"

namespace forcelayer::disassembly {

class Folder {
 public:
  // Makes the folder where it is not there, and locks it for as long as this lives. `assembly` and
  // `request` outlive this. Errors: kWriteFailed; kUsage where sequence.json is no report or has
  // another target, or where other files are in the way.
  static Result<Folder> open(const std::string& folder, const pairs::AssemblyParts& assembly,
                             const Request& request);

  // The steps of the round that an earlier run found for these parts; none where it found none, or
  // where a part, the question or a file has changed since.
  std::vector<Step> recall(const Parts& present) const;

  // Writes the paths of further steps.
  Status add(const Parts& present, const std::vector<Step>& steps);

  // Replaces sequence.json; add() has had all steps. Once the outcome is `finished`, files of
  // earlier runs that no step names are removed.
  Status write(const Outcome& outcome, bool finished, double seconds);

  // The content of sequence.json as it was written last.
  const nlohmann::ordered_json& sequence() const { return written_; }

 private:
  Folder(std::string folder, Descriptor lock, const pairs::AssemblyParts& assembly,
         const Request& request);
  std::string in(const std::string& name) const;
  Status check_target() const;
  Status mark_unfinished() const;
  std::string state_of(const Parts& present) const;
  std::optional<Step> step_of(const nlohmann::json& known) const;
  nlohmann::ordered_json json_of(const Step& step) const;

  std::string folder_;
  Descriptor lock_;
  const pairs::AssemblyParts& assembly_;
  const Request& request_;
  std::vector<std::string> digests_;                                // [parts] of name and content
  nlohmann::json known_;                                            // sequence.json as it was
  nlohmann::ordered_json steps_ = nlohmann::ordered_json::array();  // so far
  nlohmann::ordered_json written_;
};

}  // namespace forcelayer::disassembly
