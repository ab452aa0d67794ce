// A run reads from memory of its own: what happens to its files once they are open changes nothing.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "forcelayer/run.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop/loop.h"
#include "tests/support/both_models.h"
#include "tests/support/point_part.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

using std::filesystem::path;

constexpr double kS = 0.005;

struct Outcome {
  std::uint64_t frames = 0, hash = 0;
  TripCause trip = TripCause::kNone;
  double max_force_n = 0;

  bool operator==(const Outcome&) const = default;
};

// 600 frames that press on a slab and slide along it, so that the second half reads bricks that the
// first did not. `change` has the folder of both files after the first half.
Outcome run_changed(Model model, const std::function<void(const path& folder)>& change) {
  static const auto slab =
      voxmap_bytes(SceneFile(closed(offset_scene(kS, {0, 0, -2}, {96, 96, 8}, 2, [](Voxel v) {
                     return v[2] <= 0;
                   }))).content());
  const ScratchFolder folder;
  save_bytes(folder / "scene.vox", slab);
  save_pshell(folder / "part.pshell", sphere_part(0.02, 500, kS));
  RunRequest request = default_run_request(folder / "scene.vox", folder / "part.pshell");
  request.model = model;
  auto run = open_run(request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  const auto sim = run->release_simulation();
  const Pose high{{0.1, 0.1, 0.06}, {1, 0, 0, 0}}, low{{0.1, 0.1, 0.03}, {1, 0, 0, 0}};
  devices::SimDevice device(
      devices::MotionScript({{0, high}, {0.1, low}, {0.6, {{0.4, 0.4, 0.03}, {1, 0, 0, 0}}}}), {});
  loop::DeviceInput input(device, {});
  loop::OutputLimits limits;
  limits.max_force_n = 10;
  limits.max_torque_nm = 1;
  limits.rearm_alone = true;
  loop::Servo servo(*sim, input, sim->registered(high, high), limits);
  const auto statistics = std::make_unique<loop::LoopStatistics>();
  loop::LoopOptions options;
  options.as_fast_as_possible = true;
  options.frames = 300;
  loop::run_loop(servo, options, nullptr, *statistics);
  change(folder.path());
  loop::run_loop(servo, options, nullptr, *statistics);
  return {statistics->frames, statistics->outcome_hash, servo.output().last_trip(),
          statistics->max_device_force_n};
}

class OwnedFiles : public BothModels {};
INSTANTIATE_TEST_SUITE_P(Models, OwnedFiles, kBothModels, name_of_model);

void write_over(const path& file, std::size_t from, const std::string& bytes) {
  std::fstream written(file, std::ios::in | std::ios::out | std::ios::binary);
  written.seekp(static_cast<std::streamoff>(from));
  written << bytes;
}

TEST_P(OwnedFiles, NothingThatHappensToThemChangesARun) {
  const Outcome calm = run_changed(GetParam(), [](const path&) {});
  EXPECT_EQ(calm.frames, 600u);
  EXPECT_EQ(calm.trip, TripCause::kNone);
  EXPECT_GT(calm.max_force_n, 1);
  const std::pair<const char*, std::function<void(const path&)>> changes[] = {
      {"removed", [](const path& file) { std::filesystem::remove(file); }},
      {"renamed", [](const path& file) { std::filesystem::rename(file, file.string() + "2"); }},
      {"emptied", [](const path& file) { std::filesystem::resize_file(file, 0); }},
      {"cut to a page", [](const path& file) { std::filesystem::resize_file(file, 4096); }},
      {"a byte", [](const path& file) { write_over(file, 1000, "x"); }},
      {"indices that lead nowhere",
       [](const path& file) {
         write_over(file, 0, std::string(std::filesystem::file_size(file), '\x7f'));
       }},
      {"zeros, and longer", [](const path& file) {
         write_over(file, 0, std::string(2 * std::filesystem::file_size(file), '\0'));
       }}};
  for (const auto& [what, change] : changes) {
    const Outcome changed = run_changed(GetParam(), [&apply = change](const path& folder) {
      for (const char* name : {"scene.vox", "part.pshell"}) apply(folder / name);
    });
    EXPECT_TRUE(changed == calm) << what;
  }
}

// Not even a page of them is mapped: neither a truncation nor a page that the system takes back can
// reach the loop.
TEST_P(OwnedFiles, NoFileIsMapped) {
  int mapped = 0;
  run_changed(GetParam(), [&](const path& folder) {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);) {
      mapped += line.find(folder.filename().string()) != std::string::npos;
    }
  });
  EXPECT_EQ(mapped, 0);
}

}  // namespace
}  // namespace forcelayer::test
