// The reports of a run: at the start, at the end, and --json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "runtime/devices/device.h"
#include "runtime/loop/loop.h"
#include "runtime/voxrun/options.h"
#include "runtime/voxrun/output_events.h"
#include "runtime/voxrun/scenes.h"
#include "runtime/voxrun/verdict.h"

namespace forcelayer::voxrun {

// Facts of a run that its Run and its LoopStatistics do not have.
struct RunFacts {
  explicit RunFacts(const Options& of_the_run) : options(of_the_run) {}

  const Options& options;
  std::string device;
  std::optional<DeviceCapabilities> capabilities;  // none in a replay
  std::uint64_t output_trips = 0;
  TripCause last_trip = TripCause::kNone;
  double last_trip_s = 0;
  devices::DeviceTrouble device_trouble;
  std::vector<devices::DeviceCounter> device_counters;
  bool ended_tripped = false;
  Outcome outcome;
  std::vector<OutputEvent> events;
  std::uint64_t scene_file_bytes = 0;
  double steal_s = 0;  // that the host of a virtual machine took from all cores
  double wall_s = 0;
  std::vector<std::string> warnings;
};

std::string start_text(const Scenes& scenes, const RunFacts& facts);
std::string end_text(const Scenes& scenes, const RunFacts& facts,
                     const loop::LoopStatistics& statistics);
nlohmann::ordered_json report_json(const Scenes& scenes, const RunFacts& facts,
                                   const loop::LoopStatistics& statistics);

}  // namespace forcelayer::voxrun
