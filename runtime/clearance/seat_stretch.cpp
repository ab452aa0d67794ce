#include "runtime/clearance/seat_stretch.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "runtime/clearance/part_distance.h"
#include "runtime/guard/pose_guard.h"

namespace forcelayer::clearance {
namespace {

constexpr double kStepVoxels = 0.5;
// A point whose normal is within 26 degrees of the field's slope lies flush before a face: the
// slope is off by less there, and the part's own normal is exact. Another one lies before an edge,
// where the slope holds close by alone.
constexpr float kFlush = 0.9f;
constexpr double kTouchVoxels = 0.1;
constexpr float kShallow = 0.125f;  // of what a point may lie deeper than it touches

}  // namespace

struct SeatStretch::Parts {
  Parts(const Voxmap& voxmap, const Pshell& shell, std::unique_ptr<field::ForceField> force_field)
      : query(voxmap, shell), field(std::move(force_field)) {
    points.reserve(shell.view().point_count);
    samples.reserve(shell.view().point_count);
    contacts.reserve(shell.view().point_count);
    earlier.reserve(shell.view().point_count);
    probe = std::make_unique<guard::PoseGuard>(query, *field, points, samples);
  }

  query::ContactQuery query;
  std::unique_ptr<field::ForceField> field;
  query::CollectedPoints points;
  field::FieldSamples samples;
  field::ContactSet contacts, earlier;  // of the last pose, and of the one before it on a path
  Pose earlier_pose;
  std::unique_ptr<guard::PoseGuard> probe;
  Pose in_seat;  // world_from_center
  std::optional<Error> too_deep;
  std::uint64_t looked_up = 0;
};

SeatStretch::SeatStretch(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
SeatStretch::SeatStretch(SeatStretch&&) noexcept = default;
SeatStretch::~SeatStretch() = default;

Result<SeatStretch> SeatStretch::find(const Voxmap& voxmap, const Pshell& shell,
                                      const Pose& world_from_center, guard::SeatDepth depth) {
  auto field = field::make_force_field(Model::kDefault, ForceKind::kDistance, voxmap);
  if (!field) return field.error();
  SeatStretch stretch(std::make_unique<Parts>(voxmap, shell, std::move(*field)));
  if (Status found = stretch.parts_->probe->find_seat(world_from_center); !found) {
    Error error = found.error();
    error.where = "--seat";
    constexpr std::string_view kStart = "--start";
    if (const std::size_t at = error.mend.find(kStart); at != std::string::npos) {
      error.mend.replace(at, kStart.size(), error.where);
    }
    if (depth == guard::SeatDepth::kStored ||
        !stretch.parts_->probe->find_seat(world_from_center, depth)) {
      return error;
    }
    stretch.parts_->too_deep = std::move(error);
  }
  stretch.parts_->probe->open_seat(!stretch.parts_->too_deep);
  stretch.parts_->in_seat = world_from_center;
  return stretch;
}

std::span<const guard::SeatObject> SeatStretch::objects() const {
  return parts_->probe->seat().objects();
}

const std::optional<Error>& SeatStretch::too_deep() const { return parts_->too_deep; }

std::vector<std::uint32_t> SeatStretch::near_objects(const RequiredDistance& required,
                                                     const LeftOut& far) const {
  const Voxmap& voxmap = parts_->query.voxmap();
  std::vector<std::uint32_t> near;
  for (const guard::SeatObject& object : objects()) {
    const std::uint32_t number = object.object;
    if (number < far.size() && far[number] != 0) continue;
    LeftOut others(voxmap.header().object_count + std::size_t{1}, 1);
    others[number] = 0;
    PartDistance part(voxmap, parts_->query.shell(), others, required.voxels() + 1);
    const MinDistance smallest = part.at(parts_->in_seat, 0, required.voxels(), required.voxels());
    if (smallest.voxels < required.voxels()) near.push_back(number);
  }
  return near;
}

std::vector<std::uint32_t> SeatStretch::all_near_objects(const RequiredDistance& required,
                                                         const LeftOut& far) const {
  const Voxmap& voxmap = parts_->query.voxmap();
  std::vector<std::uint32_t> near = near_objects(required, far);
  // The nearest of the others, one after the other, until none is near.
  LeftOut left_out = with_objects(far, near);
  for (std::uint32_t n = 0; n < voxmap.header().object_count; ++n) {
    PartDistance part(voxmap, parts_->query.shell(), left_out, required.voxels() + 1);
    const MinDistance smallest = part.at(parts_->in_seat, 0, required.voxels());
    if (!(smallest.voxels < required.voxels()) || smallest.point == MinDistance::kNone) break;
    const glm::dvec3 place_m = part.place_m(parts_->in_seat, smallest.point);
    const std::uint32_t object = part.nearest(place_m).object;
    const bool is_new = object != 0 && (object >= left_out.size() || left_out[object] == 0);
    if (!is_new || part.is_of_side(place_m, smallest.voxels)) break;
    near.push_back(object);
    left_out = with_objects(std::move(left_out), std::array{object});
  }
  std::sort(near.begin(), near.end());
  return near;
}

bool SeatStretch::is_pushed_in(const Pose& world_from_center, const LeftOut& left_out) {
  ++parts_->looked_up;
  return parts_->probe->is_pushed_into_seat(world_from_center, left_out);
}

std::uint64_t SeatStretch::looked_up() const { return parts_->looked_up; }

std::optional<SeatStretch::PushedIn> SeatStretch::pushed_in(const Pose& world_from_center,
                                                            const LeftOut& left_out) {
  begin_path();
  follow(world_from_center);
  return deepest_barred(world_from_center, left_out);
}

void SeatStretch::begin_path() { parts_->contacts.seat_open = false; }

// Finds the points that are barred at the next pose of a path: also those that have gone through a
// surface since the pose before it.
void SeatStretch::follow(const Pose& world_from_center) {
  ++parts_->looked_up;
  std::swap(parts_->contacts, parts_->earlier);
  parts_->probe->query_pose(world_from_center, parts_->contacts);
  const glm::dvec3 shift_m = world_from_center.position_m - parts_->earlier_pose.position_m;
  parts_->probe->mark_crossings(parts_->earlier, glm::vec3(shift_m), parts_->contacts);
  parts_->earlier_pose = world_from_center;
}

// How much deeper a point lies than the part does in the seat, where the force begins earlier.
float SeatStretch::deeper_m(std::uint32_t contact, const guard::SeatObject& object) const {
  const field::ContactSet& contacts = parts_->contacts;
  const float distance_m = contacts.from_surface_m[contact];
  const float begins_m = contacts.depth_m[contact] + distance_m;
  return std::min(begins_m, object.installed_m) - distance_m;
}

std::optional<SeatStretch::PushedIn> SeatStretch::deepest_barred(const Pose& world_from_center,
                                                                 const LeftOut& left_out) const {
  const field::ContactSet& contacts = parts_->contacts;
  std::optional<PushedIn> deepest;
  for (std::uint32_t i = 0; contacts.barred > 0 && i < contacts.count; ++i) {
    if (contacts.is_barred[i] == 0 || contacts.of_seat[i] == 0) continue;
    const std::uint32_t object = parts_->probe->object_of(i);
    if (object < left_out.size() && left_out[object] != 0) continue;
    const field::Contact contact = contacts[i];
    const guard::SeatObject* const of_seat = parts_->probe->seat().find(object);
    // One that crossed a sheet is as deep as it says.
    const bool crossed = contacts.is_barred[i] == field::ContactSet::kCrossed;
    const float deep_m = crossed || of_seat == nullptr ? contact.depth_m : deeper_m(i, *of_seat);
    if (deepest && deep_m <= deepest->deeper_m) continue;
    deepest = {{}, object, world_from_center.position_m + glm::dvec3(contact.arm_m), deep_m};
  }
  return deepest;
}

void SeatStretch::find_floors(const Pose& world_from_center, std::vector<Floor>& floors) {
  field::ContactSet& contacts = parts_->contacts;
  parts_->probe->query_pose(world_from_center, contacts);
  floors.clear();
  const PshellView& v = parts_->query.shell().view();
  const glm::quat turn(world_from_center.orientation);
  const auto touching_m = static_cast<float>(kTouchVoxels * parts_->query.voxmap().voxel_size_m());
  for (std::uint32_t i = 0; i < contacts.count; ++i) {
    if (contacts.of_seat[i] == 0) continue;
    const guard::SeatObject* const object = parts_->probe->seat().find(parts_->probe->object_of(i));
    if (object == nullptr) continue;
    const field::Contact contact = contacts[i];
    const glm::vec3 normal =
        turn * glm::vec3(v.nx[contact.point], v.ny[contact.point], v.nz[contact.point]);
    const bool flush = glm::dot(normal, contact.direction) > kFlush;
    const float deep_m = deeper_m(i, *object);
    if (!flush && deep_m < -touching_m) continue;
    // Before an edge of the scene the field mixes its faces: there the part's own face tells.
    const glm::vec3 slope(contacts.gx[i], contacts.gy[i], contacts.gz[i]);
    const bool own = flush || glm::length(slope) <= guard::kFaceSlope;
    const float may_m = object->installed_m - object->floor_m;
    floors.push_back({contact.arm_m, own ? normal : contact.direction, may_m * kShallow - deep_m});
  }
}

// The first moment, looked for every step of travel, for whose pose `is_so`.
template <typename Test>
std::optional<Moment> SeatStretch::first_where(const CenterPath& path, const Moment& from,
                                               const Moment& to, const Test& is_so) const {
  const double step_m = kStepVoxels * parts_->query.voxmap().voxel_size_m();
  Moment at = from;
  double tested_m = -1;
  while (true) {
    const double travel_m = path.travel_m(at);
    const bool at_end = at.pose == to.pose && at.fraction == to.fraction;
    if (tested_m < 0 || travel_m > tested_m || at_end) {
      if (is_so(path.world_from_center(at))) return at;
      tested_m = travel_m;
    }
    if (at_end) return std::nullopt;
    // Onward by a step within the motion, or to its end.
    const double end = at.pose == to.pose ? to.fraction : 1;
    const double left_m =
        path.travel_m({at.pose + (end == 1 ? 1u : 0u), end == 1 ? 0 : end}) - travel_m;
    const double fraction =
        left_m > step_m ? at.fraction + (end - at.fraction) * step_m / left_m : end;
    at = fraction < 1 ? Moment{at.pose, fraction} : Moment{at.pose + 1, 0};
  }
}

std::optional<SeatStretch::PushedIn> SeatStretch::first_pushed_in(const CenterPath& path,
                                                                  const Moment& from,
                                                                  const Moment& to,
                                                                  const LeftOut& left_out) {
  std::optional<PushedIn> pushed;
  begin_path();
  const auto first = first_where(path, from, to, [&](const Pose& pose) {
    follow(pose);
    pushed = deepest_barred(pose, left_out);
    return pushed.has_value();
  });
  if (first) pushed->moment = *first;
  return pushed;
}

std::optional<Moment> SeatStretch::first_moment_pushed_in(const CenterPath& path,
                                                          const Moment& from, const Moment& to,
                                                          const LeftOut& left_out) {
  begin_path();
  return first_where(path, from, to, [&](const Pose& pose) {
    follow(pose);
    return deepest_barred(pose, left_out).has_value();
  });
}

}  // namespace forcelayer::clearance
