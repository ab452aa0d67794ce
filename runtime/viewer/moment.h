// One moment of a run, and how a picture names it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/pose.h"
#include "runtime/viewer/contact_view.h"
#include "runtime/viewer/trace.h"

namespace forcelayer {

// The part at one moment.
struct Moment {
  Pose world_from_part;
  std::optional<double> time_s;
  std::optional<Pose> world_from_target;  // where the hand wants the part
  std::optional<Wrench> on_hand;          // about the part's centroid, world axes
  std::uint32_t guard_cuts = 0;
  ContactView contacts;  // empty without a voxmap or a shell

  FrameKind kind() const;
};

// The moment of a row; `handle_from_part` is the grip.
Moment moment_of(const TraceRow& row, const Pose& handle_from_part);

// The grip of a run: the part starts without stretch, so its first row gives it.
Pose grip_of(const TraceRow& first);

// Two lines at most: time, force and torque; then kind, contacts and points.
std::vector<std::string> describe(const Moment& moment);

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text_of(const char* form, ...);

}  // namespace forcelayer
