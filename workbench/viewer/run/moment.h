// One moment of a run, and how a picture names it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "forcelayer/pose.h"
#include "workbench/viewer/run/contact_view.h"
#include "workbench/viewer/run/trace.h"

namespace forcelayer::viewer {

// The part at one moment.
struct Moment {
  Pose world_from_part;
  std::optional<double> time_s;
  std::string_view name;                  // of NotableRows::name_of()
  std::optional<Pose> world_from_target;  // where the hand wants the part
  std::optional<Wrench> on_hand;          // about the part's centroid, world axes
  std::uint32_t guard_cuts = 0;
  std::optional<RowClearance> clearance;  // as the run told it
  // Found from the files and the pose; without both files, the counts of the run alone.
  ContactView contacts;
  bool other_files = false;  // the contacts differ clearly from the run's counts

  FrameKind kind() const;
};

// The moment of a row; `handle_from_part` is the grip, for rows that do not tell the target.
Moment moment_of(const TraceRow& row, const Pose& handle_from_part);

// Finds the contacts at the moment's pose, in place of the counts of its run.
void find_contacts(ContactViewSource& source, Moment& moment);

// The kind of a row's frame, without the files.
FrameKind kind_of(const TraceRow& row);

// The grip of a run: the part starts without stretch, so its first row gives it.
Pose grip_of(const TraceRow& first);

// A few lines: time, force and torque; contacts and points; warnings.
std::vector<std::string> describe(const Moment& moment);

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string text_of(const char* form, ...);

}  // namespace forcelayer::viewer
