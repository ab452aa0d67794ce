#include "tests/bench/wrench_bench_case.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "tests/bench/wrench_bench_contacts.h"
#include "tests/support/curve_order.h"

namespace forcelayer::bench {
namespace {

constexpr double kSlideMps = 0.05, kFrameS = 0.001;
constexpr int kSlideFrames = 400;

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

glm::dmat3 turn(double angle, const glm::dvec3& axis) {
  return glm::mat3_cast(glm::angleAxis(angle, axis));
}

glm::dmat3 any_turn(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return glm::mat3_cast(
      glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random))));
}

// Moves the points of `shell` that lie within `reach_m` in front of the body at this pose.
AnalyticShell near_points(const AnalyticShell& shell, const std::function<double(glm::dvec3)>& at,
                          double reach_m, double mean_area_m2) {
  AnalyticShell near;
  near.radius_m = shell.radius_m;
  for (std::size_t i = 0; i < shell.points_m.size(); ++i) {
    if (at(shell.points_m[i]) > reach_m) continue;
    near.points_m.push_back(shell.points_m[i]);
    near.normals.push_back(shell.normals[i]);
    near.areas_m2.push_back(shell.areas_m2[i] / mean_area_m2);
  }
  return near;
}

// In the order of a space-filling curve, as pointshell writes shells.
AnalyticShell along_curve(const AnalyticShell& shell) {
  const auto order = test::curve_order(shell.points_m, shell.radius_m);
  AnalyticShell sorted = shell;
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.points_m[i] = shell.points_m[order[i]];
    sorted.normals[i] = shell.normals[order[i]];
    sorted.areas_m2[i] = shell.areas_m2[order[i]];
  }
  return sorted;
}

}  // namespace

ContactCase::ContactCase(const Combination& combination, const PartShells& shells,
                         double voxel_size_m, std::mt19937_64& random, VoxelKind kind)
    : combination_(combination),
      kind_(kind),
      s_(voxel_size_m),
      tested_(shells.tested),
      fine_(shells.fine),
      part_radius_m_(shells.tested.radius_m) {
  orient(random);
  if (combination.wall_by_wall) offset_walls();
  const double touching = height_at(0.5 * s_);
  glm::dvec3 normal(0);
  double smallest = 1e9;
  const Placed at = place(touching, 0, 0);
  for (const auto& p : fine_.points_m) {
    glm::dvec3 g;
    const double d = body_.distance_m(at.rotation * p + at.position_m, &g);
    if (d < smallest) smallest = d, normal = g;
  }
  if (combination.body == StaticKind::kWedge && combination.free_angle < M_PI) {
    const int steeper = norm1(body_.wall_normal(0)) > norm1(body_.wall_normal(1)) ? 0 : 1;
    normal = body_.wall_normal(steeper);
    rate_ = 1 / std::sin(combination.free_angle / 2);
  }
  thickness_m_ = norm1(normal) * s_;
  middle_m_ = zero_force_voxels(kind_, kLayers, normal) * s_;
  for (std::size_t d = 0; d < kDepths; ++d) {
    depths_m_.push_back((0.5 - (static_cast<double>(d) + 0.5) / kDepths) * thickness_m_);
    heights_m_.push_back(height_at(middle_m_ - depths_m_.back()));
  }
  const double mean_area_m2 = tested_.area_m2 / static_cast<double>(tested_.points_m.size());
  const auto distance = [&](glm::dvec3 p) {
    return body_.distance_m(at.rotation * p + at.position_m);
  };
  tested_ = near_points(tested_, distance, 9 * s_, mean_area_m2);
  fine_ = near_points(fine_, distance, 9 * s_, mean_area_m2);
  tested_ = along_curve(tested_);
  for (std::size_t i = 0; i < kShifts; ++i) {
    shifts_m_.push_back({uniform(random, -1, 1) * s_, uniform(random, -1, 1) * s_});
  }
  bake_around();
  tabulate_truth();
}

void ContactCase::orient(std::mt19937_64& random) {
  body_.kind = combination_.body;
  body_.radius_m = combination_.radius_m;
  body_.free_angle = combination_.free_angle;
  body_.rotation = any_turn(random);
  for (int axis = 0; axis < 3; ++axis) body_.origin_m[axis] = uniform(random, 0, 1) * s_;
  if (body_.kind == StaticKind::kBore) approach_ = {-1, 0, 0};
  const glm::dmat3 spin = turn(uniform(random, 0, 2 * M_PI), {0, 0, 1});
  const glm::dmat3 roll = turn(uniform(random, 0, 2 * M_PI), {0, 0, 1});
  switch (combination_.stance) {
    case Stance::kAnyWay:
      part_rotation_ = any_turn(random);
      break;
    case Stance::kFaceDown:
      part_rotation_ = spin;
      if (combination_.part == Part::kCylinder) part_rotation_ *= turn(M_PI / 2, {0, 1, 0}) * roll;
      if (combination_.part == Part::kCone) {
        part_rotation_ *= turn(M_PI / 2 + kConeHalfAngle, {0, 1, 0}) * roll;
      }
      break;
    case Stance::kCapDown:
      break;
    case Stance::kAlongBore:
      part_rotation_ = spin;
      break;
    case Stance::kAlongWedge:
      part_rotation_ = turn(M_PI / 2, {1, 0, 0}) * roll;
      break;
    case Stance::kEdgeDown:
      part_rotation_ = turn(M_PI / 4, {0, 1, 0});
      break;
  }
}

// Standoffs differ from wall to wall (zero_force_voxels()): the exact offset surface takes that
// over, and the approach starts where the two offset walls meet, so that both are reached at once.
void ContactCase::offset_walls() {
  const glm::dvec3 n0 = body_.wall_normal(0), n1 = body_.wall_normal(1);
  const double l0 = zero_force_voxels(kind_, kLayers, n0),
               l1 = zero_force_voxels(kind_, kLayers, n1);
  const double largest = std::max(l0, l1);
  body_.wall_shift_m = {(largest - l0) * s_, (largest - l1) * s_};
  const double sine = std::cos(combination_.free_angle / 2);
  const double cosine = std::sin(combination_.free_angle / 2);
  // Where -sine x + cosine z = -shift 0 and sine x + cosine z = -shift 1.
  base_m_.x = (body_.wall_shift_m[0] - body_.wall_shift_m[1]) / (2 * sine);
  base_m_.z = -(body_.wall_shift_m[0] + body_.wall_shift_m[1]) / (2 * cosine);
}

double ContactCase::min_distance(double height_m) const {
  const Placed at = place(height_m, 0, 0);
  double smallest = 1e9;
  for (const auto& p : fine_.points_m) {
    smallest = std::min(smallest, body_.distance_m(at.rotation * p + at.position_m));
  }
  return smallest;
}

// The height at which the part's nearest point has this distance, by bisection.
double ContactCase::height_at(double distance_m) const {
  const double r = combination_.radius_m;
  double low = 0, high = 1;
  if (body_.kind == StaticKind::kSphere) low = r, high = r + 1;
  if (body_.kind == StaticKind::kBore) low = -r, high = 0;
  if (!heights_m_.empty()) low = heights_m_.front(), high = low + 2 * thickness_m_ * rate_;
  for (int i = 0; i < 28; ++i) {
    const double middle = (low + high) / 2;
    (min_distance(middle) < distance_m ? low : high) = middle;
  }
  return high;
}

void ContactCase::bake_around() {
  const double slide = 0.5 * kSlideFrames * kSlideMps * kFrameS + 2 * s_;
  glm::dvec3 low(1e9), high(-1e9);
  for (const double a : {-slide, 0.0, slide})
    for (const double b : {-slide, 0.0, slide}) {
      const Placed at = place(heights_m_[0], a, b);
      for (const auto& p : tested_.points_m) {
        const glm::dvec3 x = at.rotation * p + at.position_m;
        low = glm::min(low, x), high = glm::max(high, x);
      }
    }
  AnalyticStatic surface = body_;
  surface.wall_shift_m = glm::dvec2(0);
  scene_ = std::make_unique<test::VoxelScene>(
      bake(kind_, surface, s_, kLayers, low - 2 * s_, high + 2 * s_));
  voxmap_ = std::make_unique<Voxmap>(test::make_voxmap(*scene_));
  dense_ = std::make_unique<DenseFields>(body_, *scene_);
}

// The body looks the same after any of these motions, so what is true stays true: a and b along
// the surface.
glm::dmat3 ContactCase::symmetry(double a_m, double b_m) const {
  if (body_.kind == StaticKind::kSphere) {
    return turn(a_m / body_.radius_m, {0, 1, 0}) * turn(b_m / body_.radius_m, {1, 0, 0});
  }
  if (body_.kind == StaticKind::kBore) return turn(a_m / body_.radius_m, {0, 0, 1});
  return glm::dmat3(1);
}

ContactCase::Placed ContactCase::place(double height_m, double a_m, double b_m) const {
  const glm::dmat3 moved = symmetry(a_m, b_m);
  glm::dvec3 position = moved * (base_m_ + approach_ * height_m);
  if (body_.kind == StaticKind::kPlane) position += glm::dvec3(a_m, b_m, 0);
  if (body_.kind == StaticKind::kBore) position.z += b_m;
  if (body_.kind == StaticKind::kWedge) position.y += a_m;
  return {body_.rotation * moved * part_rotation_, body_.rotation * position + body_.origin_m};
}

void ContactCase::tabulate_truth() {
  const glm::dmat3 local = glm::transpose(body_.rotation);
  const double first_m = middle_m_ - 1.5 * thickness_m_;
  for (const double height : heights_m_) {
    const Placed at = place(height, 0, 0);
    std::vector<SurfaceSample> samples;
    for (std::size_t i = 0; i < fine_.points_m.size(); ++i) {
      const glm::dvec3 arm = at.rotation * fine_.points_m[i];
      glm::dvec3 g;
      const double d = body_.distance_m(arm + at.position_m, &g);
      samples.push_back({d, fine_.areas_m2[i], local * g, local * arm});
    }
    truth_.emplace_back(samples, first_m, first_m + 3 * thickness_m_);
  }
}

// How far the slide has gone at a frame, along a and b.
std::array<double, 2> ContactCase::along_slide(int frame) const {
  const double along = (frame - 0.5 * kSlideFrames) * kSlideMps * kFrameS;
  if (body_.kind == StaticKind::kWedge) return {along, 0};
  return {0.8 * along, 0.6 * along};
}

std::vector<ContactCase::Placed> ContactCase::slide() const {
  const double height = height_at(middle_m_ - 0.3 * thickness_m_);
  std::vector<Placed> frames;
  for (int i = 0; i < kSlideFrames; ++i) {
    const auto [a, b] = along_slide(i);
    frames.push_back(place(height, a, b));
  }
  return frames;
}

glm::dvec3 ContactCase::out() const {
  const auto [a, b] = along_slide(0);
  return body_.rotation * symmetry(a, b) * approach_;
}

Quality ContactCase::judge(const WrenchAt& wrench_at, std::size_t shifts, LoadOfTruth load) const {
  Measured measured(kDepths);
  for (std::size_t d = 0; d < kDepths; ++d)
    for (std::size_t i = 0; i < shifts; ++i) {
      const auto [a, b] = shifts_m_[i];
      const Wrench w = wrench_at(place(heights_m_[d], a, b));
      const glm::dmat3 back = glm::transpose(body_.rotation * symmetry(a, b));
      measured[d].push_back({back * w.force_n, back * w.torque_nm});
    }
  std::vector<double> offsets_m;
  const double first_m = truth_[0].first_m;
  for (double at = first_m; at < first_m + 3 * thickness_m_; at += 0.01 * s_) {
    offsets_m.push_back(at);
  }
  const TruthAt true_wrench = [&](std::size_t d, double at) {
    return true_wrench_at(truth_[d], at, load);
  };
  return judged(measured, true_wrench, {middle_m_, depths_m_, s_ / 4}, offsets_m, part_radius_m_);
}

}  // namespace forcelayer::bench
