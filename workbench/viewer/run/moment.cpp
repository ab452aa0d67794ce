#include "workbench/viewer/run/moment.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <glm/geometric.hpp>
#include <utility>

#include "formats/result.h"

namespace forcelayer::viewer {

std::string text_of(const char* form, ...) {
  char text[512];
  va_list values;
  va_start(values, form);
  std::vsnprintf(text, sizeof text, form, values);
  va_end(values);
  return text;
}

FrameKind Moment::kind() const {
  const FrameKind seen = contacts.kind();
  return guard_cuts > 0 ? std::max(seen, FrameKind::kGuardCut) : seen;
}

Moment moment_of(const TraceRow& row, const Pose& handle_from_part) {
  Moment moment;
  moment.world_from_part = row.world_from_part;
  moment.time_s = row.time_s;
  moment.world_from_target =
      row.world_from_target.value_or(row.world_from_handle * handle_from_part);
  moment.on_hand = row.on_hand;
  moment.guard_cuts = row.guard_cuts;
  moment.clearance = row.clearance;
  moment.contacts.proximity = row.points_proximity;
  moment.contacts.surface = row.points_surface;
  moment.contacts.interior = row.points_interior;
  moment.contacts.contacts = row.contacts;
  return moment;
}

void find_contacts(ContactViewSource& source, Moment& moment) {
  const ContactView& counted = moment.contacts;
  ContactView found = moment.time_s ? source.as_counted(moment.world_from_part, counted)
                                    : source.at(moment.world_from_part);
  // A point on a voxel's face may fall on either side when a pose has been written as text.
  const auto differs = [](std::uint32_t a, std::uint32_t b) {
    constexpr std::uint32_t kSlack = 2;
    return std::max(a, b) - std::min(a, b) > kSlack + std::max(a, b) / 10;
  };
  moment.other_files = moment.time_s && (differs(counted.surface, found.surface) ||
                                         differs(counted.proximity, found.proximity) ||
                                         differs(counted.interior, found.interior));
  moment.contacts = std::move(found);
}

FrameKind kind_of(const TraceRow& row) { return moment_of(row, Pose{}).kind(); }

Pose grip_of(const TraceRow& first) {
  return inverse(first.world_from_handle) * first.world_from_part;
}

namespace {

std::string describe_seat(const std::vector<std::string>& objects) {
  constexpr std::size_t kNamed = 4;
  std::string line;
  for (std::size_t n = 0; n < objects.size() && n < kNamed; ++n) {
    line += (n == 0 ? "seated on " : ", ") + escaped(objects[n]);
  }
  if (objects.size() > kNamed) line += text_of(" and %zu more", objects.size() - kNamed);
  return line;
}

std::string describe_clearance(const std::optional<RowClearance>& clearance) {
  if (!clearance) return "no clearance is known";
  const double mm = std::floor(clearance->clearance_m * 1e6) / 1e3;  // never more than proven
  if (clearance->at_least) return text_of("clearance at least %.3f mm", mm);
  const std::string object = escaped(clearance->object);
  return text_of("clearance %.3f mm", mm) + (object.empty() ? "" : " to " + object);
}

}  // namespace

std::vector<std::string> describe(const Moment& moment) {
  std::vector<std::string> lines;
  if (moment.time_s) {
    const std::string at = moment.name.empty() ? "" : "at " + std::string(moment.name) + ": ";
    lines.push_back(text_of("%st = %.3f s", at.c_str(), *moment.time_s));
  }
  if (moment.time_s && moment.on_hand) {
    lines.back() +=
        text_of("    on the hand: %.2f N, %.4f N m", glm::length(moment.on_hand->force_n),
                glm::length(moment.on_hand->torque_nm));
    // With both files it is proven again at the pose, and told below.
    const bool told = moment.contacts.clearance_m || !moment.contacts.seated_on.empty();
    if (!told) lines.push_back(describe_clearance(moment.clearance));
  }
  const ContactView& view = moment.contacts;
  const std::string deepest =
      view.deepest_m > 0 ? text_of(", deepest %.2f mm", 1e3 * view.deepest_m) : "";
  lines.push_back(
      text_of("%u contact%s%s    points: %u in the force layer, %u in proximity, %u in interior",
              view.contacts, view.contacts == 1 ? "" : "s", deepest.c_str(), view.surface,
              view.proximity, view.interior));
  if (view.clearance_m) {
    const double mm = std::floor(1e6 * *view.clearance_m) / 1e3;
    lines.push_back(view.at_least ? text_of("clearance: at least %.3f mm", mm)
                                  : text_of("clearance: %.3f mm%s%s, proven", mm,
                                            view.nearest_object.empty() ? "" : " to ",
                                            escaped(view.nearest_object).c_str()));
  }
  if (!view.seated_on.empty()) {
    lines.push_back(describe_seat(view.seated_on) +
                    (view.clearance_m ? "" : ": no clearance is proven in the seat"));
  }
  if (moment.other_files) {
    lines.push_back(
        "these counts differ from the run's, because the run used other files or another --seat");
  }
  return lines;
}

}  // namespace forcelayer::viewer
