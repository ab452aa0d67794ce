// The seat of a part along its path: which objects it touches where it is installed, and whether it
// is pushed deeper into them while it is there.
#pragma once

#include <memory>
#include <optional>
#include <span>

#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/clearance/center_path.h"
#include "runtime/field/seat.h"

namespace forcelayer::clearance {

class SeatStretch {
 public:
  // Finds the objects that the part touches with its centroid frame at `world_from_center`, as
  // voxrun does (runtime/field/README.md, "Seats"). Both files outlive the result. Errors: kUsage
  // where FieldProbe::find_seat() refuses the pose.
  static Result<SeatStretch> find(const Voxmap& voxmap, const Pshell& shell,
                                  const Pose& world_from_center);
  SeatStretch(SeatStretch&&) noexcept;
  ~SeatStretch();

  std::span<const field::SeatObject> objects() const;

  // A shell point that the open seat's guard would bar from where it is.
  struct PushedIn {
    Moment moment;
    std::uint32_t object = 0;  // the nearest: of the seat
    glm::dvec3 point_m{0};     // world
    double deeper_m = 0;       // than the object is touched in the seat
  };
  // The deepest such point at the first moment from `from` to `to`, tested every half voxel of
  // travel, at which there is one. None where there is no such moment.
  std::optional<PushedIn> first_pushed_in(const CenterPath& path, const Moment& from,
                                          const Moment& to);

 private:
  struct Parts;
  explicit SeatStretch(std::unique_ptr<Parts> parts);
  std::optional<PushedIn> pushed_in(const Pose& world_from_center);

  std::unique_ptr<Parts> parts_;
};

}  // namespace forcelayer::clearance
