// Statistics of a loop's frames and of its clock, in constant memory.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "forcelayer/frame.h"
#include "runtime/loop/histogram.h"

namespace forcelayer::loop {

// Why a frame's output came later than one period after its tick: the first that applies.
enum class MissCause : std::uint32_t {
  kWokeLate,    // more than half of the delay had passed when the thread ran: others ran before it
  kMajorFault,  // it read a page from disk
  kPreempted,   // it was taken off the core in the middle
  kBlocked,     // it waited in the middle: a lock, or I/O
  kStoodStill,  // it was on its core, and the core did not run: the host of a virtual machine
  kMinorFault,  // it touched pages for the first time
  kLongTick,    // it computed for so long
};
inline constexpr std::size_t kMissCauses = 7;
const char* to_text(MissCause cause);

// The cost of one tick by the thread's clocks and counters.
struct TickCost {
  std::int64_t woke_late_ns = 0;  // after the tick's time
  std::int64_t tick_ns = 0;       // from there to the output
  std::int64_t cpu_ns = 0;        // part of tick_ns in which the thread ran
  std::uint32_t minor_faults = 0, major_faults = 0;
  std::uint32_t voluntary_switches = 0, involuntary_switches = 0;
};

// Reads the calling thread's clocks and counters around ticks.
class TickMeter {
 public:
  // The thread woke now, for the tick whose time was `tick_ns` (CLOCK_MONOTONIC).
  void woke(std::int64_t tick_ns) noexcept;
  // The output is out now. Returns the cost since woke().
  TickCost end() const noexcept;

 private:
  struct Counters {
    std::int64_t wall_ns = 0, cpu_ns = 0;
    std::int64_t minor_faults = 0, major_faults = 0, voluntary = 0, involuntary = 0;
  };
  static Counters now() noexcept;

  Counters at_waking_;
  std::int64_t woke_late_ns_ = 0;
};

struct MissedFrame {
  std::uint64_t frame = 0;
  std::int64_t late_ns = 0;  // of the output, after the end of the period
  std::int64_t step_ns = 0;
  TickCost cost;
  MissCause cause = MissCause::kLongTick;
};

MissCause cause_of(const TickCost& cost) noexcept;

// The worst of many, kept without order.
class WorstFrames {
 public:
  static constexpr std::size_t kKept = 16;
  void add(const MissedFrame& frame) noexcept;
  std::size_t size() const { return size_; }
  const MissedFrame& operator[](std::size_t i) const { return frames_[i]; }

 private:
  std::array<MissedFrame, kKept> frames_{};
  std::size_t size_ = 0;
};

// Objects are numbered as in the scene's file; those of a scene that was swapped in go on from
// there (Frame::objects_before).

// How long and how hard the part pushed against an object.
struct TouchedTotal {
  std::uint32_t object = 0;
  std::uint64_t frames = 0;
  double max_force_n = 0;
};

// The objects that were touched, in the order in which they were. Of more than fit, the later ones
// are only counted.
class TouchedObjects {
 public:
  static constexpr std::size_t kKept = 256;
  void add(const TouchedObject& touched) noexcept;
  std::span<const TouchedTotal> totals() const { return {totals_.data(), size_}; }
  std::uint64_t left_out() const { return left_out_; }  // frames times objects

 private:
  std::array<TouchedTotal, kKept> totals_{};
  std::size_t size_ = 0;
  std::uint64_t left_out_ = 0;
};

using TouchedInFrame = std::array<TouchedObject, 4>;

// Objects that the part pushes against in a frame, numbered as in LoopStatistics.
TouchedInFrame touched_in(const Frame& frame) noexcept;

// The first frame of a kind.
struct FirstFrame {
  double time_s = 0;
  TouchedInFrame touched{};
};

struct LoopStatistics {
  std::uint64_t frames = 0;
  std::uint64_t force_layer_frames = 0;  // a point in value 2 or 1
  std::uint64_t penetration_frames = 0;  // a point in value 1
  std::uint64_t contact_frames = 0;      // an intersection with depth
  std::uint64_t guard_cuts = 0;
  std::uint64_t barred_frames = 0;  // a point nearer than the guard allows
  std::uint64_t outside_map_frames = 0;
  std::uint64_t seated_frames = 0;  // a point nearer to the open seat than is allowed elsewhere
  std::uint64_t saturated_frames = 0;
  std::uint64_t faulty_frames = 0;
  std::uint64_t clutched_frames = 0;
  std::uint64_t held_readings = 0;            // frames without a fresh reading
  std::uint64_t deadline_misses = 0;          // output later than one period after the tick's time
  std::uint64_t skipped_ticks = 0;            // ticks that passed while a frame was late
  std::uint64_t dropped_frames = 0;           // that the ring had no room for
  std::uint64_t outcome_hash = 0;             // of all frames in order
  double max_force_n = 0, max_torque_nm = 0;  // of the step, about the handle
  double max_device_force_n = 0, max_device_torque_nm = 0;  // of the device's
  double generated_j = 0;                                   // over all contact episodes
  std::uint64_t guided_frames = 0;                          // in which a guide pulled at the hand
  double max_guide_force_n = 0, max_guide_torque_nm = 0;
  double guide_given_j = 0, guide_allowed_j = 0;  // Frame
  std::uint64_t contact_episodes = 0;             // from free space to free space
  double worst_episode_generated_j = 0;           // the most of one of them
  DurationHistogram step;                         // ns of the step
  DurationHistogram tick;                         // ns from waking to the output
  DurationHistogram wakeup;                       // ns by which the loop woke late: its jitter
  std::array<std::uint64_t, kMissCauses> misses_by_cause{};  // sum: deadline_misses
  WorstFrames worst;
  std::uint64_t minor_faults = 0, major_faults = 0;  // of the loop's thread, in its ticks
  std::uint64_t voluntary_switches = 0, involuntary_switches = 0;

  // The frame with the least clearance of those of which something is known.
  struct MinClearance {
    ClearanceKind kind = ClearanceKind::kNone;
    double clearance_m = 0, time_s = 0;
    glm::dvec3 point_m{0};
    std::uint32_t object = 0;  // nearest to the point; 0: not known
  };
  MinClearance min_clearance;
  std::uint64_t unproven_frames = 0;  // of which no clearance is known
  TouchedObjects touched;
  TouchedInFrame touched_last{};                     // in the last frame
  double force_last_n = 0;                           // of the step, there
  Pose part_last;                                    // world_from_center, there
  double longest_shift_m = 0, longest_turn_rad = 0;  // of the part, from a frame to the next

  // From when on the guarantee holds: the frame in which the seat closed, the first one without a
  // seat; none while the seat is open.
  std::optional<double> guarantee_from_s;
  // None: no such frame. Contacts with the objects of the open seat count as none here.
  std::optional<FirstFrame> first_penetration, first_contact, first_outside_map;

  void count(const Frame& frame) noexcept;
  // Only of a loop with a clock; `period_ns` is its period.
  void count(const Frame& frame, const TickCost& cost, std::int64_t period_ns) noexcept;

 private:
  void count_energy(const Frame& frame) noexcept;
  void count_clearance(const Frame& frame) noexcept;
  void note_firsts(const Frame& frame) noexcept;
  void note_motion(const Pose& part) noexcept;

  double past_episodes_generated_j_ = 0;
  bool in_episode_ = false;
};

}  // namespace forcelayer::loop
