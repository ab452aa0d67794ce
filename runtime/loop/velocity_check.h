// Whether the velocity that a device claims is that of its poses.
#pragma once

#include "forcelayer/pose.h"

namespace forcelayer::loop {

// Adds up what the claim is ahead of the poses, forgetting it over kForgetS. A constant error of e
// adds up to e * kForgetS; a filter in the device that lags by t adds up to t times the speed.
// Tolerance: the noise of a pose, and kLagS (and the time between two readings) times the fastest
// motion that the poses showed of late. A still handle may claim 50 mm/s and 0.5 rad/s for ever.
class VelocityCheck {
 public:
  static constexpr double kForgetS = 0.02;
  static constexpr double kLagS = 0.01;
  static constexpr double kNoiseM = 0.001;
  static constexpr double kNoiseRad = 0.01;

  void reset() noexcept { *this = {}; }

  // Whether a reading was taken since reset(). Nothing shows the velocity of the first one.
  bool knows() const { return known_; }

  // Takes a reading `dt_s` after the last one. False where its claim cannot be; the claim then
  // counts as not made. True for the first one.
  bool believes(const Pose& device_from_handle, const Twist& claim, double dt_s) noexcept;

 private:
  // One of the two, linear or angular.
  struct Sum {
    glm::dvec3 ahead{0};  // m or rad: of the claims before the poses
    double fastest = 0;   // of the poses of late, m/s or rad/s

    bool takes(const glm::dvec3& moved, const glm::dvec3& claim, double noise,
               double dt_s) noexcept;
  };

  bool known_ = false;
  Pose last_;
  Sum linear_, angular_;
};

}  // namespace forcelayer::loop
