// The seat of a part along its path: which objects it touches where it is installed, and whether it
// is pushed deeper into them while it is there.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/clearance/center_path.h"
#include "runtime/clearance/front.h"
#include "runtime/clearance/required_distance.h"
#include "runtime/guard/seat.h"

namespace forcelayer::clearance {

class SeatStretch {
 public:
  // Finds the objects that the part touches with its centroid frame at `world_from_center`, as
  // voxrun does (runtime/guard/README.md, "Seats"). Both files outlive the result. Errors: kUsage
  // where PoseGuard::find_seat() refuses the pose. With the depth of the meshes, one that is
  // refused only because it lies too deep for the stored distances is found: shell points feel
  // nothing in it, and `too_deep` says why.
  static Result<SeatStretch> find(const Voxmap& voxmap, const Pshell& shell,
                                  const Pose& world_from_center,
                                  guard::SeatDepth depth = guard::SeatDepth::kStored);
  const std::optional<Error>& too_deep() const;
  SeatStretch(SeatStretch&&) noexcept;
  ~SeatStretch();

  std::span<const guard::SeatObject> objects() const;

  // The numbers of those that are not proven to be `required` away where the part is installed, nor
  // are among `far`: only they may be nearer than that while it is in its seat.
  std::vector<std::uint32_t> near_objects(const RequiredDistance& required,
                                          const LeftOut& far = {}) const;
  // The same of all objects of the scene, touched or not.
  std::vector<std::uint32_t> all_near_objects(const RequiredDistance& required,
                                              const LeftOut& far = {}) const;

  // A shell point that the open seat's guard would bar from where it is.
  struct PushedIn {
    Moment moment;
    std::uint32_t object = 0;  // the nearest: of the seat
    glm::dvec3 point_m{0};     // world
    double deeper_m = 0;       // than the object is touched in the seat
  };
  // The deepest such point at the first moment from `from` to `to`, tested every half voxel of
  // travel, at which there is one, or at which a point has gone through a surface since the moment
  // tested before. None where there is no such moment. Objects that are left out do not count.
  std::optional<PushedIn> first_pushed_in(const CenterPath& path, const Moment& from,
                                          const Moment& to, const LeftOut& left_out);
  // The same at one pose, where nothing goes through; its moment means nothing.
  std::optional<PushedIn> pushed_in(const Pose& world_from_center, const LeftOut& left_out);
  // Whether there is one, and at which moment first.
  bool is_pushed_in(const Pose& world_from_center, const LeftOut& left_out);
  std::optional<Moment> first_moment_pushed_in(const CenterPath& path, const Moment& from,
                                               const Moment& to, const LeftOut& left_out);
  std::uint64_t looked_up() const;  // poses, by the four above

  // A shell point flush before a face of the seat, or touching an edge.
  struct Floor {
    glm::vec3 arm_m{0};      // from the centroid, world axes
    glm::vec3 direction{0};  // unit, out of the object
    float left_m = 0;        // that it can go against the direction until it lies an eighth as
                             // deep as it may; negative: it lies deeper
  };
  // Those at a pose, in the shell's order.
  void find_floors(const Pose& world_from_center, std::vector<Floor>& floors);

 private:
  struct Parts;
  template <typename Test>
  std::optional<Moment> first_where(const CenterPath& path, const Moment& from, const Moment& to,
                                    const Test& is_so) const;
  explicit SeatStretch(std::unique_ptr<Parts> parts);
  void begin_path();
  void follow(const Pose& world_from_center);
  float deeper_m(std::uint32_t contact, const guard::SeatObject& object) const;
  std::optional<PushedIn> deepest_barred(const Pose& world_from_center,
                                         const LeftOut& left_out) const;

  std::unique_ptr<Parts> parts_;
};

}  // namespace forcelayer::clearance
