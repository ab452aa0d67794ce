#include "runtime/voxrun/scenes.h"

#include <algorithm>
#include <chrono>
#include <set>

#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"
#include "runtime/machine/real_time.h"
#include "runtime/run/baked_files.h"
#include "runtime/voxrun/verdict.h"

namespace forcelayer::voxrun {
namespace {

using command::text;

constexpr auto kHoldTimeout = std::chrono::seconds(1);  // a fade takes 50 ms

std::unique_ptr<UsedScene> used(const Run& run, const std::string& path) {
  auto scene = std::make_unique<UsedScene>();
  scene->path = path;
  scene->guarantee = run.guarantee();
  const std::uint32_t count = run.simulation().voxmap().header().object_count;
  std::set<std::string_view> stored;
  for (std::uint32_t n = 1; n <= count; ++n) stored.insert(run.object_name(n));
  for (std::uint32_t n = 1; n <= count; ++n) {
    std::string& name = scene->object_names.emplace_back(run.object_name(n));
    if (stored.contains(name + "[2]")) name += "[1]";  // as command::numbered_name()
  }
  return scene;
}

std::optional<double> smallest(const std::optional<double>& a, const std::optional<double>& b) {
  return a && b ? std::optional(std::min(*a, *b)) : std::nullopt;
}

}  // namespace

Scenes::Scenes(const Run& first, const std::string& path) : first_(first) {
  scenes_.push_back(used(first, path));
}

void Scenes::add(std::unique_ptr<UsedScene> scene) {
  const std::lock_guard lock(mutex_);
  scenes_.push_back(std::move(scene));
}

void Scenes::begins(std::uint32_t scene, double time_s) {
  const std::lock_guard lock(mutex_);
  scenes_[scene]->from_s = time_s;
}

std::size_t Scenes::count() const {
  const std::lock_guard lock(mutex_);
  return scenes_.size();
}

const UsedScene& Scenes::operator[](std::size_t scene) const {
  const std::lock_guard lock(mutex_);
  return *scenes_[scene];
}

std::string Scenes::object_name(std::uint32_t object) const {
  for (std::size_t n = 0; object > 0 && n < count(); ++n) {
    const std::vector<std::string>& names = (*this)[n].object_names;
    if (object <= names.size()) return names[object - 1];
    object -= static_cast<std::uint32_t>(names.size());
  }
  return "";
}

std::string Scenes::object_text(std::uint32_t object) const {
  if (object == 0) return "";
  const std::string name = object_name(object);
  return name.empty() ? text("object %u", object) : name;
}

std::vector<std::string> Scenes::object_texts() const {
  std::vector<std::string> texts;
  for (std::size_t n = 0; n < count(); ++n) {
    for (std::size_t i = 0; i < (*this)[n].object_names.size(); ++i) {
      texts.push_back(object_text(static_cast<std::uint32_t>(texts.size() + 1)));
    }
  }
  return texts;
}

std::string Scenes::shown_name(std::uint32_t object) const {
  return escaped(command::short_name(object_text(object), object_texts()));
}

std::vector<guard::SeatObject> Scenes::seat() const {
  const std::size_t last = count() - 1;
  const std::span<const guard::SeatObject> of_last =
      last == 0 ? first_.simulation().seat() : (*this)[last].seat;
  std::uint32_t before = 0;
  for (std::size_t n = 0; n < last; ++n) {
    before += static_cast<std::uint32_t>((*this)[n].object_names.size());
  }
  std::vector<guard::SeatObject> seat(of_last.begin(), of_last.end());
  for (guard::SeatObject& of_seat : seat) {
    if (of_seat.object != 0) of_seat.object += before;
  }
  return seat;
}

SeparationGuarantee Scenes::guarantee() const {
  SeparationGuarantee all = (*this)[0].guarantee;
  for (std::size_t n = 1; n < count(); ++n) {
    all.tested_m = smallest(all.tested_m, (*this)[n].guarantee.tested_m);
    all.swept_m = smallest(all.swept_m, (*this)[n].guarantee.swept_m);
  }
  return all;
}

SceneChange::SceneChange(const Options& options, const RunRequest& request, Scenes& scenes,
                         std::atomic<int>& button)
    : options_(options), request_(request), scenes_(scenes), button_(button), thread_([this] {
        run();
      }) {}

SceneChange::~SceneChange() { finish(); }

void SceneChange::begin(loop::Servo& servo) { servo_ = &servo; }

void SceneChange::finish() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void SceneChange::say(std::string line) {
  const std::lock_guard lock(mutex_);
  said_.push_back(std::move(line));
}

// By the button, the signal, or the time of the scene that is next.
bool SceneChange::is_due(const Frame& frame) {
  const std::uint32_t pressed = frame.input.buttons & ~buttons_;
  buttons_ = frame.input.buttons;
  const bool button = options_.scene_button && (pressed >> *options_.scene_button & 1) != 0;
  if (button_.exchange(0, std::memory_order_relaxed) != 0 || button) return true;
  if (listed_ == options_.scene_next.size()) return false;
  const auto& at_s = options_.scene_next[listed_].at_s;
  return asked_.empty() && at_s && frame.time_s >= *at_s;
}

std::vector<std::string> SceneChange::see(const Frame& frame) {
  due_ |= is_due(frame);
  const std::unique_lock lock(mutex_);
  is_held_ = frame.health.swapping && frame.input.valid == kInputClutched;
  world_from_center_ = frame.result.report.world_from_center;
  std::vector<std::string> events = std::move(said_);
  said_.clear();
  if (frame.scene != scene_) {
    scene_ = frame.scene;
    scenes_.begins(scene_, frame.time_s);
    const std::string seat = seat_text(scenes_, 0.1 * scenes_.parameters().voxel_size_m);
    events.push_back("the scene is now " + escaped(scenes_.last().path) +
                     (seat.empty() ? "" : "; the part is seated on " + seat) +
                     "; guaranteed separation: " + guarantee_text(scenes_.last().guarantee));
  }
  // A frame that is held may be of the change before.
  if (due_ && asked_.empty() && !frame.health.swapping) {
    due_ = false;
    asked_ = listed_ < options_.scene_next.size() ? options_.scene_next[listed_++].path
                                                  : scenes_.last().path;
  }
  if (!asked_.empty()) changed_.notify_all();
  return events;
}

void SceneChange::run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return ended_ || !asked_.empty(); });
    if (ended_) return;
    lock.unlock();
    const Status done = change();
    servo_->set_hold(false);
    if (!done) say("the scene is not replaced: " + to_line(done.error()));
    lock.lock();
    if (!done && missed_ && is_listed(asked_)) missed_ = done;
    asked_.clear();
  }
}

// Else it is one that the user asked for anew, and can ask for again.
bool SceneChange::is_listed(const std::string& path) const {
  const auto& listed = options_.scene_next;
  return std::any_of(listed.begin(), listed.end(), [&](const auto& s) { return s.path == path; });
}

Status SceneChange::wait_until_held(std::unique_lock<std::mutex>& lock) {
  if (!changed_.wait_for(lock, kHoldTimeout, [&] { return ended_ || is_held_; })) {
    return Error{ErrorCode::kDeviceFailed, "", "",
                 "the part cannot be held still, because the device gives no readings",
                 "try again when the device gives readings"};
  }
  return {};
}

Status SceneChange::change() {
  if (Status can = check_scene_change(options_, "SIGUSR1"); !can) return can;
  request_.scene = asked_;  // which see() leaves alone until it is empty
  auto voxmap = open_scene(request_.scene, request_.expected_sha256);
  if (!voxmap) return voxmap.error();
  auto shell = open_part(request_.part, request_.expected_sha256);
  if (!shell) return shell.error();
  auto next = open_run(std::move(*voxmap), std::move(*shell), request_);
  if (!next) return next.error();
  next_ = std::move(*next);
  model::Simulation& simulation = next_->simulation();
  for (const std::string& warning : simulation.give_helpers_real_time_priority()) say(warning);
  for (const std::string& warning : next_->warnings()) say("warning: " + warning);

  std::unique_lock lock(mutex_);
  servo_->set_hold(true);
  if (Status held = wait_until_held(lock); !held || ended_) return held;
  const Pose world_from_center = world_from_center_;
  lock.unlock();
  if (Status seated = simulation.find_seat(world_from_center); !seated) return seated;
  auto scene = used(*next_, request_.scene.string());
  scene->seat.assign(simulation.seat().begin(), simulation.seat().end());
  scenes_.add(std::move(scene));
  PartStart start;
  start.world_from_part = simulation.world_from_part(world_from_center);
  // It is refused for another rate, or beside another swap: neither can be.
  static_cast<void>(servo_->request_swap(simulation, start));
  lock.lock();
  changed_.wait(lock, [&] { return ended_ || !servo_->swapping(); });
  if (servo_->swapping()) return {};
  current_ = std::move(next_);
  return {};
}

}  // namespace forcelayer::voxrun
