// A path that leads the hand. The guide is a weak spring from the handle to a point of the path
// that lies a little ahead of where the hand is; no part, no scene and no contact is in it.
//
// The law, with forces and lengths as at the device, the lever l = torque_nm / force_n, and the
// distance of two poses d^2 = gap^2 + l^2 angle^2:
//
// 1. s is where the path is nearest to the pose that the hand asks for. It is looked for on the
//    whole path when the guide engages, and from then on beside the last s and the anchor alone.
// 2. The anchor a lies between s and s + reach_m. It advances by speed_mps at most, and never away
//    from the hand: a hand that stays lets it come no farther than reach_m.
// 3. The force is k gap, the torque k l^2 sin(angle), each clamped by itself, with
//    k = force_n / reach_m.
// 4. Between two times at which it engages the guide gives the hand no more work than it was
//    stretched by when it engaged, and force_n times (reach_m and the farthest s since then): near
//    that budget it fades to nothing. So it is passive but for an energy that the path's length
//    bounds, whatever the hand does.
// 5. It takes what the contact leaves below the device's limits. Its part against the contact's
//    force fades with that force, and is nothing where that reaches force_n.
// 6. A frame with a fault gives nothing, and so does one without an armed output. Then, and after
//    the clutch and the button, it engages anew and comes in over ramp_s.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "forcelayer/pose.h"

namespace forcelayer::loop {

inline constexpr double kHighestGuideForceN = 1;
inline constexpr double kGuideLeverM = 0.02;

struct GuideLimits {
  double force_n = 0.3;                       // most that it pulls with, at the device
  double torque_nm = kGuideLeverM * force_n;  // the same for its torque
  double reach_m = 0.02;    // how far the anchor is ahead, and the stretch at full force
  double speed_mps = 0.05;  // of the anchor
  double ramp_s = 1;        // from nothing to full strength
  double fade_s = 0.05;     // from full strength to nothing at the button
};

// Places of a path at even distances, d as above. No point of it is left out; corners between two
// rows may be cut by half a step.
class GuidePath {
 public:
  static constexpr std::size_t kMaxPlaces = 4096;
  static constexpr double kStepM = 0.0005;

  // `world_from_center`: at least one pose of the part's centroid frame. `motion_scale`: scene
  // meters a meter of the device.
  GuidePath(std::span<const Pose> world_from_center, const GuideLimits& limits,
            double motion_scale);

  std::size_t places() const { return places_.size(); }
  double length_m() const { return step_m_ * static_cast<double>(places_.size() - 1); }
  Pose at(double s_m) const noexcept;  // the ends beyond the ends

  // The distance along the path at which it is nearest to a pose, of all or from a little before
  // one distance to a little behind another.
  double nearest(const Pose& world_from_center) const noexcept;
  double nearest(const Pose& world_from_center, double from_m, double to_m) const noexcept;

 private:
  using Place = std::array<double, 7>;  // position over the scale, quaternion times 2 l
  Place place_of(const Pose& pose) const noexcept;
  double nearest(const Pose& pose, std::size_t first, std::size_t last) const noexcept;

  double scale_, lever_m_;
  double step_m_ = 0;  // between two places
  std::vector<Place> places_;
};

// One frame as the guide sees it.
struct GuideFrame {
  Pose world_from_handle;
  Pose handle_from_center;  // the grip
  Wrench contact;           // that the hand feels without a guide: about the handle, world axes,
                            // newtons at the device
  double max_force_n = 0, max_torque_nm = 0;  // of the output
  bool placed = true;                         // the handle's pose is known
  bool sound = false;                         // no fault, and the output may carry force
  bool wanted = true;                         // by the user
};

class Guide {
 public:
  Guide(GuidePath path, const GuideLimits& limits, double motion_scale)
      : path_(std::move(path)), limits_(limits), scale_(motion_scale) {}

  // The wrench on the hand beside the contact's: about the handle, world axes, newtons at the
  // device. Once a frame.
  Wrench pull(const GuideFrame& frame, double dt_s) noexcept;

  // The fraction of that wrench that the output lets through until the next frame.
  void leave(double gain) noexcept;
  const Wrench& left() const { return left_; }

  double work_j() const { return work_j_; }  // on the hand, since the frame before
  // The most of the work on the hand since the guide engaged, summed over the times at which it
  // did, and what that may be.
  double given_j() const { return past_j_ + peak_j_; }
  double allowed_j() const { return past_allowed_j_ + allowed_j_; }
  double at_m() const { return s_m_; }  // where the hand is
  double length_m() const { return path_.length_m(); }

 private:
  void engage(const GuideFrame& frame) noexcept;
  Wrench spring(const GuideFrame& frame) const noexcept;
  double stretch_j(const GuideFrame& frame) const noexcept;
  Pose wanted_handle(const GuideFrame& frame) const noexcept;

  GuidePath path_;
  GuideLimits limits_;
  double scale_;
  double strength_ = 0;  // 0: it engages when it may
  double s_m_ = 0, anchor_m_ = 0;
  double engaged_m_ = 0, farthest_m_ = 0;          // s when it engaged, and the farthest since
  double begin_j_ = 0;                             // stretch when it engaged
  double sum_j_ = 0, peak_j_ = 0, allowed_j_ = 0;  // since then
  double past_j_ = 0, past_allowed_j_ = 0;
  double work_j_ = 0;
  Wrench pulled_, left_;
  Pose handle_;  // in the last frame
};

}  // namespace forcelayer::loop
