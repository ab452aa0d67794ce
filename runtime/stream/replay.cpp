#include "runtime/stream/replay.h"

#include <array>
#include <fstream>

namespace forcelayer::stream {

bool is_recording(const std::filesystem::path& path) {
  std::array<std::uint8_t, 8> magic{};
  std::ifstream file(path, std::ios::binary);
  file.read(reinterpret_cast<char*>(magic.data()), magic.size());
  return file && magic == kRecordingMagic;
}

Result<std::unique_ptr<model::Simulation>> recorded_simulation(const Recording& recording,
                                                               Voxmap voxmap, Pshell shell) {
  if (Status same = recording.check_files(voxmap, shell); !same) return same.error();
  auto simulation =
      model::Simulation::create(std::move(voxmap), std::move(shell), recording.run().parameters);
  if (!simulation || !recording.run().world_from_seat) return simulation;
  if (Status found = (*simulation)->find_seat(*recording.run().world_from_seat); !found) {
    return found.error();
  }
  return simulation;
}

void replay_steps(const Recording& recording, model::Simulation& simulation,
                  const std::function<void(const ReplayedStep&)>& visit) {
  const double dt_s = 1 / recording.run().parameters.rate_hz;
  ReplayInput input(recording);
  State state = recording.run().start;
  StepInput step_input;
  for (std::size_t n = 0; n < recording.frames().size(); ++n) {
    const double time_s = static_cast<double>(n) * dt_s;
    if (!input.next(time_s, dt_s, step_input)) break;
    const StepResult result = simulation.step(state, step_input, dt_s);
    visit({time_s, step_input, result, state});
  }
}

}  // namespace forcelayer::stream
