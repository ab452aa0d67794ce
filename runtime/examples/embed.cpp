// Forcelayer in a servo loop of your own: opens two files and steps the part once a period.
//   example_embed SCENE.vox PART.pshell
// Here a plain loop is the servo thread, and the hand is a script that comes down 30 mm.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "forcelayer/run.h"

using namespace forcelayer;

namespace {

int complain(const Error& error) {
  std::fprintf(stderr, "example_embed: %s\n", to_line(error).c_str());
  return exit_status(error.code);
}

// Your device: SI units, its ratings, its physical damping and delay.
DeviceCapabilities my_device() {
  DeviceCapabilities device;
  device.name = "my device";
  device.max_force_n = 8;
  device.max_torque_nm = 0.1;
  device.damping_ns_per_m = 2;
  device.damping_nms_per_rad = 0.005;
  device.delay_s = 0.001;
  device.hardware = true;
  return device;
}

// Your SDK's reading: the handle in the device's frame.
DeviceSample my_reading(double time_s) {
  DeviceSample reading;
  reading.device_from_handle.position_m.z = -0.03 * std::min(1.0, time_s / 0.5);
  reading.present = reading.fresh = true;
  return reading;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: example_embed SCENE.vox PART.pshell\n");
    return 2;
  }
  RunRequest request = default_run_request(argv[1], argv[2]);
  request.device = my_device();
  // The device's origin stands 60 mm above the middle of the floor, and so does the part.
  request.placement.world_from_device.position_m = {0.1, 0.1, 0.06};
  request.stale_s = 0.1;  // a shared machine and no motors; else leave it
  auto run = open_run(request);
  if (!run) return complain(run.error());
  PartStart start;
  start.world_from_part = request.placement.world_from_device;
  if (const auto started = run->start(start, my_reading(0)); !started) {
    return complain(started.error());
  }

  // Your servo thread, with real-time priority where it is granted.
  for (const std::string& warning : run->make_real_time()) {
    std::fprintf(stderr, "example_embed: warning: %s\n", warning.c_str());
  }
  auto tick = std::chrono::steady_clock::now();
  for (int frame = 0; frame < 1000; ++frame) {
    std::this_thread::sleep_until(tick += std::chrono::milliseconds(1));
    const Wrench wrench = run->step(my_reading(frame / 1000.0));
    static_cast<void>(wrench);  // give it to the motors: N and N m, device axes
  }

  const RunStatistics seen = run->statistics();
  std::printf("peak force %.2f N, %llu of %llu frames in contact, %llu penetrating, trips %llu\n",
              seen.max_force_n, static_cast<unsigned long long>(seen.contact_frames),
              static_cast<unsigned long long>(seen.frames),
              static_cast<unsigned long long>(seen.penetration_frames),
              static_cast<unsigned long long>(seen.trips));
  return 0;
}
