#include "workbench/exact/exact_check.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <memory>

#include "formats/command/progress_line.h"
#include "formats/command/text.h"
#include "runtime/clearance/center_path.h"
#include "runtime/run/baked_files.h"
#include "runtime/voxcheck/path_source.h"
#include "workbench/exact/exact_walk.h"
#include "workbench/exact/seat_meshes.h"
#include "workbench/exact/seat_walk.h"
#include "workbench/exact/stored_side.h"
#include "workbench/exact/surfaces.h"

namespace forcelayer::exact {
namespace {

using voxcheck::ExactAnswer;
using voxcheck::ExactMoment;
using voxcheck::ExactRequest;
using voxcheck::ExactSeat;
using voxcheck::ExactViolation;

// In voxels: resolution of the least distance, and where a stretch begins and ends.
constexpr double kWithinVoxels = 1e-3, kResolutionVoxels = 1.0 / 64;
// Resolution of a depth elsewhere than in a seat.
constexpr double kDepthVoxels = 1.0 / 32;
constexpr int kMomentsDeep = 4;  // steps of a stretch in which surfaces meet

class ExactCheck {
 public:
  ExactCheck(const ExactRequest& request, const Voxmap& voxmap, const Pshell& shell,
             const std::vector<PathRow>& rows, const Surface& scene, const Surface& part,
             command::ProgressLine& line)
      : request_(request),
        side_of_part_(voxmap, shell),
        line_(line),
        rows_(rows),
        part_(part),
        voxel_m_(voxmap.voxel_size_m()),
        center_m_(shell.header().center_m[0], shell.header().center_m[1],
                  shell.header().center_m[2]),
        rounding_m_(kRounding * largest_m(scene, part)),
        margin_m_(rounding_m_ + scene.deviation_m + part.deviation_m),
        baked_margin_m_(rounding_m_ + voxmap.header().static_deviation_m + part.deviation_m),
        all_(without(scene, request.allowed)),
        other_(without(all_, request.seat)),
        everything_(all_, part),
        seated_(other_, part),
        path_(rows, center_m_, radius_m(part)),
        walk_(path_, everything_, seated_, rounding_m_) {}

  Result<ExactAnswer> answer() {
    ExactAnswer answer;
    answer.margin_m = margin_m_;
    if (Status sound = hold_against_files(); !sound) return sound.error();
    add_violations(answer);
    add_seat(answer);
    add_seated(answer);
    walk_.tell(shown("measuring the least clearance", 0, 1));
    add_least(answer);
    answer.moments += walk_.measured();
    if (const auto& found = walk_.contradiction()) {
      return contradiction(found->time_s, found->exact_m, "prove", found->proven_m);
    }
    return answer;
  }

 private:
  Error contradiction(double time_s, double exact_m, const char* say, double said_m) const {
    return Error{ErrorCode::kFilesDoNotMatch, request_.scene, "--exact",
                 command::text("at %.3f s the meshes are %.6f mm apart, and the files %s %.6f mm: "
                               "they were baked from others",
                               time_s, 1e3 * exact_m, say, 1e3 * said_m),
                 "name the inputs of the bakes, and their units"};
  }

  // An error where the meshes are nearer than the files prove, or farther than they say. Of the
  // distance to fewer objects than all, the upper bound holds for all the more.
  Status hold_against_files() {
    for (const voxcheck::ProvenMoment& said : request_.moments) {
      const Moment moment = path_.at(said.time_s);
      const double counted_m = walk_.at(moment, said.seated).measured.distance_m;
      if (counted_m + rounding_m_ < said.min_m) {
        return contradiction(said.time_s, counted_m, "prove", said.min_m);
      }
      const double exact_m = walk_.at(moment, false).measured.distance_m;
      if (exact_m > said.max_m + rounding_m_ && !lies_inside(moment, exact_m, false)) {
        return contradiction(said.time_s, exact_m, "say at most", said.max_m);
      }
    }
    return {};
  }

  // Where some objects do not count, a mesh that counts has to hold the point: deep inside, the
  // scene does not tell of which object.
  bool lies_inside(const Moment& moment, double distance_m, bool seated) {
    const bool all_count = request_.allowed.empty() && !seated;
    return side_of_part_.is_inside(
        path_.world_from_center(moment), distance_m, baked_margin_m_,
        [&](const glm::dvec3& place_m) { return all_count || is_held(place_m, seated); });
  }

  // Whether a place lies inside of a solid object that counts.
  bool is_held(const glm::dvec3& place_m, bool seated) {
    if (boxes_.empty()) find_boxes();
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const auto& entry) {
      const auto& [object, box] = entry;
      const auto& seat = request_.seat;
      if (seated && std::find(seat.begin(), seat.end(), object) != seat.end()) return false;
      if (glm::any(glm::lessThan(place_m, box.low_m))) return false;
      if (glm::any(glm::greaterThan(place_m, box.high_m))) return false;
      const Bodies& bodies = other_of(object).bodies;
      return are_solid(bodies) && std::any_of(bodies.begin(), bodies.end(), [&](const auto& body) {
               return body->holds(vec3_of(place_m));
             });
    });
  }

  void find_boxes() {
    for (std::size_t n = 0; n < all_.triangles.size(); ++n) {
      const glm::dvec3& first = all_.vertices_m[all_.triangles[n][0]];
      Box& box = boxes_.try_emplace(all_.object[n], Box{first, first}).first->second;
      for (const auto vertex : all_.triangles[n]) {
        box.low_m = glm::min(box.low_m, all_.vertices_m[vertex]);
        box.high_m = glm::max(box.high_m, all_.vertices_m[vertex]);
      }
    }
  }

  // Shows task `n` of some on the terminal.
  Progress shown(const char* stage, std::size_t n, std::size_t tasks) {
    const auto whole = static_cast<double>(tasks);
    return [this, stage, n, whole](double fraction) {
      line_.show(stage, (static_cast<double>(n) + std::clamp(fraction, 0.0, 1.0)) / whole);
    };
  }

  static double radius_m(const Surface& part) {
    double radius = 0;
    for (const glm::dvec3& vertex : part.vertices_m) radius = std::max(radius, glm::length(vertex));
    return radius;
  }
  // The largest coordinate in any computation, the part at its farthest on the path included.
  double largest_m(const Surface& scene, const Surface& part) const {
    double largest = std::max(scene.largest_m, part.largest_m);
    for (const PathRow& row : rows_) {
      for (const double x : row.position_m) {
        largest = std::max(largest, std::abs(x) + part.largest_m);
      }
    }
    return largest;
  }

  Piece piece_of(const voxcheck::ProvenStretch& stretch) const {
    return {path_.at(stretch.from_s), path_.at(stretch.to_s), stretch.proven_m, stretch.seated};
  }

  ExactMoment exact_moment(const Sample& sample) const {
    const MeshDistance& m = sample.measured;
    ExactMoment moment{path_.time_s(sample.moment),
                       std::min(m.distance_m, voxcheck::kNothingM),
                       0,
                       {m.part_m.x, m.part_m.y, m.part_m.z},
                       {m.scene_m.x, m.scene_m.y, m.scene_m.z}};
    const Surface& surface = sample.seated ? other_ : all_;
    if (m.scene_triangle < surface.object.size()) moment.object = surface.object[m.scene_triangle];
    return moment;
  }

  // Pieces that follow each other, in which the part is too near.
  struct Near {
    std::vector<Piece> pieces;
    std::optional<Sample> inside;  // a moment at which it lies inside of a solid
  };

  void add_violation(Near near, ExactAnswer& answer) {
    ExactViolation violation;
    violation.from_s = path_.time_s(near.pieces.front().from);
    violation.to_s = path_.time_s(near.pieces.back().to);
    violation.inside = near.inside.has_value();
    Sample worst;
    if (near.inside) {
      worst = *near.inside;
      worst.measured.distance_m = 0;
    } else {
      const auto smallest = walk_.smallest(std::move(near.pieces), kWithinVoxels * voxel_m_);
      violation.clearance_m = std::max(0.0, smallest.at_least_m - margin_m_);
      worst = smallest.sample;
    }
    violation.worst = exact_moment(worst);
    violation.graze =
        !violation.meets() && violation.worst.exact_m >= request_.required_m - rounding_m_;
    take(worst);
    if (violation.meets()) look_into(violation);
    answer.violations.push_back(violation);
  }

  // Where the surfaces meet: how deep they lie in each other, at the deepest of some moments.
  void look_into(ExactViolation& violation) {
    Other& other = other_of(violation.worst.object);
    if (!are_solid(part_bodies()) || !are_solid(other.bodies)) return;
    const SeatWalk walk(path_, part_bodies(), other.bodies, other.distance,
                        kDepthVoxels * voxel_m_);
    const double from_s = violation.from_s, to_s = violation.to_s;
    std::vector<double> moments_s{violation.worst.time_s};
    for (int n = 0; n <= kMomentsDeep; ++n) {
      moments_s.push_back(std::lerp(from_s, to_s, static_cast<double>(n) / kMomentsDeep));
    }
    for (const double time_s : moments_s) {
      const Depth depth = walk.at_pose(path_.world_from_center(path_.at(time_s)), 0);
      if (depth.found_m <= violation.depth_m) continue;
      violation.depth_m = depth.found_m;
      violation.max_depth_m = depth.at_most_m;
      violation.worst = deepest_moment(time_s, violation.worst.object, depth);
    }
  }

  static ExactMoment deepest_moment(double time_s, std::uint32_t object, const Depth& depth) {
    const glm::dvec3 &part = depth.place_m, &foot = depth.foot_m;
    return {time_s, 0, object, {part.x, part.y, part.z}, {foot.x, foot.y, foot.z}};
  }

  // An object of the scene by itself.
  struct Other {
    Other(Surface own, const Surface& part, double crack_m)
        : surface(std::move(own)), bodies(bodies_of(surface, crack_m)), distance(surface, part) {}
    Surface surface;
    Bodies bodies;
    MeshPair distance;
  };
  Other& other_of(std::uint32_t object) {
    auto& other = others_[object];
    if (!other) {
      other = std::make_unique<Other>(only(all_, object), part_, kCrackVoxels * voxel_m_);
    }
    return *other;
  }

  const Bodies& part_bodies() {
    if (part_bodies_.empty()) part_bodies_ = bodies_of(part_, kCrackVoxels * voxel_m_);
    return part_bodies_;
  }

  void take(const Sample& sample) {
    const auto distance = [](const Sample& s) { return s.measured.distance_m; };
    if (!nearest_ || distance(sample) < distance(*nearest_)) nearest_ = sample;
  }

  // The pieces of a stretch in which the part is too near by the meshes, and those in which it lies
  // inside of a solid.
  std::vector<Near> near_pieces(const Piece& whole) {
    std::vector<Near> near;
    Moment begin = whole.from;
    const auto look_until = [&](const Moment& end, bool is_all) {
      if (path_.time_s(begin) >= path_.time_s(end) && !is_all) return;
      if (const auto& inside = inside_between(begin, end, whole.seated)) {
        near.push_back({{{begin, end, 0, whole.seated}}, inside});
      }
    };
    for (const Piece& piece :
         walk_.nearer_than(whole, request_.required_m + margin_m_, kResolutionVoxels * voxel_m_)) {
      look_until(piece.from, false);
      near.push_back({{piece}, {}});
      begin = piece.to;
      side_.reset();
    }
    look_until(whole.to, near.empty());
    return near;
  }

  // A moment at which the part lies inside of a solid, between two between which it is not too
  // near: there its side does not change, and none since it was last found.
  const std::optional<Sample>& inside_between(const Moment& from, const Moment& to, bool seated) {
    if (!side_ || side_->until_s != path_.time_s(from) || side_->seated != seated) {
      const Sample& middle = walk_.at(path_.middle(from, to), seated);
      side_ = Side{0, seated, {}};
      if (lies_inside(middle.moment, middle.measured.distance_m, seated)) side_->inside = middle;
    }
    side_->until_s = path_.time_s(to);
    return side_->inside;
  }

  // Cuts the stretches that are too near by the files down to those that are by the meshes.
  void add_violations(ExactAnswer& answer) {
    Near so_far;
    for (std::size_t n = 0; n < request_.stretches.size(); ++n) {
      const voxcheck::ProvenStretch& stretch = request_.stretches[n];
      if (!stretch.too_near) continue;
      walk_.tell(shown("measuring the clearance", n, request_.stretches.size()));
      for (Near& near : near_pieces(piece_of(stretch))) {
        const Piece& piece = near.pieces.front();
        auto& pieces = so_far.pieces;
        const bool follows = !pieces.empty() && pieces.back().seated == piece.seated &&
                             path_.time_s(pieces.back().to) == path_.time_s(piece.from);
        if (!follows && !pieces.empty()) add_violation(std::move(so_far), answer), so_far = {};
        pieces.push_back(piece);
        if (near.inside) so_far.inside = near.inside;
      }
    }
    if (!so_far.pieces.empty()) add_violation(std::move(so_far), answer);
  }

  // Settles the objects of the seat: how deep the part goes into them while it is there.
  void add_seat(ExactAnswer& answer) {
    if (request_.seated.empty() || request_.seat.empty()) return;
    for (const std::uint32_t object : request_.seat) {
      const Other& other = other_of(object);
      if (!other.surface.triangles.empty()) settle(object, other, answer);
    }
  }

  void settle(std::uint32_t number, const Other& object, ExactAnswer& answer) {
    ExactSeat seat{number};
    const double margin_m = seat_margin_m(part_bodies(), object.bodies, margin_m_);
    SeatWalk walk(path_, part_bodies(), object.bodies, object.distance, kSeatWithin * margin_m);
    seat.settled = walk.is_settled() || !meet(object.distance);
    walk.tell(shown("measuring the depth in the seat", answer.seat.size(), request_.seat.size()));
    const auto& p = request_.seat_pose;
    const Pose installed =
        Pose{{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}} * Pose{center_m_, {1, 0, 0, 0}};
    seat.installed_m = std::max(0.0, walk.at_pose(installed, std::nullopt).found_m);
    if (seat.installed_m == 0) {
      seat.gap_m = object.distance.at(installed, voxcheck::kNothingM).distance_m;
    }
    seat.allowed_m = seat.installed_m + margin_m + request_.seat_depth_m.value_or(0);
    for (const auto& [from_s, to_s] : request_.seated) {
      const auto deeper = walk.deeper_than(path_.at(from_s), path_.at(to_s), seat.allowed_m,
                                           kResolutionVoxels * voxel_m_);
      for (const auto& stretch : deeper) {
        answer.violations.push_back(pushed_in(seat, stretch));
      }
    }
    if (const auto& deepest = walk.deepest_so_far()) {
      seat.deepest_m = std::max(0.0, deepest->second.found_m);
    }
    answer.moments += walk.measured();
    answer.seat.push_back(seat);
  }

  // Whether the part and an object come to meet while the part is in its seat.
  bool meet(const MeshPair& distance) const {
    ExactWalk walk(path_, distance, distance, rounding_m_);
    return std::any_of(request_.seated.begin(), request_.seated.end(), [&](const auto& seated) {
      const Piece piece{path_.at(seated[0]), path_.at(seated[1])};
      return !walk.nearer_than(piece, rounding_m_, kResolutionVoxels * voxel_m_).empty();
    });
  }

  ExactViolation pushed_in(const ExactSeat& seat, const SeatWalk::Stretch& stretch) const {
    ExactViolation violation;
    violation.from_s = path_.time_s(stretch.from);
    violation.to_s = path_.time_s(stretch.to);
    violation.pushed_into_seat = true;
    violation.graze = !stretch.is_deeper;
    const Depth& worst = stretch.worst;
    violation.depth_m = worst.found_m;
    violation.max_depth_m = worst.at_most_m;
    violation.worst = deepest_moment(path_.time_s(stretch.worst_at), seat.object, worst);
    return violation;
  }

  void add_seated(ExactAnswer& answer) {
    walk_.tell(shown("measuring the clearance in the seat", 0, 1));
    for (const auto& [from_s, to_s] : request_.seated) {
      const auto smallest =
          walk_.smallest({{path_.at(from_s), path_.at(to_s)}}, kDepthVoxels * voxel_m_);
      answer.seated.push_back(
          {std::max(0.0, smallest.at_least_m - margin_m_), exact_moment(smallest.sample)});
    }
  }

  void add_least(ExactAnswer& answer) {
    std::vector<Piece> pieces;
    for (const auto& stretch : request_.stretches) {
      if (request_.max_m && stretch.proven_m > *request_.max_m) continue;
      pieces.push_back(piece_of(stretch));
      if (stretch.from_s <= request_.min_s && request_.min_s <= stretch.to_s) {
        take(walk_.at(path_.at(request_.min_s), stretch.seated));
      }
    }
    const auto smallest = walk_.smallest(std::move(pieces), kWithinVoxels * voxel_m_, nearest_);
    answer.smallest = exact_moment(smallest.sample);
    answer.clearance_m = std::max(0.0, smallest.at_least_m - margin_m_);
  }

  const ExactRequest& request_;
  StoredSide side_of_part_;
  command::ProgressLine& line_;
  const std::vector<PathRow>& rows_;
  const Surface& part_;
  double voxel_m_;
  glm::dvec3 center_m_;           // PshellHeader::center_m
  double rounding_m_, margin_m_;  // rounding; with the deviations of the meshes
  double baked_margin_m_;         // with those of the baked files
  Surface all_, other_;
  MeshPair everything_, seated_;
  clearance::CenterPath path_;
  ExactWalk walk_;
  struct Box {
    glm::dvec3 low_m, high_m;
  };
  std::map<std::uint32_t, Box> boxes_;                      // of the objects; empty until asked for
  std::map<std::uint32_t, std::unique_ptr<Other>> others_;  // those that were asked for
  Bodies part_bodies_;
  std::optional<Sample> nearest_;  // so far
  struct Side {
    double until_s = 0;
    bool seated = false;
    std::optional<Sample> inside;
  };
  std::optional<Side> side_;  // of the part, found last
};

}  // namespace

Result<Meshes> read_meshes(const ExactRequest& request, bool quiet) {
  auto voxmap = open_scene(request.scene);
  if (!voxmap) return voxmap.error();
  auto shell = open_part(request.part);
  if (!shell) return shell.error();
  command::ProgressLine line(quiet);
  line.show("reading the meshes", 0);
  std::vector<std::string> warnings;
  auto scene = read_scene_surface(request, *voxmap, warnings);
  if (!scene) return scene.error();
  auto part = read_part_surface(request, *shell, warnings);
  if (!part) return part.error();
  return Meshes{std::move(*voxmap), std::move(*shell), std::move(*scene), std::move(*part),
                std::move(warnings)};
}

Result<ExactAnswer> check_exactly(const Meshes& meshes, const std::vector<PathRow>& rows,
                                  const ExactRequest& request) {
  command::ProgressLine line(request.quiet);
  auto answer =
      ExactCheck(request, meshes.voxmap, meshes.shell, rows, meshes.scene, meshes.part, line)
          .answer();
  if (answer) answer->warnings = meshes.warnings;
  return answer;
}

Result<ExactAnswer> check_exactly(const ExactRequest& request) {
  const auto meshes = read_meshes(request, request.quiet);
  if (!meshes) return meshes.error();
  const auto rows = voxcheck::read_part_path(request.path, request.scene, request.part);
  if (!rows) return rows.error();
  return check_exactly(*meshes, *rows, request);
}

}  // namespace forcelayer::exact
