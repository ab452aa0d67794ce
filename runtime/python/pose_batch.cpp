#include "runtime/python/pose_batch.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>
#include <thread>

#include "formats/bricks/unpacked_distances.h"
#include "runtime/field/surface_clearance.h"
#include "runtime/guard/pose_guard.h"
#include "runtime/machine/step_arithmetic.h"

namespace forcelayer::python {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kFarVoxels = 0x1p53;  // coordinates beyond stay beyond every map
constexpr float kBelowOne = 0x1.fffffep-1f;
constexpr std::size_t kChunksPerThread = 8;  // so that a slow thread holds up little

// Calls work(worker, begin, end) for portions of `count` items, on this thread and on helpers. A
// portion that follows another is near it, which helps what remembers. work() returns the number of
// an item that it cannot answer, or kAllDone; the least such number is returned.
template <typename Work>
std::int64_t share_out(std::size_t count, std::size_t workers, std::size_t min_portion,
                       const KeepGoing& keep_going, const Work& work) {
  using Clock = std::chrono::steady_clock;
  const std::size_t portion =
      std::clamp<std::size_t>(count / (workers * kChunksPerThread), min_portion, 64 * min_portion);
  std::atomic<std::size_t> next{0};
  std::atomic<std::int64_t> failed{std::numeric_limits<std::int64_t>::max()};
  std::atomic<bool> stopped{false};
  const auto run = [&](std::size_t worker, bool asks) {
    const machine::StepArithmetic arithmetic;
    auto asked = Clock::now();
    while (!stopped.load(std::memory_order_relaxed)) {
      const std::size_t begin = next.fetch_add(portion, std::memory_order_relaxed);
      if (begin >= count) return;
      const std::int64_t bad = work(worker, begin, std::min(begin + portion, count));
      if (bad != kAllDone) {
        std::int64_t smallest = failed.load();
        while (bad < smallest && !failed.compare_exchange_weak(smallest, bad)) {
        }
        return;  // shares before this one were begun before it
      }
      if (!asks || Clock::now() - asked < std::chrono::milliseconds(50)) continue;
      if (!keep_going()) stopped = true;
      asked = Clock::now();
    }
  };
  std::vector<std::thread> helpers;
  try {
    for (std::size_t n = 1; n < workers && n * portion < count; ++n) {
      helpers.emplace_back(run, n, false);
    }
  } catch (const std::system_error&) {  // no more threads: the others do the work
  }
  run(0, true);
  for (std::thread& helper : helpers) helper.join();
  if (stopped) return kStopped;
  return failed == std::numeric_limits<std::int64_t>::max() ? kAllDone : failed.load();
}

// Makes what one worker needs, for all of them.
template <typename T, typename Make>
void make_for_each(std::vector<std::unique_ptr<T>>& all, std::size_t workers, const Make& make) {
  while (all.size() < workers) all.push_back(make());
}

bool read_pose(const PoseNumbers& numbers, Pose& pose) {
  double sum = 0;
  for (const double number : numbers) sum += number;
  const glm::dquat q(numbers[3], numbers[4], numbers[5], numbers[6]);
  const double length = glm::length(q);
  if (!std::isfinite(sum) || !std::isfinite(length) || !(length > 0)) return false;
  pose = {{numbers[0], numbers[1], numbers[2]}, q / length};
  return true;
}

}  // namespace

unsigned thread_count(unsigned wanted) {
  constexpr unsigned kMax = 1024;
  const unsigned all = std::max(1u, std::thread::hardware_concurrency());
  return std::min(wanted == 0 ? all : wanted, kMax);
}

// One thread's view of scene and part.
class PoseBatch::Probe {
 public:
  Probe(const Voxmap& scene, const Pshell& part)
      : center_m_(part.header().center_m[0], part.header().center_m[1], part.header().center_m[2]),
        query_(scene, part),
        surface_(query_) {
    points_.reserve(part.view().point_count);
  }

  bool answer(const PoseNumbers& numbers, PointCounts& out) {
    Pose pose;
    if (!read_pose(numbers, pose)) return false;
    query_.run(pose * Pose{center_m_, {1, 0, 0, 0}}, points_);
    out = {points_.interior_count, points_.surface_count, points_.proximity_count,
           points_.outside_map};
    return true;
  }

  bool answer(const PoseNumbers& numbers, ClearanceAnswer& out) {
    Pose pose;
    if (!read_pose(numbers, pose)) return false;
    if (!probe_) prepare();
    pose = pose * Pose{center_m_, {1, 0, 0, 0}};
    probe_->query_pose(pose, contacts_);
    field::PoseClearance smallest = field::point_clearance(contacts_, pose.position_m, *probe_);
    surface_.prove(smallest.kind, smallest.clearance_m);
    out.measured = smallest.kind == ClearanceKind::kProven;
    out.clearance_m = smallest.kind == ClearanceKind::kNone ? kNan : smallest.clearance_m;
    out.nearest_object = out.measured ? smallest.nearest_object : 0;
    const glm::dvec3 at = out.measured ? smallest.nearest_point_m : glm::dvec3(kNan);
    out.nearest_point_m = {at.x, at.y, at.z};
    out.interior = contacts_.interior;
    out.surface = contacts_.surface;
    out.proximity = contacts_.proximity;
    out.outside_map = contacts_.outside_map;
    return true;
  }

 private:
  void prepare() {
    const Voxmap& scene = query_.voxmap();
    const std::uint64_t points = query_.shell().view().point_count;
    samples_.reserve(points);
    contacts_.reserve(points);
    // The field that is usual for a map goes together with it.
    field_ =
        field::make_force_field(Model::kDefault, field::usual_force(Model::kDefault, scene), scene)
            .value();
    probe_ = std::make_unique<guard::PoseGuard>(query_, *field_, points_, samples_);
  }

  glm::dvec3 center_m_;
  query::ContactQuery query_;
  field::SurfaceClearance surface_;
  query::CollectedPoints points_;
  // Used by clearance() alone.
  field::FieldSamples samples_;
  field::ContactSet contacts_;
  std::unique_ptr<field::ForceField> field_;
  std::unique_ptr<guard::PoseGuard> probe_;
};

PoseBatch::PoseBatch(const Voxmap& scene, const Pshell& part) : scene_(scene), part_(part) {}
PoseBatch::~PoseBatch() = default;

Result<std::unique_ptr<PoseBatch>> PoseBatch::create(const Voxmap& scene, const Pshell& part) {
  if (Status fits = query::ContactQuery::check_size(scene, part); !fits) return fits.error();
  return std::unique_ptr<PoseBatch>(new PoseBatch(scene, part));
}

template <typename Answer>
std::int64_t PoseBatch::answer(std::span<const PoseNumbers> poses, unsigned threads,
                               std::span<Answer> answers, const KeepGoing& keep_going) {
  constexpr std::size_t kMinPortion = 64;
  const std::lock_guard lock(mutex_);
  const std::size_t workers =
      std::min<std::size_t>(thread_count(threads), poses.size() / kMinPortion + 1);
  make_for_each(probes_, workers, [&] { return std::make_unique<Probe>(scene_, part_); });
  return share_out(poses.size(), workers, kMinPortion, keep_going,
                   [&](std::size_t worker, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; ++i) {
                       if (!probes_[worker]->answer(poses[i], answers[i])) {
                         return static_cast<std::int64_t>(i);
                       }
                     }
                     return kAllDone;
                   });
}

std::int64_t PoseBatch::count(std::span<const PoseNumbers> poses, unsigned threads,
                              std::span<PointCounts> answers, const KeepGoing& keep_going) {
  return answer(poses, threads, answers, keep_going);
}

std::int64_t PoseBatch::clearance(std::span<const PoseNumbers> poses, unsigned threads,
                                  std::span<ClearanceAnswer> answers, const KeepGoing& keep_going) {
  return answer(poses, threads, answers, keep_going);
}

// One thread's view of the scene's points: those inside the directory are put to the force field as
// if they were a part's.
class PointBatch::Reader {
 public:
  static constexpr std::size_t kTogether = 1024;

  explicit Reader(const Voxmap& scene)
      : scene_(scene), known_(known_box(scene.header(), scene.header().directory_origin)) {
    if (scene.distances() == nullptr) return;
    unpacked_.emplace(*scene.distances());
    points_.reserve(kTogether);
    samples_.reserve(kTogether);
    field_ = field::make_force_field(Model::kDefault, ForceKind::kDistance, scene).value();
  }

  // At most kTogether points. The place of the first that is not finite, or kAllDone.
  std::int64_t sample(std::span<const std::array<double, 3>> points_m,
                      std::span<PointAnswer> answers) {
    points_.count = 0;
    for (std::size_t i = 0; i < points_m.size(); ++i) {
      const auto& p = points_m[i];
      if (!std::isfinite(p[0] + p[1] + p[2])) return static_cast<std::int64_t>(i);
      locate(i, p, answers[i]);
    }
    if (field_ && points_.count > 0) measure(answers);
    return kAllDone;
  }

 private:
  void locate(std::size_t i, const std::array<double, 3>& point_m, PointAnswer& out) {
    std::array<std::int64_t, 3> voxel{};
    std::array<float, 3> fraction{};
    out = {kNan, 0, {kNan, kNan, kNan}, 0, 0, true};
    const auto& origin = scene_.view().directory_origin;
    std::array<std::int64_t, 3> relative{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = std::clamp(point_m[axis] / scene_.voxel_size_m(), -kFarVoxels, kFarVoxels);
      const double whole = std::floor(at);
      voxel[axis] = static_cast<std::int64_t>(whole);
      fraction[axis] = std::min(static_cast<float>(at - whole), kBelowOne);
      relative[axis] = voxel[axis] - origin[axis];
      if (relative[axis] < known_.low[axis] || relative[axis] >= known_.high[axis]) {
        out.known = false;
      }
    }
    out.value = static_cast<std::uint8_t>(scene_.value(voxel[0], voxel[1], voxel[2]));
    if (!out.known) return;
    out.object = scene_.nearest_object(voxel[0], voxel[1], voxel[2]);
    if (out.value == 0) out.min_distance_m = free_distance_m(scene_.header());
    for (const std::int64_t at : relative) {
      if (at < 0 || at >= std::int64_t{1} << 30) return;
    }
    const auto x = static_cast<std::int32_t>(relative[0]),
               y = static_cast<std::int32_t>(relative[1]),
               z = static_cast<std::int32_t>(relative[2]);
    if (!field_ || !scene_.view().contains(x, y, z)) return;
    const int stored = stored_centers({x, y, z}, fraction);
    if (stored == 0 && out.value == 0) return;  // free space, which most points are in
    is_measured_[points_.count] = stored == 8;
    const std::uint32_t n = points_.count++;
    points_.index[n] = static_cast<std::uint32_t>(i);
    points_.value[n] = out.value;
    points_.vx[n] = x, points_.vy[n] = y, points_.vz[n] = z;
    points_.fx[n] = fraction[0], points_.fy[n] = fraction[1], points_.fz[n] = fraction[2];
    points_.nx[n] = points_.ny[n] = 0, points_.nz[n] = 1;
  }

  // How many of the eight centers around a point have a stored distance. None beyond a cropped
  // side.
  int stored_centers(const std::array<std::int32_t, 3>& voxel,
                     const std::array<float, 3>& fraction) {
    const DistanceView& distances = *scene_.distances();
    int stored = 0;
    for (int corner = 0; corner < 8; ++corner) {
      std::array<std::int32_t, 3> at{};
      bool is_known = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const int behind = corner >> (2 - axis) & 1;
        at[axis] = voxel[axis] + behind - (fraction[axis] < 0.5f ? 1 : 0);
        is_known = is_known && at[axis] >= known_.low[axis] && at[axis] < known_.high[axis];
      }
      if (!is_known || !distances.contains(at[0], at[1], at[2])) continue;
      const std::uint32_t code = unpacked_->code(at[0], at[1], at[2]);
      stored += code != 0 && code != kMaxDistanceCode;
    }
    return stored;
  }

  void measure(std::span<PointAnswer> answers) {
    field_->measure(points_, samples_);
    for (std::uint32_t n = 0; n < points_.count; ++n) {
      PointAnswer& out = answers[points_.index[n]];
      out.min_distance_m = std::max(out.min_distance_m, double{samples_.distance_m[n]});
      if (!is_measured_[n]) continue;
      out.distance_m = scene_.header().zero_force_m + double{samples_.from_zero_force_m[n]};
      out.gradient = {double{samples_.gx[n]}, double{samples_.gy[n]}, double{samples_.gz[n]}};
    }
  }

  const Voxmap& scene_;
  KnownBox known_;  // relative to the directory
  std::optional<UnpackedDistances> unpacked_;
  query::CollectedPoints points_;
  field::FieldSamples samples_;
  std::array<bool, kTogether> is_measured_{};  // by place in points_
  std::unique_ptr<field::ForceField> field_;   // none where no distances are stored
};

PointBatch::PointBatch(const Voxmap& scene) : scene_(scene) {}
PointBatch::~PointBatch() = default;

std::int64_t PointBatch::sample(std::span<const std::array<double, 3>> points_m, unsigned threads,
                                std::span<PointAnswer> answers, const KeepGoing& keep_going) {
  constexpr std::size_t kTogether = Reader::kTogether;
  const std::lock_guard lock(mutex_);
  const std::size_t workers =
      std::min<std::size_t>(thread_count(threads), points_m.size() / kTogether + 1);
  make_for_each(readers_, workers, [&] { return std::make_unique<Reader>(scene_); });
  return share_out(points_m.size(), workers, kTogether, keep_going,
                   [&](std::size_t worker, std::size_t begin, std::size_t end) {
                     for (std::size_t i = begin; i < end; i += kTogether) {
                       const std::size_t together = std::min(kTogether, end - i);
                       const std::int64_t bad = readers_[worker]->sample(
                           points_m.subspan(i, together), answers.subspan(i, together));
                       if (bad != kAllDone) return static_cast<std::int64_t>(i) + bad;
                     }
                     return kAllDone;
                   });
}

}  // namespace forcelayer::python
