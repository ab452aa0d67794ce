#include "workbench/exact/exact_check.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <utility>

#include "formats/command/progress_line.h"
#include "formats/command/text.h"
#include "runtime/clearance/center_path.h"
#include "runtime/clearance/path_check.h"
#include "runtime/run/baked_files.h"
#include "runtime/voxcheck/path_source.h"
#include "workbench/exact/enclosure.h"
#include "workbench/exact/exact_walk.h"
#include "workbench/exact/seat_meshes.h"
#include "workbench/exact/seat_walk.h"
#include "workbench/exact/surface/animation.h"
#include "workbench/exact/surface/surfaces.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

using voxcheck::ExactAnswer;
using voxcheck::ExactMoment;
using voxcheck::ExactRequest;
using voxcheck::ExactSeat;
using voxcheck::ExactStop;
using voxcheck::ExactViolation;

// Resolution of a least distance, m and as a fraction of it: as closely as it is printed. No
// verdict depends on it (smallest_of_near()).
constexpr double kWithinM = 1e-7, kWithinFraction = 1e-5;
// Resolution of the travel at which a stretch begins and ends, m.
constexpr double kTravelM = 16e-6;
constexpr int kHalvings = 9;  // of the time in which the part gets the clearance from an object
// Resolution of a depth elsewhere than in a seat, m.
constexpr double kDepthM = 16e-6;

// Whether a shell point of a part whose surface meets none of the scene lies inside of a solid that
// `counts` is true of: by the sides that the baked scene stores, as far away from surfaces as is
// known. The surfaces of both are `distance_m` apart, give or take `margin_m`. The point's signed
// distance is then that at least, or minus that at most: which of the two, its voxel tells. No
// where it does not.
bool is_inside(const Voxmap& voxmap, const Pshell& shell, const Pose& world_from_center,
               double distance_m, double margin_m,
               const std::function<bool(const glm::dvec3& place_m)>& counts) {
  if (!(distance_m < voxcheck::kNothingM)) return false;
  const double s = voxmap.voxel_size_m();
  const KnownBox known = known_box(voxmap.header());
  const PshellView& v = shell.view();
  for (std::uint64_t n = 0; n < v.point_count; ++n) {
    const glm::dvec3 place_m = world_from_center.position_m +
                               world_from_center.orientation * glm::dvec3(v.x[n], v.y[n], v.z[n]);
    const glm::dvec3 low = glm::floor(place_m / s);
    std::array<std::int64_t, 3> voxel{};
    bool is_known = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double index = low[static_cast<int>(axis)];
      is_known = is_known && index >= static_cast<double>(known.low[axis]) &&
                 index < static_cast<double>(known.high[axis]);
      if (is_known) voxel[axis] = static_cast<std::int64_t>(index);
    }
    if (!is_known) continue;
    const auto [i, j, k] = voxel;
    const double off_m = glm::length(place_m - s * (low + 0.5)) + margin_m;  // its center
    const bool can_be_outside = voxmap.max_distance_m(i, j, k) + off_m >= distance_m;
    const bool can_be_inside = voxmap.min_distance_m(i, j, k) - off_m <= -distance_m;
    if (can_be_inside && !can_be_outside && counts(place_m)) return true;
  }
  return false;
}

// ExactAnswer::ends_beyond_scene.
bool ends_beyond(const clearance::CenterPath& path, const Surface& scene, const Surface& part) {
  const Pose end = path.world_from_center({path.poses() - 1, 0});
  std::vector<glm::dvec3> directions;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) directions.emplace_back(0)[axis] = sign;
  }
  for (std::size_t pose = path.poses() - 1; pose-- > 0;) {
    const glm::dvec3 way_m = end.position_m - path.world_from_center({pose, 0}).position_m;
    if (glm::length(way_m) == 0) continue;
    directions.push_back(glm::normalize(way_m));
    break;
  }
  return std::ranges::any_of(directions, [&](const glm::dvec3& direction) {
    double of_scene_m = -INFINITY, of_part_m = INFINITY;
    for (const glm::dvec3& v : scene.vertices_m) {
      of_scene_m = std::max(of_scene_m, glm::dot(direction, v));
    }
    for (const glm::dvec3& v : part.vertices_m) {
      of_part_m = std::min(of_part_m, glm::dot(direction, end.position_m + end.orientation * v));
    }
    return of_part_m >= of_scene_m;
  });
}

class ExactCheck {
 public:
  ExactCheck(const ExactRequest& request, const Voxmap& voxmap, const Pshell& shell,
             const std::vector<PathRow>& rows, const Surface& scene, const Surface& part,
             command::ProgressLine& line)
      : request_(request),
        voxmap_(voxmap),
        shell_(shell),
        line_(line),
        rows_(rows),
        part_(part),
        voxel_m_(voxmap.voxel_size_m()),
        center_m_(shell.header().center_m[0], shell.header().center_m[1],
                  shell.header().center_m[2]),
        rounding_m_(kRounding * largest_m(scene, part, rows)),
        margin_m_(rounding_m_ + scene.deviation_m + part.deviation_m),
        baked_margin_m_(rounding_m_ + voxmap.header().static_deviation_m + part.deviation_m),
        all_(without(scene, request.allowed)),
        other_(without(all_, request.seat)),
        everything_(all_, part),
        seated_(other_, part),
        of_seat_(only(all_, request.seat)),
        seat_(of_seat_, part),
        path_(rows, center_m_, radius_m(part)),
        walk_(path_, everything_, seated_, rounding_m_),
        leaving_(path_, seat_, seat_, rounding_m_),
        ends_beyond_scene_(ends_beyond(path_, scene, part)) {}

  Result<ExactAnswer> answer() {
    ExactAnswer answer;
    answer.margin_m = margin_m_;
    answer.ends_beyond_scene = ends_beyond_scene_;
    answer.beyond.exact_m = voxcheck::kNothingM;
    const Watch watch([this] { return may_go_on(); });
    try {
      if (Status sound = measure(answer); !sound) return sound.error();
    } catch (const Stopped&) {
      note_stop(answer);
    }
    answer.moments += walk_.measured() + leaving_.measured();
    if (const auto& found = walk_.contradiction()) {
      return contradiction(found->time_s, found->exact_m, "prove", found->proven_m);
    }
    return answer;
  }

 private:
  static double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  bool may_go_on() {
    if (fraction_ > 0) line_.show(words_, fraction_);
    return !request_.max_s || now_s() - begun_s_ < *request_.max_s;
  }

  Status measure(ExactAnswer& answer) {
    begin_stage(ExactStop::kClearance, "measuring the clearance");
    if (Status sound = hold_against_files(); !sound) return sound;
    if (const auto object =
            enclosing_object(all_, part_, path_.world_from_center({0, 0}), margin_m_)) {
      answer.enclosed_by.push_back(*object);
    }
    find_seated();
    add_violations(answer);
    add_seat(answer);
    begin_stage(ExactStop::kSmallest, "measuring the clearance in the seat");
    add_seated(answer);
    begin_stage(ExactStop::kSmallest, "measuring the least clearance");
    walk_.tell([this](double fraction) { show(fraction); });
    add_least(answer);
    return {};
  }

  // The terminal and a stop say this from here on.
  void begin_stage(ExactStop::Stage stage, const std::string& words, std::uint32_t object = 0) {
    stop_ = {stage, object, path_.time_s({0, 0})};
    words_ = words;
    show(0);
  }
  void show(double fraction) {
    fraction_ = fraction;
    line_.show(words_, fraction_);
  }

  // Task `n` of some of the stage. `reached_s` says until when it has come.
  template <typename ReachedS>
  Progress shown(std::size_t n, std::size_t tasks, const ReachedS& reached_s) {
    return [=, this](double fraction) {
      stop_.settled_s = reached_s();
      show((static_cast<double>(n) + std::clamp(fraction, 0.0, 1.0)) / static_cast<double>(tasks));
    };
  }

  // The time is over. What is certain by then stays.
  void note_stop(ExactAnswer& answer) {
    if (stop_.stage == ExactStop::kClearance) add_certain(answer);
    // All of the path is settled, but how near the part comes.
    const bool is_kept = stop_.stage == ExactStop::kSmallest && answer.violations.empty();
    if (is_kept) answer.clearance_m = request_.required_m;
    answer.stop.push_back(stop_);
    answer.smallest.exact_m = answer.beyond.exact_m = voxcheck::kNothingM;
    ExactMoment nothing;
    nothing.exact_m = voxcheck::kNothingM;
    const auto& seated = seated_stretches_.empty() ? request_.seated : seated_stretches_;
    for (std::size_t n = answer.seated.size(); n < seated.size(); ++n) {
      answer.seated.push_back({seated[n][0], seated[n][1], 0, nothing});
    }
  }

  // The moment at which the part was found nearest, where that is too near and no violation has it.
  void add_certain(ExactAnswer& answer) {
    std::optional<Sample> worst;
    for (const Piece& piece : joined([](const auto& s) { return s.too_near; })) {
      const auto nearest = walk_.nearest_between(piece.from, piece.to, piece.seated);
      if (nearest && (!worst || nearest->measured.distance_m < worst->measured.distance_m)) {
        worst = nearest;
      }
    }
    if (!worst || worst->measured.distance_m >= request_.required_m - rounding_m_) return;
    ExactViolation violation;
    violation.from_s = violation.to_s = path_.time_s(worst->moment);
    const auto has_it = [&](const ExactViolation& v) {
      return v.from_s <= violation.from_s && violation.to_s <= v.to_s;
    };
    if (std::any_of(answer.violations.begin(), answer.violations.end(), has_it)) return;
    violation.worst = exact_moment(*worst);
    answer.violations.push_back(violation);
  }

  Error contradiction(double time_s, double exact_m, const char* say, double said_m) const {
    return Error{ErrorCode::kFilesDoNotMatch, request_.scene, "--exact",
                 command::text("at %.3f s the meshes are %.6f mm apart, but the files %s %.6f mm: "
                               "the files were baked from other meshes",
                               time_s, 1e3 * exact_m, say, 1e3 * said_m),
                 "give the inputs of the bakes, with their units"};
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
      if (exact_m > said.max_m + rounding_m_ && !is_filled(moment, exact_m)) {
        return contradiction(said.time_s, exact_m, "give at most", said.max_m);
      }
    }
    return {};
  }

  // Whether the voxels have the part inside of a solid, or in a cavity, which they fill.
  bool is_filled(const Moment& moment, double distance_m) {
    return is_inside(voxmap_, shell_, path_.world_from_center(moment), distance_m, baked_margin_m_,
                     [&](const glm::dvec3& place_m) {
                       return request_.allowed.empty() || is_held(place_m, false);
                     });
  }

  // Whether the part lies inside of a solid that counts. Deep inside, the scene does not tell of
  // which object, and it fills cavities: the meshes know. Open meshes may be the faces of a solid
  // together, so where there are any, and all objects count, the scene decides.
  bool lies_inside(const Moment& moment, double distance_m, bool seated) {
    const bool all_count = request_.allowed.empty() && !seated;
    return is_inside(voxmap_, shell_, path_.world_from_center(moment), distance_m, baked_margin_m_,
                     [&](const glm::dvec3& place_m) {
                       return is_held(place_m, seated) || (all_count && !are_all_solid());
                     });
  }

  bool are_all_solid() {
    if (boxes_.empty()) find_boxes();
    return std::all_of(boxes_.begin(), boxes_.end(), [&](const auto& entry) {
      return are_solid(other_of(entry.first).bodies());
    });
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
      const Bodies& bodies = other_of(object).bodies();
      return are_solid(bodies) && std::any_of(bodies.begin(), bodies.end(), [&](const auto& body) {
               return body->holds(vec3_of(place_m));
             });
    });
  }

  struct Box {
    glm::dvec3 low_m, high_m;
  };
  static Box box_around(std::span<const glm::dvec3> places_m) {
    Box box{glm::dvec3(INFINITY), glm::dvec3(-INFINITY)};
    for (const glm::dvec3& place : places_m) {
      box.low_m = glm::min(box.low_m, place), box.high_m = glm::max(box.high_m, place);
    }
    return box;
  }
  // Around a box that was turned and moved.
  static Box placed(const Box& box, const Pose& world_from_box) {
    std::array<glm::dvec3, 8> corners;
    for (std::size_t n = 0; n < corners.size(); ++n) {
      const glm::dvec3 corner((n & 1 ? box.low_m : box.high_m).x,
                              (n & 2 ? box.low_m : box.high_m).y,
                              (n & 4 ? box.low_m : box.high_m).z);
      corners[n] = world_from_box.position_m + world_from_box.orientation * corner;
    }
    return box_around(corners);
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

  Piece piece_of(const voxcheck::ProvenStretch& stretch) const {
    return {path_.at(stretch.from_s), path_.at(stretch.to_s), stretch.proven_m, stretch.seated};
  }

  ExactMoment exact_moment(const Sample& sample) const {
    return exact_moment(sample, sample.seated ? other_ : all_);
  }
  ExactMoment exact_moment(const Sample& sample, const Surface& surface) const {
    const MeshDistance& m = sample.measured;
    ExactMoment moment{path_.time_s(sample.moment),
                       std::min(m.distance_m, voxcheck::kNothingM),
                       0,
                       {m.part_m.x, m.part_m.y, m.part_m.z},
                       {m.scene_m.x, m.scene_m.y, m.scene_m.z}};
    if (m.scene_triangle < surface.object.size()) moment.object = surface.object[m.scene_triangle];
    return moment;
  }

  // Pieces that follow each other, in which the part is too near.
  struct Near {
    std::vector<Piece> pieces;
    std::optional<Sample> inside;  // a moment at which it lies inside of a solid
  };

  // The least distance of some pieces, as closely as it is printed.
  ExactWalk::Least smallest_of(std::vector<Piece> pieces, std::optional<Sample> known = {}) {
    return smallest_of(walk_, std::move(pieces), std::move(known));
  }
  ExactWalk::Least smallest_of(ExactWalk& walk, std::vector<Piece> pieces,
                               std::optional<Sample> known = {}) const {
    return walk.smallest(std::move(pieces), std::max(kWithinM, rounding_m_), std::move(known),
                         kWithinFraction);
  }

  // The same, so closely that it is known on which side of what is required it lies, but for
  // rounding. None where nothing is nearer than required.
  std::optional<ExactWalk::Least> smallest_of_near(const std::vector<Piece>& pieces) {
    auto smallest = smallest_of(pieces);
    const auto is_decided = [&] {
      return smallest.sample.measured.distance_m < request_.required_m - rounding_m_ ||
             smallest.at_least_m >= request_.required_m + margin_m_;
    };
    if (!is_decided()) smallest = walk_.smallest(pieces, rounding_m_, smallest.sample);
    if (smallest.at_least_m >= request_.required_m + margin_m_) return std::nullopt;
    return smallest;
  }

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
      const auto smallest = smallest_of_near(near.pieces);
      if (!smallest) return;
      violation.clearance_m = std::max(0.0, smallest->at_least_m - margin_m_);
      worst = smallest->sample;
    }
    violation.worst = exact_moment(worst);
    violation.graze =
        !violation.meets() && violation.worst.exact_m >= request_.required_m - rounding_m_;
    take(worst);
    violation.contact_s = violation.from_s;
    answer.violations.push_back(violation);
    if (!violation.meets()) return;
    const int stage = std::exchange(stop_.stage, static_cast<int>(ExactStop::kBlockers));
    stop_.settled_s = violation.from_s;
    const std::size_t first = answer.violations.size() - 1;
    if (!near.inside) add_blockers(near.pieces, answer);
    stop_.stage = ExactStop::kDepths;
    stop_.settled_s = violation.to_s;
    add_depths(std::span(answer.violations).subspan(first));
    stop_.stage = stage;
  }

  // The last violation is of all pieces, in which the part meets an object. Each object that it
  // meets gets a violation of its own, with the stretch in which it is too near by itself and from
  // when on they touch; for one alone the stretch is all. Those that are touched first come first.
  void add_blockers(const std::vector<Piece>& pieces, ExactAnswer& answer) {
    const ExactViolation whole = answer.violations.back();
    const auto first = static_cast<std::ptrdiff_t>(answer.violations.size()) - 1;
    set_contact(pieces, answer.violations.back());
    for (const std::uint32_t object : objects_beside(pieces)) {
      if (object == 0 || object == whole.worst.object) continue;
      if (!contact_begin(pieces, object)) continue;
      Other& other = other_of(object);
      const Sample nearest = smallest_of(other.walk, counted_pieces(pieces, object)).sample;
      ExactViolation violation;
      violation.worst = exact_moment(nearest, other.surface);
      if (violation.worst.exact_m == 0 && set_contact(pieces, violation)) {
        answer.violations.push_back(violation);
      }
    }
    const auto met = std::span(answer.violations).subspan(static_cast<std::size_t>(first));
    if (met.size() == 1) met[0].from_s = whole.from_s, met[0].to_s = whole.to_s;
    std::stable_sort(met.begin(), met.end(), [](const ExactViolation& a, const ExactViolation& b) {
      return a.contact_s < b.contact_s;
    });
  }

  // The depths of the first of some violations. They take long: most are measured at few moments.
  void add_depths(std::span<ExactViolation> met) {
    constexpr std::size_t kMaxDepths = 16, kMoments = 4;
    for (std::size_t n = 0; n < std::min(kMaxDepths, met.size()); ++n) {
      look_into(met[n], n == 0 ? SeatWalk::kMoments : kMoments);
    }
  }

  // The objects that the part may meet in some pieces: whose boxes meet that of all places where a
  // box around the part is from one pose to the next.
  std::vector<std::uint32_t> objects_beside(const std::vector<Piece>& pieces) {
    if (boxes_.empty()) find_boxes();
    const Box part = box_around(part_.vertices_m);
    std::set<std::uint32_t> beside;
    const auto look = [&](const Moment& from, const Moment& to) {
      const Box a = placed(part, path_.world_from_center(from));
      const Box b = placed(part, path_.world_from_center(to));
      const double reach_m = path_.deviation_m(from, to) + rounding_m_;
      for (const auto& [object, box] : boxes_) {
        if (glm::any(glm::lessThan(box.high_m, glm::min(a.low_m, b.low_m) - reach_m))) continue;
        if (glm::any(glm::greaterThan(box.low_m, glm::max(a.high_m, b.high_m) + reach_m))) continue;
        beside.insert(object);
      }
    };
    for (const Piece& piece : pieces) {
      Moment from = piece.from;
      const auto poses = clearance::CenterPath::between(piece.from, piece.to);
      for (std::size_t pose = poses.first; pose < poses.beyond; ++pose) {
        look(from, {pose, 0});
        from = {pose, 0};
      }
      look(from, piece.to);
    }
    return {beside.begin(), beside.end()};
  }

  // Those in which an object counts: one of the seat does not while the part is in it.
  std::vector<Piece> counted_pieces(const std::vector<Piece>& pieces, std::uint32_t object) const {
    const auto& seat = request_.seat;
    const bool is_of_seat = std::find(seat.begin(), seat.end(), object) != seat.end();
    std::vector<Piece> counted = unmeasured(pieces);
    std::erase_if(counted, [&](const Piece& piece) { return piece.seated && is_of_seat; });
    return counted;
  }

  static std::vector<Piece> unmeasured(std::vector<Piece> pieces) {
    for (Piece& piece : pieces) piece.is_measured = false;
    return pieces;
  }

  // The first moment of some pieces at which the surfaces of the part and an object meet.
  std::optional<Moment> contact_begin(const std::vector<Piece>& pieces, std::uint32_t object) {
    ExactWalk& walk = other_of(object).walk;
    for (const Piece& piece : counted_pieces(pieces, object)) {
      const auto touching = walk.nearer_than(piece, rounding_m_, kTravelM, true);
      if (!touching.empty()) return touching.front().from;
    }
    return std::nullopt;
  }

  // From when to when the object of a violation is too near in some pieces, and from when on it and
  // the part touch. False where it is not.
  bool set_contact(const std::vector<Piece>& pieces, ExactViolation& violation) {
    const std::uint32_t object = violation.worst.object;
    ExactWalk& walk = other_of(object).walk;
    std::vector<Piece> near;
    for (const Piece& piece : counted_pieces(pieces, object)) {
      const auto parts = walk.nearer_than(piece, request_.required_m + margin_m_, kTravelM);
      near.insert(near.end(), parts.begin(), parts.end());
    }
    if (near.empty()) return false;
    violation.from_s = path_.time_s(near.front().from);
    violation.to_s = path_.time_s(near.back().to);
    if (const auto begin = contact_begin(pieces, object)) {
      violation.contact_s = path_.time_s(*begin);
      violation.contact_known = true;
    }
    return true;
  }

  // Where the surfaces meet: how deep they lie in each other, at the deepest of some moments.
  void look_into(ExactViolation& violation, std::size_t moments = SeatWalk::kMoments) {
    const std::uint32_t object = violation.worst.object;
    Other& other = other_of(object);
    if (!are_solid(part_bodies()) || !are_solid(other.bodies())) return;
    SeatWalk walk(path_, part_bodies(), other.bodies(), other.distance, kDepthM);
    const SeatWalk::Stretch deepest =
        walk.deepest_of(path_.at(violation.from_s), path_.at(violation.to_s),
                        path_.at(violation.worst.time_s), moments);
    if (!(deepest.worst.found_m > 0)) return;
    violation.depth_m = deepest.worst.found_m;
    violation.max_depth_m = deepest.worst.at_most_m;
    violation.worst = deepest_moment(path_.time_s(deepest.worst_at), object, deepest.worst);
  }

  // At the deepest place, which lies in both solids, and at the nearest one of the other surface.
  static ExactMoment deepest_moment(double time_s, std::uint32_t object, const Depth& depth) {
    const auto& [deepest, nearest] = depth.is_at_foot ? std::tie(depth.foot_m, depth.place_m)
                                                      : std::tie(depth.place_m, depth.foot_m);
    return {
        time_s, 0, object, {deepest.x, deepest.y, deepest.z}, {nearest.x, nearest.y, nearest.z}};
  }

  // An object of the scene by itself.
  struct Other {
    Other(Surface own, const Surface& part, const clearance::CenterPath& path, double rounding_m)
        : surface(std::move(own)),
          distance(surface, part),
          walk(path, distance, distance, rounding_m) {}
    const Bodies& bodies() {
      if (bodies_.empty()) bodies_ = bodies_of(surface, widest_crack_m(surface));
      return bodies_;
    }
    Surface surface;
    MeshPair distance;
    ExactWalk walk;  // remembers what it measured

   private:
    Bodies bodies_;  // empty until asked for
  };
  Other& other_of(std::uint32_t object) {
    auto& other = others_[object];
    if (!other) {
      other = std::make_unique<Other>(only(all_, {&object, 1}), part_, path_, rounding_m_);
    }
    return *other;
  }

  const Bodies& part_bodies() {
    if (part_bodies_.empty()) part_bodies_ = bodies_of(part_, widest_crack_m(part_));
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
    for (const Piece& piece : walk_.nearer_than(whole, request_.required_m + margin_m_, kTravelM)) {
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

  // Where the part is in its seat by the meshes: from the beginning until it is first as far from
  // all objects of the seat as required, and from when it was so last until the end. What is left
  // of a stretch of the files is checked against all objects.
  void find_seated() {
    stretches_ = request_.stretches;
    for (const auto& seated : request_.seated) {
      const double from_s = seated[0], to_s = seated[1];
      const bool begins = from_s <= path_.time_s({0, 0});
      const bool ends = to_s >= rows_.back().time_s && (!begins || is_end_installed());
      begin_stage(ExactStop::kClearance, "finding when the part is in its seat");
      leaving_.tell([this](double fraction) { show(fraction); });
      // Far enough for what follows to be proven from its first piece on.
      const double left_m = request_.required_m + margin_m_ + kTravelM;
      // The whole path is searched, so that the moment depends on no voxel.
      const Piece whole{{0, 0}, {path_.poses() - 1, 0}};
      const auto far_s = [&](bool backwards) {
        const auto far = leaving_.first_as_far(whole, left_m, kTravelM, backwards);
        return far ? path_.time_s(*far) : backwards ? from_s : to_s;
      };
      const double left_s = begins ? std::min(far_s(false), to_s) : from_s;
      const double back_s = ends ? std::max(far_s(true), from_s) : to_s;
      if (left_s >= back_s) {  // as far nowhere in it
        seated_stretches_.push_back({from_s, to_s});
        continue;
      }
      if (left_s > from_s) seated_stretches_.push_back({from_s, left_s});
      if (to_s > back_s) seated_stretches_.push_back({back_s, to_s});
      leave_seat(left_s, back_s);
    }
  }

  // Whether the part ends its path where it is installed, as check_path() has it.
  bool is_end_installed() const {
    const auto& p = request_.seat_pose;
    const Pose installed =
        Pose{{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}} * Pose{center_m_, {1, 0, 0, 0}};
    return path_.travel_between_m(installed, path_.world_from_center({path_.poses() - 1, 0})) <
           clearance::kSeatVoxels * voxel_m_;
  }

  // From one time to the other all objects count.
  void leave_seat(double from_s, double to_s) {
    std::vector<voxcheck::ProvenStretch> stretches;
    const auto add = [&](voxcheck::ProvenStretch stretch, double begin_s, double end_s) {
      stretch.from_s = std::max(stretch.from_s, begin_s);
      stretch.to_s = std::min(stretch.to_s, end_s);
      if (stretch.from_s < stretch.to_s) stretches.push_back(stretch);
    };
    for (const voxcheck::ProvenStretch& stretch : stretches_) {
      if (!stretch.seated || stretch.to_s <= from_s || stretch.from_s >= to_s) {
        stretches.push_back(stretch);
        continue;
      }
      voxcheck::ProvenStretch left = stretch;
      left.seated = false;
      left.proven_m = 0;
      left.too_near = true;
      add(stretch, stretch.from_s, from_s);
      add(left, from_s, to_s);
      add(stretch, to_s, stretch.to_s);
    }
    stretches_ = std::move(stretches);
  }

  // Some stretches, those that follow each other as one: where the files cut them says nothing of
  // the meshes.
  template <typename IsChosen>
  std::vector<Piece> joined(const IsChosen& is_chosen) const {
    std::vector<Piece> pieces;
    double until_s = 0;
    for (const voxcheck::ProvenStretch& stretch : stretches_) {
      if (!is_chosen(stretch)) continue;
      const Piece piece = piece_of(stretch);
      const bool follows =
          !pieces.empty() && until_s == stretch.from_s && pieces.back().seated == stretch.seated;
      until_s = stretch.to_s;
      if (!follows) {
        pieces.push_back(piece);
        continue;
      }
      pieces.back().to = piece.to;
      pieces.back().min_m = std::min(pieces.back().min_m, piece.min_m);
    }
    return pieces;
  }

  // Cuts the stretches that are too near by the files down to those that are by the meshes.
  void add_violations(ExactAnswer& answer) {
    const std::vector<Piece> stretches = joined([](const auto& s) { return s.too_near; });
    Near so_far;
    begin_stage(ExactStop::kClearance, "measuring the clearance");
    for (std::size_t n = 0; n < stretches.size(); ++n) {
      walk_.tell(shown(n, stretches.size(), [this] { return walk_.reached_s(); }));
      for (Near& near : near_pieces(stretches[n])) {
        auto& pieces = so_far.pieces;
        const bool follows = !pieces.empty() && path_.time_s(pieces.back().to) ==
                                                    path_.time_s(near.pieces.front().from);
        if (!follows && !pieces.empty()) add_violation(std::move(so_far), answer), so_far = {};
        pieces.push_back(near.pieces.front());
        if (near.inside) so_far.inside = near.inside;
      }
    }
    if (!so_far.pieces.empty()) add_violation(std::move(so_far), answer);
  }

  // Settles the objects of the seat: how deep the part goes into them while it is there.
  void add_seat(ExactAnswer& answer) {
    if (request_.seated.empty() || request_.seat.empty()) return;
    for (const std::uint32_t object : request_.seat) {
      begin_stage(ExactStop::kInstalled, "measuring the overlap of the installed part", object);
      Other& other = other_of(object);
      if (!other.surface.triangles.empty()) settle(object, other, answer);
    }
  }

  void settle(std::uint32_t number, Other& object, ExactAnswer& answer) {
    ExactSeat seat{number};
    const double deviations_m = object.surface.deviation_m + part_.deviation_m;
    seat.crack_m = seat_margin_m(part_bodies(), object.bodies(), 0);
    seat.margin_m = rounding_m_ + deviations_m + seat.crack_m;
    SeatWalk walk(path_, part_bodies(), object.bodies(), object.distance,
                  kSeatWithin * seat.margin_m);
    const auto deeper = deeper_in_seat(seat, object, walk, answer);
    for (const auto& stretch : deeper) answer.violations.push_back(pushed_in(seat, stretch));
    if (seat.gap_m > 0) seat.nearest_m = nearest_in_seat_m(object.walk);
    if (const auto soon_s = soon_out_s(2 * (request_.required_m + seat.installed_m))) {
      const auto apart_m = [&](double at_s) {
        const Pose pose = path_.world_from_center(path_.at(at_s));
        return object.distance.at(pose, voxcheck::kNothingM).distance_m;
      };
      seat.soon_s = *soon_s;
      seat.soon_m = apart_m(*soon_s);
      double near_s = in_seat_s();
      for (int n = 0; n < kHalvings && seat.soon_m >= request_.required_m; ++n) {
        const double middle_s = (near_s + seat.soon_s) / 2, middle_m = apart_m(middle_s);
        if (middle_m >= request_.required_m) {
          seat.soon_s = middle_s, seat.soon_m = middle_m;
        } else {
          near_s = middle_s;
        }
      }
    }
    answer.seat.push_back(seat);
  }

  // Where the part is not proven to be less deep in the object of `seat` than that allows. Sets how
  // deep it is as installed, what is allowed, and the deepest that was found.
  std::vector<SeatWalk::Stretch> deeper_in_seat(ExactSeat& seat, Other& object, SeatWalk& walk,
                                                ExactAnswer& answer) {
    seat.settled = walk.is_settled() || !meet(object.walk);
    const auto& p = request_.seat_pose;
    const Pose installed =
        Pose{{p[0], p[1], p[2]}, {p[3], p[4], p[5], p[6]}} * Pose{center_m_, {1, 0, 0, 0}};
    if (!seat.settled) {
      seat.part_hole = hole_of(part_bodies(), installed);
      seat.object_hole = hole_of(object.bodies(), {});
    }
    seat.installed_m = std::max(
        0.0, walk.at_pose(installed, std::nullopt, 0, [this](double f) { show(f); }).found_m);
    if (seat.installed_m == 0) {
      seat.gap_m = object.distance.at(installed, voxcheck::kNothingM).distance_m;
    }
    seat.allowed_m = seat.installed_m + seat.margin_m + request_.seat_depth_m.value_or(0);
    begin_stage(ExactStop::kContact, "measuring the depth in the seat", seat.object);
    walk.tell(shown(answer.seat.size(), request_.seat.size(), [&] { return walk.reached_s(); }));
    if (request_.seat_depth_m.value_or(0) > 0) walk.allow_passing();
    std::vector<SeatWalk::Stretch> all;
    for (const auto& [from_s, to_s] : seated_stretches_) {
      const auto deeper =
          walk.deeper_than(path_.at(from_s), path_.at(to_s), seat.allowed_m, kTravelM);
      all.insert(all.end(), deeper.begin(), deeper.end());
      // Where it may go deeper, the answer says how deep it goes.
      if (request_.seat_depth_m && deeper.empty()) {
        walk.deepest_of(path_.at(from_s), path_.at(to_s), path_.at(from_s));
      }
    }
    if (const auto& deepest = walk.deepest_so_far()) {
      seat.deepest_m = std::max(0.0, deepest->second.found_m);
    }
    answer.moments += walk.measured();
    return all;
  }

  // The end of the first stretch in the seat at which the part is installed: its last time where
  // the part goes in.
  double in_seat_s() const {
    const auto [from_s, to_s] = seated_stretches_.front();
    return from_s > request_.stretches.front().from_s ? to_s : from_s;
  }

  // The first time of some at which the part has moved so far, out of its seat or back from it;
  // none where it does not move so far.
  std::optional<double> soon_out_s(double far_m) const {
    if (seated_stretches_.empty()) return std::nullopt;
    constexpr int kSteps = 256;
    const auto [from_s, to_s] = seated_stretches_.front();
    const double at_s = in_seat_s(), end_s = at_s == from_s ? to_s : from_s;
    const Pose seated = path_.world_from_center(path_.at(at_s));
    for (int n = 1; n <= kSteps; ++n) {
      const double soon_s = at_s + (end_s - at_s) * n / kSteps;
      const Pose pose = path_.world_from_center(path_.at(soon_s));
      const double moved_m = glm::length(pose.position_m - seated.position_m);
      if (moved_m >= far_m) return soon_s;
    }
    return std::nullopt;
  }

  // How near an object comes while the part is in its seat.
  double nearest_in_seat_m(ExactWalk& walk) const {
    std::vector<Piece> pieces;
    for (const auto& [from_s, to_s] : seated_stretches_) {
      pieces.push_back({path_.at(from_s), path_.at(to_s)});
    }
    return smallest_of(walk, std::move(pieces)).sample.measured.distance_m;
  }

  // Where the bodies are open, with the longest edge of all.
  static voxcheck::ExactHole hole_of(const Bodies& bodies, const Pose& world_from_bodies) {
    voxcheck::ExactHole hole;
    double widest_m = -1;
    for (const auto& body : bodies) {
      if (body->is_solid()) continue;
      const Body::OpenEdges edges = body->open_edges();
      hole.edges_m += edges.length_m;
      if (edges.length_m <= widest_m) continue;
      widest_m = edges.length_m;
      const glm::dvec3 place =
          world_from_bodies.position_m + world_from_bodies.orientation * dvec3_of(edges.place_m);
      hole.place_m = {place.x, place.y, place.z};
    }
    return hole;
  }

  // Whether the part and an object come to meet while the part is in its seat.
  bool meet(ExactWalk& walk) const {
    return std::any_of(seated_stretches_.begin(), seated_stretches_.end(), [&](const auto& seated) {
      const Piece piece{path_.at(seated[0]), path_.at(seated[1])};
      return !walk.nearer_than(piece, rounding_m_, kTravelM).empty();
    });
  }

  ExactViolation pushed_in(const ExactSeat& seat, const SeatWalk::Stretch& stretch) const {
    ExactViolation violation;
    violation.from_s = path_.time_s(stretch.from);
    violation.to_s = path_.time_s(stretch.to);
    violation.pushed_into_seat = true;
    violation.graze = !stretch.is_deeper;
    violation.passes_wall = stretch.passes_wall;
    const Depth& worst = stretch.worst;
    violation.depth_m = worst.found_m;
    violation.max_depth_m = worst.at_most_m;
    violation.worst = deepest_moment(path_.time_s(stretch.worst_at), seat.object, worst);
    return violation;
  }

  void add_seated(ExactAnswer& answer) {
    leaving_.tell([this](double fraction) { show(fraction); });
    for (const auto& [from_s, to_s] : seated_stretches_) {
      const auto smallest = smallest_of(leaving_, {{path_.at(from_s), path_.at(to_s)}});
      answer.seated.push_back({from_s, to_s, std::max(0.0, smallest.at_least_m - margin_m_),
                               exact_moment(smallest.sample, of_seat_)});
    }
  }

  void add_least(ExactAnswer& answer) {
    if (!request_.seat.empty() && request_.allowed.empty()) {
      Piece whole{{0, 0}, {path_.poses() - 1, 0}};
      whole.seated = true;
      const auto beyond = smallest_of({whole});
      answer.beyond = exact_moment(beyond.sample);
      answer.beyond_clearance_m = std::max(0.0, beyond.at_least_m - margin_m_);
    }
    std::vector<Piece> pieces =
        joined([&](const auto& s) { return !request_.max_m || s.proven_m <= *request_.max_m; });
    for (const Piece& piece : pieces) {
      if (path_.time_s(piece.from) <= request_.min_s && request_.min_s <= path_.time_s(piece.to)) {
        take(walk_.at(path_.at(request_.min_s), piece.seated));
      }
    }
    const auto smallest = smallest_of(std::move(pieces), nearest_);
    answer.smallest = exact_moment(smallest.sample);
    answer.clearance_m = std::max(0.0, smallest.at_least_m - margin_m_);
  }

  const ExactRequest& request_;
  const double begun_s_ = now_s();
  ExactStop stop_;       // that there would be now
  std::string words_;    // on the terminal
  double fraction_ = 0;  // that is done
  const Voxmap& voxmap_;
  const Pshell& shell_;
  command::ProgressLine& line_;
  const std::vector<PathRow>& rows_;
  const Surface& part_;
  double voxel_m_;
  glm::dvec3 center_m_;           // PshellHeader::center_m
  double rounding_m_, margin_m_;  // rounding; with the deviations of the meshes
  double baked_margin_m_;         // with those of the baked files
  Surface all_, other_;
  MeshPair everything_, seated_;
  Surface of_seat_;
  MeshPair seat_;
  clearance::CenterPath path_;
  ExactWalk walk_, leaving_;  // by all objects that count; by those of the seat
  bool ends_beyond_scene_;
  std::vector<voxcheck::ProvenStretch> stretches_;          // of the request, seats by the meshes
  std::vector<std::array<double, 2>> seated_stretches_;     // from, to
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

// ExactAnswer::rules alone.
Result<ExactAnswer> answer_rules(const ExactRequest& request) {
  const auto voxmap = open_scene(request.scene);
  if (!voxmap) return voxmap.error();
  const auto shell = open_part(request.part);
  if (!shell) return shell.error();
  command::ProgressLine line(request.quiet);
  line.show("reading the rules", 0);
  return read_rules(request, *voxmap, *shell);
}

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
  if (!request.rules.empty()) return answer_rules(request);
  auto meshes = read_meshes(request, request.quiet);
  if (!meshes) return meshes.error();
  const auto rows = voxcheck::read_part_path(request, meshes->shell);
  if (!rows) return rows.error();
  if (!request.animation.empty()) {
    const MovingScene moving = moving_scene(request, meshes->scene, meshes->voxmap, meshes->part,
                                            meshes->shell, *rows, meshes->warnings);
    const Status written =
        mesh::write_glb(request.animation, moving.nodes, &moving.motion, moving.up);
    if (!written) return written.error();
  }
  return check_exactly(*meshes, *rows, request);
}

}  // namespace forcelayer::exact
