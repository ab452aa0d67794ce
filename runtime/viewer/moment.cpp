#include "runtime/viewer/moment.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <glm/geometric.hpp>

namespace forcelayer {

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
  moment.world_from_target = row.world_from_handle * handle_from_part;
  moment.on_hand = row.on_hand;
  moment.guard_cuts = row.guard_cuts;
  return moment;
}

Pose grip_of(const TraceRow& first) {
  return inverse(first.world_from_handle) * first.world_from_part;
}

std::vector<std::string> describe(const Moment& moment) {
  std::vector<std::string> lines;
  if (moment.time_s && moment.on_hand) {
    lines.push_back(text_of("t = %.3f s    on the hand: %.2f N, %.4f N m", *moment.time_s,
                            glm::length(moment.on_hand->force_n),
                            glm::length(moment.on_hand->torque_nm)));
  }
  const ContactView& view = moment.contacts;
  lines.push_back(
      text_of("%s    %u contacts, deepest %.2f mm    points: %u in the force layer, "
              "%u in proximity, %u in interior",
              frame_kind_name(moment.kind()), view.contacts, 1e3 * view.deepest_m, view.surface,
              view.proximity, view.interior));
  return lines;
}

}  // namespace forcelayer
