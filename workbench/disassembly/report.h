// A disassembly in words, as a work instruction, and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/disassembly/disassembly.h"

namespace forcelayer::disassembly {

// "30 mm or more along +z", "78 mm along +x, then 95 mm or more along -y": the path of a step.
// Where it ends, the parts are outside of the box around all parts that are left, and stay so
// however far they go on along the last leg.
std::string motion_text(const Step& step);

// "1. Bolt: 30 mm or more along +z (nearest: Cover, 0.098 mm)", with a line for each overlap.
std::string instruction(const pairs::AssemblyParts& assembly, const Step& step, std::size_t number);

// "All 9 parts come apart.", and behind a "no" a line for each part that is left. `left` lines at
// most.
std::string summary(const pairs::AssemblyParts& assembly, const Request& request,
                    const Outcome& outcome);

// The keys of a step in sequence.json, but those of its files.
nlohmann::ordered_json step_json(const pairs::AssemblyParts& assembly, const Step& step);

// The keys of sequence.json, but those of the steps.
nlohmann::ordered_json outcome_json(const pairs::AssemblyParts& assembly, const Request& request,
                                    const Outcome& outcome);

// An error where something is left, or where installed parts overlap. Errors: kAnswerIsNo,
// kNeedsForce.
Status exit_of(const pairs::AssemblyParts& assembly, const Request& request, const Outcome& outcome,
               const std::string& file);

}  // namespace forcelayer::disassembly
