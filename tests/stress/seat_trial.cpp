#include "tests/stress/seat_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include "forcelayer/run.h"
#include "runtime/coupling/coupling.h"
#include "runtime/model/simulation.h"
#include "tests/stress/baked.h"
#include "tests/stress/exact_distance.h"
#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

constexpr double kDt = 0.001;
constexpr double kSampleVoxels = 0.25;
constexpr int kDepthEvery = 10, kTouchEvery = 100;  // frames

glm::dvec3 vertex(const mesh::Mesh& mesh, std::uint32_t index) {
  const auto& v = mesh.vertices[index];
  return {v[0], v[1], v[2]};
}

// Places along a line, both ends too.
void sample_line(const glm::dvec3& a, const glm::dvec3& b, double spacing_m,
                 std::vector<glm::dvec3>& out) {
  const int parts = std::max(1, static_cast<int>(std::ceil(glm::length(b - a) / spacing_m)));
  for (int i = 0; i <= parts; ++i) out.push_back(a + (b - a) * (i / static_cast<double>(parts)));
}

// Places all over a surface: rows along the longest edge of every triangle.
std::vector<glm::dvec3> surface_samples(const mesh::Mesh& mesh, double spacing_m) {
  std::vector<glm::dvec3> out;
  for (const mesh::Triangle& t : mesh.triangles) {
    std::array<glm::dvec3, 3> p{vertex(mesh, t[0]), vertex(mesh, t[1]), vertex(mesh, t[2])};
    const auto edge = [&](std::size_t n) { return glm::length(p[(n + 1) % 3] - p[n]); };
    std::size_t longest = 0;
    for (std::size_t n = 1; n < 3; ++n) longest = edge(n) > edge(longest) ? n : longest;
    std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(longest), p.end());
    const double height_m =
        glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) / std::max(1e-300, edge(0));
    const int rows = std::max(1, static_cast<int>(std::ceil(height_m / spacing_m)));
    for (int row = 0; row <= rows; ++row) {
      const double up = row / static_cast<double>(rows);
      sample_line(p[0] + up * (p[2] - p[0]), p[1] + up * (p[2] - p[1]), spacing_m, out);
    }
  }
  return out;
}

// Places along the edges of a mesh at which it bends by more than twenty degrees, and at which it
// ends: what can dig into a face of the other.
std::vector<glm::dvec3> edge_samples(const mesh::Mesh& mesh, double spacing_m) {
  constexpr double kFlat = 0.94;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<glm::dvec3>> normals;
  for (const mesh::Triangle& t : mesh.triangles) {
    const glm::dvec3 a = vertex(mesh, t[0]), b = vertex(mesh, t[1]), c = vertex(mesh, t[2]);
    const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
    for (std::size_t n = 0; n < 3; ++n) {
      normals[std::minmax(t[n], t[(n + 1) % 3])].push_back(normal);
    }
  }
  std::vector<glm::dvec3> out;
  for (const auto& [edge, faces] : normals) {
    if (faces.size() == 2 && glm::dot(faces[0], faces[1]) > kFlat) continue;
    sample_line(vertex(mesh, edge.first), vertex(mesh, edge.second), spacing_m, out);
  }
  return out;
}

// Places, and a sphere around each few of them: depth changes by no more than the way.
class Samples {
 public:
  explicit Samples(std::vector<glm::dvec3> places) : places_(std::move(places)) {
    for (std::size_t first = 0; first < places_.size(); first += kGroup) {
      const std::size_t end = std::min(places_.size(), first + kGroup);
      const glm::dvec3 middle = 0.5 * (places_[first] + places_[end - 1]);
      double radius_m = 0;
      for (std::size_t i = first; i < end; ++i) {
        radius_m = std::max(radius_m, glm::length(places_[i] - middle));
      }
      spheres_.push_back({middle, radius_m});
    }
  }

  // The larger of `depth_m` and the depth of the deepest place in a solid.
  double deepest_m(const std::function<double(const glm::dvec3&)>& depth_in_solid_m,
                   const Pose& solid_from_places, double depth_m) const {
    const auto at = [&](const glm::dvec3& place) {
      return depth_in_solid_m(solid_from_places.position_m + solid_from_places.orientation * place);
    };
    for (std::size_t n = 0; n < spheres_.size(); ++n) {
      if (at(spheres_[n].middle) + spheres_[n].radius_m <= depth_m) continue;
      const std::size_t end = std::min(places_.size(), (n + 1) * kGroup);
      for (std::size_t i = n * kGroup; i < end; ++i) depth_m = std::max(depth_m, at(places_[i]));
    }
    return depth_m;
  }

 private:
  static constexpr std::size_t kGroup = 16;
  struct Sphere {
    glm::dvec3 middle;
    double radius_m;
  };
  std::vector<glm::dvec3> places_;
  std::vector<Sphere> spheres_;
};

mesh::Mesh moved(const mesh::Mesh& mesh, const Pose& pose) {
  mesh::Mesh result;
  append(result, mesh, pose);
  return result;
}

// The handle's way at random about where the part is installed.
Pose wandering(const Pose& start, double time_s, const std::array<glm::dvec3, 4>& phases) {
  const auto wave = [&](std::size_t n, double hz) {
    const glm::dvec3 turns = 2 * M_PI * (hz * time_s + phases[n]);
    return glm::dvec3(std::sin(turns.x), std::sin(1.3 * turns.y), std::sin(0.7 * turns.z)) -
           glm::dvec3(std::sin(2 * M_PI * phases[n].x), std::sin(1.3 * 2 * M_PI * phases[n].y),
                      std::sin(0.7 * 2 * M_PI * phases[n].z));
  };
  const double ramp = std::min(1.0, 2 * time_s);
  return {
      start.position_m + ramp * 0.008 * (wave(0, 0.5) + 0.4 * wave(1, 2.1)),
      coupling::rotation_by(ramp * 0.15 * (wave(2, 0.4) + 0.4 * wave(3, 1.7))) * start.orientation};
}

class SeatTrial {
 public:
  SeatTrial(const InstalledPair& pair, double covering_voxels)
      : pair_(pair),
        start_(pair.world_from_pair * pair.pair_from_part),
        part_samples_(surface_samples(pair.part, kSampleVoxels * pair.voxel_size_m)),
        scene_samples_(edge_samples(pair.scene, kSampleVoxels * pair.voxel_size_m)),
        exact_(pair.scene, pair.part) {
    const BakedScene scene(moved(pair.scene, pair.world_from_pair), pair.voxel_size_m);
    const BakedPart part(pair.part, pair.voxel_size_m, covering_voxels * pair.voxel_size_m);
    RunRequest request;
    request.without_guarantee = true;
    auto run = open_run(scene.open(test::VoxelKind::kFull), part.open(), request);
    if (!run) throw std::runtime_error(to_line(run.error()));
    simulation_ = run->release_simulation();
  }

  SeatOutcome run(std::uint64_t seed, double push_seconds) {
    SeatOutcome out;
    if (const Status begun = begin(); !begun) {
      out.refused = to_line(begun.error());
      return out;
    }
    see_depth(out);
    out.start_depth = std::max(out.depth, out.edge_depth);
    out.depth = out.edge_depth = 0;
    hold_still(out);
    push_at_random(seed, push_seconds, out);
    take_out(out);
    put_back(out);
    return out;
  }

 private:
  // Takes hold where the part is installed.
  Status begin() {
    PartStart start;
    start.world_from_part = start_;
    auto begun = simulation_->begin(start, start_);
    if (!begun) return begun.error();
    state_ = *begun;
    input_ = {};
    input_.world_from_handle = start_;
    input_.valid = kInputValid;
    return {};
  }
  void begin_again() {
    if (const Status begun = begin(); !begun) throw std::runtime_error(to_line(begun.error()));
  }

  StepResult step_to(const Pose& handle) {
    const Pose& last = input_.world_from_handle;
    input_.handle_velocity = {
        (handle.position_m - last.position_m) / kDt,
        coupling::rotation_vector(handle.orientation * glm::conjugate(last.orientation)) / kDt};
    input_.world_from_handle = handle;
    return simulation_->step(state_, input_, kDt);
  }

  Pose pair_from_part() const {
    return inverse(pair_.world_from_pair) * simulation_->world_from_part(state_.world_from_center);
  }

  // Keeps the most of how deep the part's surface lies in the scene, beyond the start, and the
  // scene's sharp edges in the part; voxels. Returns the deeper one, or 0.
  double see_depth(SeatOutcome& out) const {
    const double s = pair_.voxel_size_m;
    const Pose there = pair_from_part();
    const double depth =
        part_samples_.deepest_m(pair_.depth_in_scene_m, there, out.start_depth * s) / s -
        out.start_depth;
    const double edge_depth =
        scene_samples_.deepest_m(pair_.depth_in_part_m, inverse(there), out.start_depth * s) / s -
        out.start_depth;
    out.depth = std::max(out.depth, depth);
    out.edge_depth = std::max(out.edge_depth, edge_depth);
    return std::max(depth, edge_depth);
  }

  // The farthest that a shell point can be from where it is installed, voxels.
  double moved_voxels() const {
    const Pose now = simulation_->world_from_part(state_.world_from_center);
    const Pose from_start = now * inverse(start_);
    const glm::dvec3 center = simulation_->world_from_center(start_).position_m;
    const glm::dvec3 there = from_start.position_m + from_start.orientation * center;
    const double radius_m = simulation_->shell().header().bounding_radius_m;
    return (glm::length(there - center) +
            glm::length(coupling::rotation_vector(from_start.orientation)) * radius_m) /
           pair_.voxel_size_m;
  }

  void hold_still(SeatOutcome& out) {
    begin_again();
    for (int i = 0; i < 500; ++i) {
      const StepResult result = step_to(start_);
      out.still_force_n = std::max(out.still_force_n, glm::length(result.wrench.force_n));
      out.drift = std::max(out.drift, moved_voxels());
    }
  }

  // Hands of two seconds, each with a way of its own; a seat that was left is taken anew.
  void push_at_random(std::uint64_t seed, double seconds, SeatOutcome& out) {
    constexpr int kHandFrames = 2000;
    std::mt19937_64 engine(seed + 1000);
    const int frames = static_cast<int>(seconds / kDt);
    int seen = 0, deep = 0, looked = 0, touching = 0, hand = 0;
    std::array<glm::dvec3, 4> phases;
    for (int i = 0; i < frames; ++i, ++hand) {
      if (i == 0 || hand == kHandFrames || state_.seat == kSeatClosed) {
        begin_again();
        hand = 0;
        for (glm::dvec3& phase : phases) {
          for (int axis = 0; axis < 3; ++axis) {
            phase[axis] = std::uniform_real_distribution<double>(-1, 1)(engine);
          }
        }
      }
      step_to(wandering(start_, hand * kDt, phases));
      if (i % kDepthEvery != 0) continue;
      const double depth = see_depth(out);
      out.pushed_depth = std::max(out.pushed_depth, depth);
      ++seen;
      deep += depth > kDeepVoxels;
      if (i % kTouchEvery != 0) continue;
      ++looked;
      touching += exact_.at(pair_from_part(), pair_.voxel_size_m) == 0;
    }
    out.deep = deep / static_cast<double>(std::max(1, seen));
    out.touching = touching / static_cast<double>(std::max(1, looked));
  }

  void take_out(SeatOutcome& out) {
    begin_again();
    constexpr double kSpeed = 0.03;
    const glm::dvec3 way = pair_.world_from_pair.orientation * glm::dvec3(0, 0, 1);
    const int frames = static_cast<int>(pair_.removal_m / kSpeed / kDt);
    for (int i = 0; i <= frames + 500; ++i) {
      Pose handle = start_;
      handle.position_m += std::min(i, frames) * kDt * kSpeed * way;
      step_to(handle);
      if (i % kDepthEvery == 0) see_depth(out);
    }
    const double went_m = glm::dot(
        state_.world_from_center.position_m - simulation_->world_from_center(start_).position_m,
        way);
    out.came_out =
        went_m > pair_.removal_m - 0.5 * pair_.voxel_size_m && state_.seat == kSeatClosed;
  }

  // Half of the force layer out, and back: the seat is open all the while.
  void put_back(SeatOutcome& out) {
    begin_again();
    const glm::dvec3 way =
        1.5 * pair_.voxel_size_m * (pair_.world_from_pair.orientation * glm::dvec3(0, 0, 1));
    constexpr int kFrames = 1000;
    for (int i = 0; i <= 2 * kFrames + 500; ++i) {
      Pose handle = start_;
      const double fraction = i < kFrames ? i / double{kFrames} : 2 - i / double{kFrames};
      handle.position_m += std::max(0.0, fraction) * way;
      step_to(handle);
      if (i % kDepthEvery == 0) see_depth(out);
      if (state_.seat == kSeatClosed) return;
    }
    out.tried_back = true;
    out.held = moved_voxels();
    out.went_back = out.held < 0.3;
  }

  const InstalledPair& pair_;
  Pose start_;
  Samples part_samples_, scene_samples_;
  ExactDistance exact_;
  std::unique_ptr<model::Simulation> simulation_;
  State state_;
  StepInput input_;
};

}  // namespace

SeatOutcome try_seat(const InstalledPair& pair, std::uint64_t seed, double push_seconds,
                     double covering_voxels) {
  return SeatTrial(pair, covering_voxels).run(seed, push_seconds);
}

}  // namespace forcelayer::stress
