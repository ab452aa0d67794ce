// The tables of stability_bench; each prints its figures and returns rows.
#pragma once

#include <nlohmann/json.hpp>

#include "tests/stress/trial.h"

namespace forcelayer::stress {

using Json = nlohmann::ordered_json;

inline constexpr Model kBothModels[] = {Model::kPaper, Model::kDefault};
inline const char* name_of(Model model) { return model == Model::kPaper ? "paper" : "default"; }

// The handles that swing: by arm, hand, delay, scale and clutch, for both models.
Json grip_table();
// The time of the default model's step, with 200 contacts and more.
Json step_table(std::uint64_t steps);

}  // namespace forcelayer::stress
