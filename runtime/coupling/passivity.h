// What the device sees of the energy: a passivity observer per contact episode (after Hannaford and
// Ryu 2002), the entry into contact without a blow, and a damper that takes back what was
// generated.
#pragma once

#include "forcelayer/step.h"

namespace forcelayer {

// Work of a wrench that was held while the target of the coupling went from one pose to another, J.
// Positive: the hand received it. (A device holds its output between samples, so this is exact.)
double held_work_j(const Wrench& wrench, const Pose& from, const Pose& to) noexcept;

// Adds what the hand received. An episode ends in free space, where the wrench is exactly zero, and
// takes its credit with it: kept, it would hide later activity. The peak of what a hand has
// received is what a passive scene, which stores nothing at first, could not give.
void add_given(EpisodeEnergy& energy, double to_hand_j) noexcept;
void end_episode(EpisodeEnergy& energy) noexcept;
inline double total_generated_j(const EpisodeEnergy& energy) noexcept {
  return energy.generated_j + energy.peak_j;
}

// Free space gives the hand exactly zero, whatever the coupling's stretch (paper 5.2). When contact
// begins, that stretch was never paid for: felt at once it would be a blow, and energy from
// nowhere. So the stretch of that moment is held back: of a later stretch, the part along it, up to
// its size. What is held back only shrinks: with the stretch itself, and with time, so that a part
// held far from a hand that jumped is felt again, gently. Returns what is felt.
glm::dvec3 felt_stretch(const glm::dvec3& stretch, glm::dvec3& held_back, double dt_s) noexcept;

inline constexpr double kHeldBackFadeS = 2;

// The passivity controller: what the hand was given beyond what it paid in this episode is taken
// back by a damper at the handle, no stronger than `limit_ns_per_m`. Its strength follows the need
// within kControlS, up and down, so that it cannot buzz; it never drives, and vanishes with the
// episode's debt. `radius_m` weighs turning against going: the damper of the rotation is the
// same times radius squared.
Wrench passivity_damping(EpisodeEnergy& energy, const Twist& handle_velocity, double radius_m,
                         double limit_ns_per_m, double dt_s) noexcept;

inline constexpr double kControlS = 0.005;

}  // namespace forcelayer
