// Answers for many poses of a part, or for many points of a scene, on several threads. No answer
// depends on the thread that gives it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer::python {

using PoseNumbers = std::array<double, 7>;  // x y z (m), qw qx qy qz: world_from_part

// How many points of the part lie in which voxels at one pose.
struct PointCounts {
  std::uint32_t interior = 0, surface = 0, proximity = 0;  // in voxels of value 1, 2 and 3
  bool outside_map = false;  // a point lies beyond a cropped side: nothing is known of it
};

// The same counts, and the proven clearance of the exact surfaces.
struct ClearanceAnswer {
  double clearance_m = 0;                   // a lower bound; NaN where nothing is known
  std::array<double, 3> nearest_point_m{};  // the nearest shell point, world; NaN: not measured
  std::uint32_t nearest_object = 0;         // number of the object nearest to it; 0: not known
  std::uint32_t interior = 0, surface = 0, proximity = 0;
  bool measured = false;  // false: beyond the stored reach; the clearance is at least clearance_m
  bool outside_map = false;
};

// The scene at one point.
struct PointAnswer {
  double distance_m = 0;             // from the static mesh, interpolated; NaN where none is stored
  double min_distance_m = 0;         // no point of the mesh is nearer; 0: nothing is proven
  std::array<double, 3> gradient{};  // of the distance, world axes; NaN where none is stored
  std::uint32_t object = 0;          // number of the nearest object; 0: not known
  std::uint8_t value = 0;            // of the voxel: VoxelValue
  bool known = false;                // false: beyond a cropped side
};

// `wanted`, or for 0 the machine's number of threads.
unsigned thread_count(unsigned wanted);

// Called on the calling thread about every 50 ms. Where it returns false, the work ends and returns
// kStopped.
using KeepGoing = std::function<bool()>;
inline constexpr std::int64_t kAllDone = -1, kStopped = -2;

// Answers for poses of one part in one scene. The files must outlive it. Threads that call it at
// the same time are served one after another.
class PoseBatch {
 public:
  // Errors: kFilesDoNotMatch for a part too large for the voxels.
  static Result<std::unique_ptr<PoseBatch>> create(const Voxmap& scene, const Pshell& part);
  ~PoseBatch();

  // Fills `answers`, one for each pose. Returns kAllDone, kStopped, or the number of a pose that is
  // not finite or whose quaternion is zero. `threads`: 0 for all of the machine.
  std::int64_t count(std::span<const PoseNumbers> poses, unsigned threads,
                     std::span<PointCounts> answers, const KeepGoing& keep_going);
  std::int64_t clearance(std::span<const PoseNumbers> poses, unsigned threads,
                         std::span<ClearanceAnswer> answers, const KeepGoing& keep_going);

 private:
  class Probe;
  PoseBatch(const Voxmap& scene, const Pshell& part);
  template <typename Answer>
  std::int64_t answer(std::span<const PoseNumbers> poses, unsigned threads,
                      std::span<Answer> answers, const KeepGoing& keep_going);

  const Voxmap& scene_;
  const Pshell& part_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Probe>> probes_;  // one a thread
};

// Answers for points of a scene. The scene must outlive it.
class PointBatch {
 public:
  explicit PointBatch(const Voxmap& scene);
  ~PointBatch();

  // Returns kAllDone, kStopped, or the number of a point that is not finite.
  std::int64_t sample(std::span<const std::array<double, 3>> points_m, unsigned threads,
                      std::span<PointAnswer> answers, const KeepGoing& keep_going);

 private:
  class Reader;

  const Voxmap& scene_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Reader>> readers_;  // one a thread
};

}  // namespace forcelayer::python
