// The tables of stability_bench; each prints its rows and returns them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/stress/trial.h"

namespace forcelayer::stress {

using Json = nlohmann::ordered_json;

inline constexpr Model kBothModels[] = {Model::kPaper, Model::kDefault};
inline const char* name_of(Model model) { return model == Model::kPaper ? "paper" : "default"; }

Json to_json(const Metrics& metrics);

// Every stress case, both models, `trials` seeds each.
Json case_table(std::uint64_t trials);
// `trials` random rest trials of both models.
Json rest_table(std::uint64_t trials);
// The paper's Table 2 and the default model beside it, each until `contact_frames` are counted.
Json table2(std::uint64_t contact_frames);
// The paper's model in the same collisions, by its field stiffness.
Json field_sweep(std::uint64_t contact_frames);
// Random hands in congested scenes, the default model, until `frames` are counted.
Json random_hands(std::uint64_t frames);
// Quiet, moving and unstable settings: stiffness, mass and rate; a prescribed handle.
Json setting_map();
// The same loop closed by a simulated hand and device, beside the bounds that defaults obey.
Json device_table();
// Which handles swing: arm, hand, delay, scale and clutch, for both models; or for one of them, and
// at one scale.
Json grip_map(const std::string& only_model, double only_scale);
// The energy that slow closed loops in contact give the hand at the device's port, at every scale
// or at one; of parts that start above the plane, or seated on it, alone where one of the two is
// named.
Json loop_table(const std::string& only_start, double only_scale);
// Installed parts: rest, depth under hands at random, removal and return. Shells of the usual
// covering radius where `covering_voxels` is 0.
Json seat_table(std::uint64_t pairs, std::uint64_t first, double covering_voxels);
// Time of the default model's step beyond its contact queries, with 200 contacts and more.
Json step_cost(std::uint64_t steps);

}  // namespace forcelayer::stress
