#include "runtime/loop/loop_statistics.h"

#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/machine/real_time.h"

namespace forcelayer::loop {
namespace {

std::int64_t thread_cpu_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

// The number of an object of the frame among those of all scenes; 0 stays 0.
std::uint32_t numbered(const Frame& frame, std::uint32_t object) noexcept {
  return object == 0 ? 0 : frame.objects_before + object;
}

}  // namespace

TouchedInFrame touched_in(const Frame& frame) noexcept {
  auto touched = frame.result.report.touched;
  for (TouchedObject& object : touched) object.object = numbered(frame, object.object);
  return touched;
}

const char* to_text(MissCause cause) {
  switch (cause) {
    case MissCause::kWokeLate:
      return "woke late";
    case MissCause::kMajorFault:
      return "page read from disk";
    case MissCause::kPreempted:
      return "preempted";
    case MissCause::kBlocked:
      return "blocked";
    case MissCause::kStoodStill:
      return "CPU core stalled";
    case MissCause::kMinorFault:
      return "new pages";
    case MissCause::kLongTick:
      break;
  }
  return "long tick";
}

TickMeter::Counters TickMeter::now() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {machine::monotonic_ns(), thread_cpu_ns(), usage.ru_minflt,
          usage.ru_majflt,         usage.ru_nvcsw,  usage.ru_nivcsw};
}

void TickMeter::woke(std::int64_t tick_ns) noexcept {
  at_waking_ = now();
  woke_late_ns_ = at_waking_.wall_ns - tick_ns;
}

TickCost TickMeter::end() const noexcept {
  const Counters& a = at_waking_;
  const Counters b = now();
  const auto more = [](std::int64_t from, std::int64_t to) {
    return static_cast<std::uint32_t>(to - from);
  };
  return {woke_late_ns_,
          b.wall_ns - a.wall_ns,
          b.cpu_ns - a.cpu_ns,
          more(a.minor_faults, b.minor_faults),
          more(a.major_faults, b.major_faults),
          more(a.voluntary, b.voluntary),
          more(a.involuntary, b.involuntary)};
}

MissCause cause_of(const TickCost& cost) noexcept {
  if (cost.woke_late_ns > cost.tick_ns) return MissCause::kWokeLate;
  if (cost.major_faults > 0) return MissCause::kMajorFault;
  if (cost.involuntary_switches > 0) return MissCause::kPreempted;
  if (cost.voluntary_switches > 0) return MissCause::kBlocked;
  if (cost.cpu_ns < cost.tick_ns / 2) return MissCause::kStoodStill;
  return cost.minor_faults > 0 ? MissCause::kMinorFault : MissCause::kLongTick;
}

void WorstFrames::add(const MissedFrame& frame) noexcept {
  if (size_ < kKept) {
    frames_[size_++] = frame;
    return;
  }
  const auto smallest =
      std::min_element(frames_.begin(), frames_.end(),
                       [](const auto& a, const auto& b) { return a.late_ns < b.late_ns; });
  if (smallest->late_ns < frame.late_ns) *smallest = frame;
}

void TouchedObjects::add(const TouchedObject& touched) noexcept {
  std::size_t at = 0;
  while (at < size_ && totals_[at].object != touched.object) ++at;
  if (at == kKept) {
    ++left_out_;
    return;
  }
  size_ = std::max(size_, at + 1);
  TouchedTotal& total = totals_[at];
  total.object = touched.object;
  ++total.frames;
  total.max_force_n = std::max(total.max_force_n, double{touched.force_n});
}

// An episode (passivity.h) begins where the part leaves free space.
void LoopStatistics::count_energy(const Frame& frame) noexcept {
  const StepReport& report = frame.result.report;
  const bool in_contact = report.interior + report.surface + report.proximity > 0;
  if (in_contact && !in_episode_) {
    ++contact_episodes;
    past_episodes_generated_j_ = generated_j;
  }
  in_episode_ = in_contact;
  generated_j = frame.generated_j;
  worst_episode_generated_j =
      std::max(worst_episode_generated_j, generated_j - past_episodes_generated_j_);
}

void LoopStatistics::count_clearance(const Frame& frame) noexcept {
  if (frame.input.valid == kInputClutched) return;  // the part stands where it was
  const StepReport& report = frame.result.report;
  if (report.clearance_kind == ClearanceKind::kNone) {
    ++unproven_frames;
    return;
  }
  if (min_clearance.kind != ClearanceKind::kNone &&
      report.clearance_m >= min_clearance.clearance_m) {
    return;
  }
  min_clearance = {report.clearance_kind, report.clearance_m, frame.time_s, report.nearest_point_m,
                   numbered(frame, report.nearest_object)};
}

void LoopStatistics::note_firsts(const Frame& frame) noexcept {
  const StepReport& report = frame.result.report;
  const auto note = [&](bool happened, std::optional<FirstFrame>& first) {
    if (happened && !first) first = FirstFrame{frame.time_s, touched_in(frame)};
  };
  note(report.interior > 0, first_penetration);
  note(report.contacts > report.seat_contacts, first_contact);
  note(report.outside_map != 0, first_outside_map);
  if (report.seat_open != 0) {
    guarantee_from_s.reset();
  } else if (!guarantee_from_s) {
    guarantee_from_s = frame.time_s;
  }
}

void LoopStatistics::note_motion(const Pose& part) noexcept {
  if (frames > 0) {
    const double half_turn = std::abs(glm::dot(part.orientation, part_last.orientation));
    longest_shift_m =
        std::max(longest_shift_m, glm::length(part.position_m - part_last.position_m));
    longest_turn_rad = std::max(longest_turn_rad, 2 * std::acos(std::min(1.0, half_turn)));
  }
  part_last = part;
}

void LoopStatistics::count(const Frame& frame) noexcept {
  const StepReport& report = frame.result.report;
  note_motion(report.world_from_center);
  ++frames;
  force_layer_frames += report.surface + report.interior > 0;
  penetration_frames += report.interior > 0;
  contact_frames += report.contacts > 0;
  guard_cuts += report.guard_cuts;
  barred_frames += report.barred > 0;
  outside_map_frames += report.outside_map;
  seated_frames += report.seated > 0;
  saturated_frames += report.saturated;
  faulty_frames += report.faults != 0;
  clutched_frames += frame.input.valid == kInputClutched;
  held_readings += frame.health.age_fraction > 0;
  outcome_hash = (outcome_hash ^ frame.outcome_hash) * 0x100000001b3u;
  max_force_n = std::max(max_force_n, glm::length(frame.result.wrench.force_n));
  max_torque_nm = std::max(max_torque_nm, glm::length(frame.result.at_handle.torque_nm));
  max_device_force_n = std::max(max_device_force_n, glm::length(frame.device_wrench.force_n));
  max_device_torque_nm = std::max(max_device_torque_nm, glm::length(frame.device_wrench.torque_nm));
  guided_frames += frame.guide_force_n > 0 || frame.guide_torque_nm > 0;
  max_guide_force_n = std::max(max_guide_force_n, frame.guide_force_n);
  max_guide_torque_nm = std::max(max_guide_torque_nm, frame.guide_torque_nm);
  guide_given_j = frame.guide_given_j;
  guide_allowed_j = frame.guide_allowed_j;
  count_energy(frame);
  count_clearance(frame);
  note_firsts(frame);
  touched_last = touched_in(frame);
  force_last_n = glm::length(frame.result.wrench.force_n);
  for (const TouchedObject& pushed : touched_last) {
    if (pushed.object != 0) touched.add(pushed);
  }
  step.record(frame.step_ns);
}

void LoopStatistics::count(const Frame& frame, const TickCost& cost,
                           std::int64_t period_ns) noexcept {
  count(frame);
  tick.record(cost.tick_ns);
  wakeup.record(cost.woke_late_ns);
  minor_faults += cost.minor_faults;
  major_faults += cost.major_faults;
  voluntary_switches += cost.voluntary_switches;
  involuntary_switches += cost.involuntary_switches;
  const std::int64_t late_ns = cost.woke_late_ns + cost.tick_ns - period_ns;
  if (late_ns <= 0) return;
  const MissCause cause = cause_of(cost);
  ++deadline_misses;
  ++misses_by_cause[static_cast<std::size_t>(cause)];
  worst.add({frame.number, late_ns, frame.step_ns, cost, cause});
}

}  // namespace forcelayer::loop
