// The scenes of a run, and the change from one to the next while the loop runs (--scene-next).
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "forcelayer/run.h"
#include "runtime/loop/servo.h"
#include "runtime/model/simulation.h"
#include "runtime/voxrun/options.h"

namespace forcelayer::voxrun {

// A scene that was in use, as it is remembered once its file is closed.
struct UsedScene {
  std::string path;
  double from_s = 0;
  // [number in the file - 1], the first of several siblings with "[1]".
  std::vector<std::string> object_names;
  SeparationGuarantee guarantee;
  std::vector<guard::SeatObject> seat;
};

// The scenes of a run in their order. Objects are numbered as in LoopStatistics. Any thread may
// call it; the seat of the first scene is that of its run.
class Scenes {
 public:
  // `first` must outlive this, and stay where it is.
  Scenes(const Run& first, const std::string& path);

  const Run& first() const { return first_; }
  const Parameters& parameters() const { return first_.parameters(); }

  void add(std::unique_ptr<UsedScene> scene);
  void begins(std::uint32_t scene, double time_s);  // Frame::scene

  std::size_t count() const;
  const UsedScene& operator[](std::size_t scene) const;  // stays where it is
  const UsedScene& last() const { return (*this)[count() - 1]; }
  // Empty for 0, and where the file has none.
  std::string object_name(std::uint32_t object) const;
  // "object 3" by its number in the file, where it has no name there.
  std::string object_text(std::uint32_t object) const;
  std::vector<std::string> object_texts() const;  // of all objects, in the order of their numbers
  // As a sentence shows it: the end of its name that no other object has. Empty for 0.
  std::string shown_name(std::uint32_t object) const;
  std::vector<guard::SeatObject> seat() const;  // in the scene that came last
  SeparationGuarantee guarantee() const;        // the least of all

 private:
  const Run& first_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<UsedScene>> scenes_;  // the first one's seat is empty: see first_
};

// Reads scenes on a thread of its own while the loop runs. When one is ready, the servo holds the
// part; where it is, its seat in the new scene is found; then the servo takes the scene between two
// ticks. On an error the scene stays as it is.
class SceneChange {
 public:
  // Everything given must outlive this; `button` (SIGUSR1) is set to 1 from outside.
  SceneChange(const Options& options, const RunRequest& request, Scenes& scenes,
              std::atomic<int>& button);
  ~SceneChange();

  // Before the first tick.
  void begin(loop::Servo& servo);

  // Each frame in order, off the loop's thread: when a change is due, and where the part is.
  // Returns what happened since, a line for each event; empty for most frames.
  std::vector<std::string> see(const Frame& frame);

  // Once the loop has ended: ends the thread.
  void finish();

  // After finish(): the error of the first scene of --scene-next that was not taken when it was
  // due.
  const Status& missed() const { return missed_; }

  // The map in use, once another scene was taken than the first one; else null.
  const Voxmap* map() const { return current_ ? &current_->simulation().voxmap() : nullptr; }

 private:
  bool is_due(const Frame& frame);
  bool is_listed(const std::string& path) const;
  void run();
  Status change();
  Status wait_until_held(std::unique_lock<std::mutex>& lock);
  void say(std::string line);

  const Options& options_;
  RunRequest request_;
  Scenes& scenes_;
  std::atomic<int>& button_;
  loop::Servo* servo_ = nullptr;
  std::optional<Run> current_, next_;  // after the first; `next_` until the servo has taken it
  std::size_t listed_ = 0;             // scenes of --scene-next that were asked for
  std::uint32_t buttons_ = 0;          // of the last frame
  bool due_ = false;                   // a change was asked for, and has not begun
  Status missed_;

  std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::string asked_;  // the file to read; empty: none is due
  bool ended_ = false;
  bool is_held_ = false;     // in the last frame, and where the part was
  std::uint32_t scene_ = 0;  // of that frame
  Pose world_from_center_;
  std::vector<std::string> said_;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace forcelayer::voxrun
