// A recorded run step by step, without a loop around it: for those who want its poses.
#pragma once

#include <filesystem>
#include <functional>

#include "formats/result.h"
#include "runtime/stream/recording.h"

namespace forcelayer::stream {

// Whether a file begins as recordings do.
bool is_recording(const std::filesystem::path& path);

// One step of a recording, as it comes out again.
struct ReplayedStep {
  double time_s;
  const StepInput& input;
  const StepResult& result;
  const State& state;  // after the step
};

// Opens the recorded run's simulation on the files that it was made with, its seat included.
// Errors: those of Recording::check_files(), Simulation::create() and find_seat().
Result<std::unique_ptr<model::Simulation>> recorded_simulation(const Recording& recording,
                                                               Voxmap voxmap, Pshell shell);

// Makes the recorded steps again and hands each to `visit`.
void replay_steps(const Recording& recording, model::Simulation& simulation,
                  const std::function<void(const ReplayedStep&)>& visit);

}  // namespace forcelayer::stream
