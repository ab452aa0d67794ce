// A path: of the simulated hand, and of the part.
#include <cmath>

#include "formats/path/path_edit.h"
#include "runtime/devices/motion_script.h"
#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const fuzz::MemoryFile file(fuzz::bytes_of(data, size));
  const auto path = read_path(file.path(), PathOf::kPart);
  fuzz::require(path.ok() || !path.error().what.empty(), "an error says what is wrong");
  if (path) {
    const auto facts = path_facts(*path);
    fuzz::require(facts.poses > 0 && facts.end_s >= facts.begin_s,
                  "a path has poses, and they ascend");
    fuzz::require(reversed(*path).size() == path->size(), "a reversed path has the same poses");
    fuzz::require(std::isfinite(widest_step(*path, {1, 2, 3}).aside_m), "lengths are finite");
    if (facts.end_s > facts.begin_s) {
      const auto samples = resampled(*path, (facts.end_s - facts.begin_s) / 7, {1, 2, 3});
      fuzz::require(samples.size() >= path->size() && samples.size() <= path->size() + 7,
                    "a resampled path has all its poses");
    }
  }
  const auto script = devices::MotionScript::read(file.path());
  if (!script) {
    fuzz::require(!script.error().what.empty(), "an error says what is wrong");
    return 0;
  }
  for (const double part : {-0.5, 0.0, 0.3, 1.0, 1.5}) {
    const Pose pose = script->pose(part * script->end_s());
    fuzz::require(std::isfinite(pose.position_m.x) && std::isfinite(pose.orientation.w),
                  "poses are finite");
    (void)script->velocity(part * script->end_s());
  }
  return 0;
}
