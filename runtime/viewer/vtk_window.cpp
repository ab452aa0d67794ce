#include "runtime/viewer/vtk_window.h"

#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <string>

#include "runtime/viewer/legend.h"
#include "runtime/viewer/live.h"
#include "runtime/viewer/playback.h"
#include "runtime/viewer/style.h"
#include "runtime/viewer/vtk_overlay.h"
#include "runtime/viewer/vtk_stage.h"
#include "runtime/viewer/vtk_strip.h"

namespace forcelayer {
namespace {

constexpr int kTimerMs = 16;
constexpr double kLiveSpanS = 5;  // of the strip while following a run

// Left turns, middle or shift-left moves, wheel or right zooms; keys go to the window alone.
class CadStyle : public vtkInteractorStyleTrackballCamera {
 public:
  static CadStyle* New();
  vtkTypeMacro(CadStyle, vtkInteractorStyleTrackballCamera)

      std::function<void(const std::string&)> on_key;
  std::function<bool(int, int)> on_press;  // whether the press was used up

  void OnChar() override {}
  void OnKeyPress() override { on_key(Interactor->GetKeySym()); }
  void OnLeftButtonDown() override {
    const int* at = Interactor->GetEventPosition();
    if (!on_press(at[0], at[1])) Superclass::OnLeftButtonDown();
  }
};
vtkStandardNewMacro(CadStyle);

class Window {
 public:
  Window(const ViewScene& scene, const ViewOptions& options, const PicturePlan& plan, RunFeed feed)
      : scene_(scene), options_(options), plan_(plan), shown_(plan.shown), feed_(std::move(feed)) {
    for (const TraceRow& row : feed_.rows) strip_points_.push_back(strip_point(row));
    if (!feed_.rows.empty()) {
      playback_.emplace(feed_.rows);
      if (plan.moment && plan.moment->time_s) playback_->seek(*plan.moment->time_s);
      grip_ = options.handle_from_part.value_or(grip_of(feed_.rows.front()));
    }
    cut_ = plan.cut;
    moment_ = plan.moment;
  }

  Status run() {
    if (scene_.voxmap && scene_.shell) {
      auto probe = make_probe(options_, scene_);
      if (!probe) return probe.error();
      probe_.emplace(std::move(*probe));
    }
    build();
    interactor_->Initialize();
    interactor_->CreateRepeatingTimer(kTimerMs);
    started_ = last_ = Clock::now();
    interactor_->Start();
    return {};
  }

 private:
  using Clock = std::chrono::steady_clock;

  static StripPoint strip_point(const TraceRow& row) {
    return {row.time_s, glm::length(row.on_hand.force_n)};
  }

  void build() {
    window_->SetNumberOfLayers(3);
    window_->SetMultiSamples(0);
    window_->SetAlphaBitPlanes(1);
    window_->SetSize(plan_.width, plan_.height);
    window_->SetWindowName("voxview");
    world_->SetBackground(kPaper[0], kPaper[1], kPaper[2]);
    world_->SetUseDepthPeeling(1);
    world_->SetMaximumNumberOfPeels(2);
    marks_->SetLayer(1);
    words_->SetLayer(2);
    words_->InteractiveOff();
    marks_->InteractiveOff();
    for (vtkRenderer* renderer : {world_.Get(), marks_.Get(), words_.Get()}) {
      window_->AddRenderer(renderer);
    }
    interactor_->SetRenderWindow(window_);
    style_->on_key = [this](const std::string& key) { press(key); };
    style_->on_press = [this](int x, int y) { return scrub(x, y); };
    style_->SetDefaultRenderer(world_);
    interactor_->SetInteractorStyle(style_);
    vtkNew<vtkCallbackCommand> tick;
    tick->SetClientData(this);
    tick->SetCallback(
        [](vtkObject*, unsigned long, void* self, void*) { static_cast<Window*>(self)->tick(); });
    interactor_->AddObserver(vtkCommand::TimerEvent, tick);
    stage_.emplace(scene_, plan_.change, world_, marks_);
    overlay_.emplace(words_, 1.0);
    strip_.emplace(words_);
    stage_->aim(plan_.camera);
    stage_->cut(cut_);
    refresh();
  }

  // What has happened since the last frame: time that passed, poses that came.
  void tick() {
    const auto now = Clock::now();
    const double passed_s = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    if (options_.duration_s &&
        std::chrono::duration<double>(now - started_).count() > *options_.duration_s) {
      interactor_->TerminateApp();
      return;
    }
    bool changed = false;
    if (playback_ && playback_->playing()) {
      playback_->advance(passed_s);
      changed = true;
    }
    if (feed_.receiver) {
      if (const auto datagram = feed_.receiver->newest()) {
        follow(row_of(*datagram));
        changed = true;
      }
    }
    if (changed) refresh();
  }

  void follow(const TraceRow& row) {
    if (strip_points_.empty() || row.time_s < strip_points_.back().time_s) {
      strip_points_.clear();
      grip_ = options_.handle_from_part.value_or(grip_of(row));
    }
    strip_points_.push_back(strip_point(row));
    while (row.time_s - strip_points_.front().time_s > kLiveSpanS) {
      strip_points_.erase(strip_points_.begin());
    }
    set_row(row);
  }

  void set_row(const TraceRow& row) {
    moment_ = moment_of(row, grip_);
    if (probe_) moment_->contacts = probe_->at(moment_->world_from_part);
  }

  void refresh() {
    if (playback_) set_row(playback_->row());
    if (moment_) place_moment(*stage_, scene_, *moment_);
    ShownSet shown = shown_;
    if (!moment_ && !scene_.bounds.empty) shown = without_moment(shown);
    stage_->show(shown);
    const int* size = window_->GetSize();
    std::vector<std::string> title = {plan_.title.front()};
    if (plan_.change) title = plan_.title;
    if (moment_) {
      for (const std::string& line : describe(*moment_)) title.push_back(line);
    } else if (feed_.receiver) {
      title.push_back("waiting for the pose stream");
    }
    title.push_back("h: keys");
    if (help_) {
      title.back() = "1-8: meshes, interior, force layer, proximity, part, shell, contacts, hand";
      title.push_back("f: whole scene   p: part   x y z: along an axis   c: cut, moved by , and .");
      title.push_back("space: play   left right: step, with shift ten   click in the strip: seek");
      title.push_back("n: next contact   g: next guard cut, with shift the last   q: end");
    }
    PicturePlan now;
    now.shown = shown;
    now.moment = moment_;
    overlay_->set_title(title);
    overlay_->set_legend(legend_of(now, scene_));
    overlay_->lay_out(size[0], size[1], 2 * world_->GetActiveCamera()->GetParallelScale() / size[1],
                      strip_points_.empty() ? 0 : Strip::kTopPixel);
    draw_strip(size[0], size[1]);
    world_->ResetCameraClippingRange();
    window_->Render();
  }

  void draw_strip(int width, int height) {
    if (strip_points_.empty()) return;
    const double end_s = strip_points_.back().time_s;
    const double begin_s = feed_.receiver ? end_s - kLiveSpanS : strip_points_.front().time_s;
    strip_->draw(strip_points_, begin_s, end_s, moment_ ? moment_->time_s.value_or(end_s) : end_s,
                 moment_ ? moment_->kind() : FrameKind::kFree, width, height);
  }

  bool scrub(int x, int y) {
    if (!playback_) return false;
    const double time_s = strip_->time_at(x, y);
    if (time_s < 0) return false;
    playback_->seek(time_s);
    refresh();
    return true;
  }

  void press(const std::string& key) {
    if (key == "q" || key == "Escape") {
      interactor_->TerminateApp();
      return;
    }
    if (key == "h") {
      help_ = !help_;
    } else if (key.size() == 1 && key[0] >= '1' && key[0] <= '8') {
      shown_.toggle(static_cast<Shown>(key[0] - '1'));
    } else if (!press_camera(key) && !press_cut(key)) {
      press_playback(key);
    }
    refresh();
  }

  bool press_camera(const std::string& key) {
    const int* size = window_->GetSize();
    const double aspect = static_cast<double>(size[0]) / size[1];
    const glm::dvec3 axis(key == "x", key == "y", key == "z");
    if (key == "f" || glm::length(axis) > 0) {
      stage_->aim(frame_box(scene_.bounds, key == "f" ? default_direction() : axis, aspect));
    } else if (key == "p" && moment_) {
      CameraView view = plan_.camera;
      view.target_m = moment_->world_from_part.position_m;
      if (scene_.shell) view.half_height_m = 2.2 * scene_.shell->header().bounding_radius_m;
      stage_->aim(view);
    } else {
      return false;
    }
    return true;
  }

  // c: a cut through the middle, across x, y, z in turn, then none; comma and period move it.
  bool press_cut(const std::string& key) {
    const double step_m = scene_.voxmap ? scene_.voxmap->voxel_size_m() : 0.001;
    if (key == "c") {
      const int axis = cut_ ? cut_->axis + 1 : 0;
      cut_.reset();
      if (axis < 3) cut_ = Cut{axis, scene_.bounds.middle_m()[axis], true};
    } else if ((key == "comma" || key == "period") && cut_) {
      cut_->at_m += key == "comma" ? -step_m : step_m;
    } else {
      return false;
    }
    stage_->cut(cut_);
    return true;
  }

  void press_playback(const std::string& key) {
    if (!playback_) return;
    const bool back = interactor_->GetShiftKey() != 0;
    if (key == "space") playback_->toggle();
    if (key == "Right") playback_->step(back ? 10 : 1);
    if (key == "Left") playback_->step(back ? -10 : -1);
    if (key == "n" || key == "N") playback_->jump_to_contact(!back);
    if (key == "g" || key == "G") playback_->jump_to_guard_cut(!back);
  }

  const ViewScene& scene_;
  const ViewOptions& options_;
  const PicturePlan& plan_;
  ShownSet shown_;
  RunFeed feed_;
  std::optional<Playback> playback_;
  std::optional<ContactProbe> probe_;
  std::optional<Moment> moment_;
  std::optional<Cut> cut_;
  Pose grip_;
  std::vector<StripPoint> strip_points_;
  bool help_ = false;
  Clock::time_point started_, last_;
  vtkNew<vtkRenderer> world_, marks_, words_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> interactor_;
  vtkNew<CadStyle> style_;
  std::optional<Stage> stage_;
  std::optional<Overlay> overlay_;
  std::optional<Strip> strip_;
};

}  // namespace

Status show_window(const ViewScene& scene, const ViewOptions& options, const PicturePlan& plan,
                   RunFeed feed) {
  return Window(scene, options, plan, std::move(feed)).run();
}

}  // namespace forcelayer
