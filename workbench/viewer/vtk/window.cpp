#include "workbench/viewer/vtk/window.h"

#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOpenGLRenderer.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/command/command.h"
#include "workbench/viewer/plan/keys.h"
#include "workbench/viewer/plan/legend.h"
#include "workbench/viewer/plan/measurement.h"
#include "workbench/viewer/plan/mesh_pick.h"
#include "workbench/viewer/plan/object_tree.h"
#include "workbench/viewer/plan/style.h"
#include "workbench/viewer/run/playback.h"
#include "workbench/viewer/run/run_rows.h"
#include "workbench/viewer/surface/pick.h"
#include "workbench/viewer/vtk/cad_style.h"
#include "workbench/viewer/vtk/overlay.h"
#include "workbench/viewer/vtk/stage.h"
#include "workbench/viewer/vtk/strip.h"
#include "workbench/viewer/vtk/triad.h"

namespace forcelayer::viewer {
namespace {

constexpr unsigned long kTimerMs = 16;
constexpr double kLiveSpanS = 5;  // of the strip while following a run
// Slower frames are drawn in coarser voxels while the camera moves and for kRestS after.
constexpr double kSmoothS = 0.03;
constexpr double kRestS = 0.2;
constexpr double kSilenceS = 1;  // after which a stream has ended

// A renderer that blends translucent faces as they come. Without depth peeling, VTK sums them in
// floating-point buffers of the whole window and blends those in a second pass. Without a graphics
// card that takes most of a frame, for layers of one color each whose order does not show.
class BlendingRenderer : public vtkOpenGLRenderer {
 public:
  static BlendingRenderer* New();
  vtkTypeMacro(BlendingRenderer, vtkOpenGLRenderer)

      void DeviceRenderTranslucentPolygonalGeometry(vtkFrameBufferObjectBase*) override {
    UpdateTranslucentPolygonalGeometry();
  }
};
vtkStandardNewMacro(BlendingRenderer);

class Window {
 public:
  Window(const ViewScene& scene, const ViewOptions& options, const PicturePlan& plan, RunFeed feed)
      : scene_(scene),
        options_(options),
        plan_(plan),
        shown_(plan.shown),
        feed_(std::move(feed)),
        objects_(object_names(scene)) {
    objects_.hide(plan.hidden);
    for (const TraceRow& row : feed_.rows) strip_points_.push_back(strip_point(row));
    if (!feed_.rows.empty()) {
      playback_.emplace(feed_.rows);
      notable_ = notable_rows(feed_.rows);
      if (plan.moment && plan.moment->time_s) playback_->seek(*plan.moment->time_s);
      grip_ = grip_of(feed_.rows.front());
    }
    cut_ = plan.cut;
    moment_ = plan.moment;
    // A view of the part stays with the part.
    if (moment_ && scene.shell && options.focus != Focus::kScene) followed_m_ = part_center_m();
  }

  Status run() {
    if (scene_.voxmap && scene_.shell) {
      auto source = make_contact_source(options_, scene_, feed_.rows);
      if (!source) return source.error();
      contact_source_ = std::move(*source);
    }
    build();
    if (!options_.frame_times.empty()) return measure_turning();
    interactor_->Initialize();
    interactor_->CreateRepeatingTimer(kTimerMs);
    started_ = last_ = Clock::now();
    interactor_->Start();
    return {};
  }

 private:
  using Clock = std::chrono::steady_clock;

  static double seconds_since(Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  }

  static StripPoint strip_point(const TraceRow& row) {
    return {row.time_s, glm::length(row.on_hand.value_or(Wrench()).force_n), kind_of(row)};
  }

  void build() {
    window_->SetNumberOfLayers(3);
    window_->SetMultiSamples(0);
    window_->SetAlphaBitPlanes(1);
    window_->SetSize(plan_.width, plan_.height);
    window_->SetWindowName(("voxview: " + plan_.title.front()).c_str());
    // No depth peeling, which takes ten times as long: all that is translucent at one place has one
    // color as a rule, and then the order of blending does not show.
    world_->SetBackground(kBackground[0], kBackground[1], kBackground[2]);
    marks_->SetLayer(1);
    words_->SetLayer(2);
    words_->InteractiveOff();
    marks_->InteractiveOff();
    window_->AddRenderer(world_);
    window_->AddRenderer(marks_);
    window_->AddRenderer(words_);
    interactor_->SetRenderWindow(window_);
    interactor_->EnableRenderOff();  // events mark what has changed, tick() draws it once
    style_->on_key = [this](const std::string& key) { press(key); };
    style_->on_press = [this](int x, int y) {
      return press_tree(x, y) || press_button(x, y) || scrub(x, y);
    };
    style_->on_drag = [this](int x, int y) {
      if (!strip_->button_at(x, y)) scrub(x, y);
    };
    style_->on_hover = [this](int x, int y) { hover(x, y); };
    style_->SetDefaultRenderer(world_);
    interactor_->SetInteractorStyle(style_);
    observe(interactor_, vtkCommand::TimerEvent, [](Window& window) { window.tick(); });
    observe(interactor_, vtkCommand::RenderEvent, [](Window& window) { window.changed_ = true; });
    observe(world_, vtkCommand::StartEvent, [](Window& window) { window.lay_out(); });
    stage_.emplace(scene_, plan_, world_, marks_);
    triad_.emplace(window_, 1);
    overlay_.emplace(words_, plan_.scale);
    strip_.emplace(words_, plan_.scale);
    stage_->build_quick_layers();
    stage_->hide(plan_.hidden);
    stage_->aim(plan_.camera);
    stage_->cut(cut_);
    refresh();
  }

  void observe(vtkObject* what, unsigned long event, void (*call)(Window&)) {
    calls_.push_back({this, call});
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(&calls_.back());
    command->PassiveObserverOn();  // else no event arrives while the style holds a mouse button
    command->SetCallback([](vtkObject*, unsigned long, void* data, void*) {
      const auto& [window, function] = *static_cast<Call*>(data);
      function(*window);
    });
    what->AddObserver(event, command);
  }

  // Takes in the events since the last frame: passed time, poses, keys, the mouse.
  void tick() {
    const auto now = Clock::now();
    const double passed_s = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    if (options_.duration_s && seconds_since(started_) > *options_.duration_s) {
      interactor_->TerminateApp();
      return;
    }
    if (playback_ && playback_->playing()) {
      playback_->advance(speed_ * passed_s);
      changed_ = true;
    }
    if (feed_.receiver) listen();
    if (quick_ && seconds_since(moved_) > kRestS) changed_ = true;
    if (changed_) refresh();
  }

  void listen() {
    std::optional<TraceRow> newest;
    while (const auto datagram = feed_.receiver->next()) {
      newest = row_of(*datagram);
      add_to_strip(*newest);
    }
    if (newest) {
      set_row(*newest);
      heard_ = last_;
      silent_ = false;
      changed_ = true;
    } else if (moment_ && !silent_ && seconds_since(heard_) > kSilenceS) {
      silent_ = changed_ = true;
    }
  }

  void add_to_strip(const TraceRow& row) {
    if (!strip_points_.empty() && row.time_s < strip_points_.back().time_s) strip_points_.clear();
    strip_points_.push_back(strip_point(row));
    const auto first = std::find_if(
        strip_points_.begin(), strip_points_.end(),
        [&](const StripPoint& point) { return row.time_s - point.time_s <= kLiveSpanS; });
    strip_points_.erase(strip_points_.begin(), first);
  }

  void set_row(const TraceRow& row) {
    moment_ = moment_of(row, grip_);
    if (contact_source_) find_contacts(*contact_source_, *moment_);
  }

  std::vector<std::string> title() const {
    std::vector<std::string> lines = {plan_.title.front()};
    if (plan_.change) lines = plan_.title;
    if (moment_) {
      for (const std::string& line : describe(*moment_)) lines.push_back(line);
    }
    if (feed_.receiver && !moment_) {
      lines.push_back("waiting for a run: voxrun ... --udp " + options_.listen);
    }
    if (silent_)
      lines.push_back("no pose received for a second: the run has ended or has stopped responding");
    if (playback_) {
      lines.push_back(text_of("%s, %g x    frame %zu of %zu",
                              playback_->playing() ? "playing" : "paused", speed_,
                              playback_->index() + 1, feed_.rows.size()));
    }
    if (!measurement_.empty()) lines.push_back(measurement_.words(world_from_part()));
    if (cut_) {
      lines.push_back(text_of("cut at %c = %.1f mm, %s is kept", "xyz"[cut_->axis],
                              1e3 * cut_ -> at_m,
                              cut_ -> keep_low ? "the side below" : "the side above"));
    }
    // With the tree below it the line stays, so that the tree does not jump.
    if (!pointed_at_.empty() || tree_open_) lines.push_back("here: " + escaped(pointed_at_));
    if (help_) {
      lines.insert(lines.end(), kKeyLines.begin(), kKeyLines.end());
    } else {
      lines.push_back("h: keys");
    }
    return lines;
  }

  void refresh() {
    changed_ = false;
    if (playback_) {
      set_row(playback_->row());
      moment_->name = notable_.name_of(playback_->index());
    }
    if (moment_) {
      place_moment(*stage_, scene_, *moment_);
      if (followed_m_) follow_part();
    }
    stage_->place_measurement(measurement_.places_m(world_from_part()));
    PicturePlan now;
    now.shown = shown_;
    if (!moment_ && !scene_.bounds.empty) now.shown = without_moment(shown_);
    now.moment = moment_;
    now.color_objects = plan_.color_objects;
    now.hidden = objects_.hidden();
    // The legend asks only whether there is a change, not which.
    if (plan_.change) now.change.emplace();
    stage_->show(now.shown);
    overlay_->set_title(title());
    overlay_->set_state(moment_ ? std::optional(moment_->kind()) : std::nullopt);
    overlay_->set_legend(legend_of(now, scene_));
    overlay_->set_tree(tree_lines());
    render();
  }

  // Quickly where the camera moves and a whole frame is not smooth.
  void render() {
    const auto begin = Clock::now();
    if (camera_moved()) moved_ = begin;
    quick_ = full_frame_s_ > smooth_s_ && seconds_since(moved_) < kRestS;
    stage_->draw_quickly(quick_);
    window_->Render();
    if (!quick_) full_frame_s_ = seconds_since(begin);
  }

  // Whether the camera has moved visibly since the last call.
  bool camera_moved() {
    vtkCamera* now = world_->GetActiveCamera();
    const auto numbers = [](const double* v) { return glm::dvec3(v[0], v[1], v[2]); };
    const std::array<glm::dvec3, 3> place = {numbers(now->GetPosition()),
                                             numbers(now->GetFocalPoint()),
                                             numbers(now->GetViewUp()) * now->GetParallelScale()};
    const double pixel_m = 2 * now->GetParallelScale() / window_->GetSize()[1];
    bool moved = false;
    for (std::size_t n = 0; n < place.size(); ++n) {
      moved = moved || glm::length(place[n] - camera_place_[n]) > 0.25 * pixel_m;
    }
    if (moved) camera_place_ = place;
    return moved;
  }

  glm::dvec3 part_center_m() const {
    return world_from_center(moment_->world_from_part, *scene_.shell).position_m;
  }

  // Moves the camera as the part has moved.
  void follow_part() {
    const glm::dvec3 moved = part_center_m() - *followed_m_;
    followed_m_ = part_center_m();
    vtkCamera* camera = world_->GetActiveCamera();
    const double* eye = camera->GetPosition();
    camera->SetPosition(eye[0] + moved.x, eye[1] + moved.y, eye[2] + moved.z);
    const double* focus = camera->GetFocalPoint();
    camera->SetFocalPoint(focus[0] + moved.x, focus[1] + moved.y, focus[2] + moved.z);
  }

  // Just before every drawing: the window may have been resized, the camera turned.
  void lay_out() {
    const int width = window_->GetSize()[0], height = window_->GetSize()[1];
    vtkCamera* camera = world_->GetActiveCamera();
    const bool strip_shown = !strip_points_.empty() && strip_->fits(width, height);
    overlay_->lay_out(width, height, 2 * camera->GetParallelScale() / height,
                      strip_shown ? strip_->top_pixel() : 0);
    triad_->aim(to_eye(), up(), width, height,
                static_cast<int>(std::lround(kTriadPixels * plan_.scale)));
    if (playback_) strip_->set_play(PlayState{playback_->playing(), speed_});
    strip_->show(strip_shown);
    if (!strip_shown) return;
    const double newest_s = strip_points_.back().time_s;
    const double begin_s =
        feed_.receiver ? std::max(0.0, newest_s - kLiveSpanS) : strip_points_.front().time_s;
    const double end_s = feed_.receiver ? begin_s + kLiveSpanS : newest_s;
    strip_->draw(strip_points_, begin_s, end_s,
                 moment_ ? moment_->time_s.value_or(newest_s) : newest_s, width);
  }

  glm::dvec3 to_eye() const {
    const double* along = world_->GetActiveCamera()->GetDirectionOfProjection();
    return {-along[0], -along[1], -along[2]};
  }

  glm::dvec3 up() const {
    const double* sky = world_->GetActiveCamera()->GetViewUp();
    return {sky[0], sky[1], sky[2]};
  }

  std::vector<TreeLine> tree_lines() const {
    std::vector<TreeLine> lines;
    if (!tree_open_) return lines;
    for (const ObjectTree::Row& row : objects_.rows()) {
      TreeLine& line = lines.emplace_back();
      const std::string label = escaped(row.label);
      line.words = !row.is_group ? label
                   : row.is_open ? label
                                 : text_of("%s  (%zu objects)", label.c_str(), row.objects);
      line.depth = row.depth;
      line.color = !row.is_group && plan_.color_objects && row.object < scene_.meshes.size()
                       ? color_of_mesh(row.object)
                       : kSceneColor;
      line.filled = row.shown == ObjectTree::Shown::kAll    ? 1
                    : row.shown == ObjectTree::Shown::kSome ? 0.5
                                                            : 0;
      line.selected = row.node == objects_.selected();
    }
    return lines;
  }

  Pose world_from_part() const { return moment_ ? moment_->world_from_part : Pose(); }

  // From the eye through a pixel, from the eye's side of all that is drawn.
  Ray ray_at(int x, int y) const {
    world_->SetDisplayPoint(x, y, 0);
    world_->DisplayToWorld();
    const double* near = world_->GetWorldPoint();
    const double back_m = glm::length(scene_.bounds.high_m - scene_.bounds.low_m);
    return {scene_.origin_m + glm::dvec3(near[0], near[1], near[2]) + back_m * to_eye(), -to_eye()};
  }

  // The place of the scene that is drawn at a pixel: on the mesh, else on the voxels there, by the
  // name of the object that they are nearest to.
  std::optional<PickedPlace> scene_at(const Ray& ray) const {
    if (shown_[Item::kMeshes]) {
      if (const auto hit = mesh_on(scene_, stage_->hidden_meshes(), ray, cut_)) {
        return PickedPlace{std::string(hit->name), ray.from_m + hit->along * ray.along};
      }
    }
    if (!scene_.voxmap || !(shown_[Item::kInterior] || shown_[Item::kForceLayer])) return {};
    const auto voxel = interior_on(*scene_.voxmap, ray, cut_, stage_->hidden_objects());
    if (!voxel) return {};
    const double along = entry_of(*scene_.voxmap, ray, *voxel);
    return PickedPlace{std::string(object_of(*scene_.voxmap, *voxel)),
                       ray.from_m + along * ray.along};
  }

  // The nearest of the scene and the part at a pixel.
  std::optional<PickedPlace> place_at(int x, int y) const {
    const Ray ray = ray_at(x, y);
    std::optional<PickedPlace> place = scene_at(ray);
    const bool mesh = shown_[Item::kPart] && scene_.part;
    if (!moment_ || !(mesh || shown_[Item::kShell])) return place;
    const auto along = part_on(scene_, mesh, moment_->world_from_part, ray);
    if (!along) return place;
    const glm::dvec3 on_part_m = ray.from_m + *along * ray.along;
    if (place && glm::distance(place->place_m, ray.from_m) < glm::distance(on_part_m, ray.from_m)) {
      return place;
    }
    const Pose part_from_world = inverse(moment_->world_from_part);
    return PickedPlace{"the part",
                       part_from_world.orientation * on_part_m + part_from_world.position_m, true};
  }

  // m: measures from what is under the pointer, at the next m to it; with shift no more.
  bool press_measure(const std::string& key) {
    if (key != "m" && key != "M") return false;
    if (key == "M") measurement_.clear();
    const auto place =
        key == "m" && pointer_ ? place_at((*pointer_)[0], (*pointer_)[1]) : std::nullopt;
    if (place) measurement_.pick(*place);
    return true;
  }

  void hover(int x, int y) {
    pointer_ = {x, y};
    const auto place = objects_.empty() ? std::nullopt : scene_at(ray_at(x, y));
    const std::string name = place ? place->name : "";
    if (name == pointed_at_) return;
    pointed_at_ = name;
    changed_ = true;
  }

  // A click on a line of the tree hides or shows it, with shift it is shown alone.
  bool press_tree(int x, int y) {
    const auto line = tree_open_ ? overlay_->tree_line_at(x, y) : std::nullopt;
    if (!line) return false;
    objects_.select(objects_.rows()[*line].node);
    shift() ? objects_.isolate() : objects_.toggle();
    show_objects();
    return true;
  }

  void show_objects() {
    stage_->hide(objects_.hidden());
    changed_ = true;
  }

  bool press_objects(const std::string& key) {
    if (objects_.empty()) return false;
    if (key == "o") {
      tree_open_ = !tree_open_;
    } else if (tree_open_ && (key == "Up" || key == "Down")) {
      objects_.step(key == "Up" ? -1 : 1);
    } else if (tree_open_ && key == "Return") {
      objects_.fold();
    } else if (key == "v" || key == "i") {
      if (!tree_open_ && pointed_at_.empty()) return true;
      if (!tree_open_) objects_.select_object(pointed_at_);
      key == "v" ? objects_.toggle() : objects_.isolate();
      show_objects();
    } else if (key == "a") {
      objects_.show_all();
      show_objects();
    } else {
      return false;
    }
    return true;
  }

  bool press_button(int x, int y) {
    const auto button = playback_ ? strip_->button_at(x, y) : std::nullopt;
    if (!button) return false;
    press_playback(*button == PlayButton::kPlay     ? "space"
                   : *button == PlayButton::kSlower ? "minus"
                                                    : "plus");
    changed_ = true;
    return true;
  }

  bool scrub(int x, int y) {
    if (!playback_) return false;
    const auto time_s = strip_->time_at(x, y);
    if (!time_s) return false;
    playback_->seek(*time_s);
    changed_ = true;
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
      shown_.toggle(static_cast<Item>(key[0] - '1'));
    } else if (!press_camera(key) && !press_cut(key) && !press_objects(key) &&
               !press_measure(key)) {
      press_playback(key);
    }
    if (pointer_) hover((*pointer_)[0], (*pointer_)[1]);
    changed_ = true;
  }

  bool shift() const { return interactor_->GetShiftKey() != 0; }

  bool press_camera(const std::string& key) {
    const int* size = window_->GetSize();
    const double aspect = static_cast<double>(size[0]) / size[1];
    const glm::dvec3 axis(key == "x" || key == "X", key == "y" || key == "Y",
                          key == "z" || key == "Z");
    const bool followed = followed_m_.has_value();
    if (key == "p" || key == "f" || glm::length(axis) > 0) followed_m_.reset();
    if (key == "p" && followed) return true;
    if (key == "f") {
      stage_->aim(frame_box(box_of(scene_), default_direction(), aspect));
    } else if (glm::length(axis) > 0) {
      stage_->aim(frame_box(box_of(scene_), shift() ? -axis : axis, aspect));
    } else if (key == "p" && moment_ && scene_.shell) {
      CameraView view = camera_along(to_eye());
      view.up = up();
      view.target_m = part_center_m();
      followed_m_ = view.target_m;
      view.half_height_m = kPartFocus * scene_.shell->header().bounding_radius_m;
      stage_->aim(view);
    } else {
      return false;
    }
    return true;
  }

  // c: a cut through the part that is followed, or the middle, across x, y, z in turn, then none;
  // comma and period move it.
  bool press_cut(const std::string& key) {
    const double voxel_m = scene_.voxmap ? scene_.voxmap->voxel_size_m() : 0.001;
    if (key == "c") {
      const int axis = cut_ ? cut_->axis + 1 : 0;
      cut_.reset();
      const glm::dvec3 middle_m = followed_m_.value_or(box_of(scene_).middle_m());
      // The side towards the eye goes: else it would hide the cut.
      if (axis < 3) cut_ = Cut{axis, middle_m[axis], to_eye()[axis] >= 0};
    } else if (key == "C" && cut_) {
      cut_->keep_low = !cut_->keep_low;
    } else if (key == "comma" && cut_) {
      cut_->at_m -= voxel_m;
    } else if (key == "period" && cut_) {
      cut_->at_m += voxel_m;
    } else if (key == "less" && cut_) {
      cut_->at_m -= 10 * voxel_m;
    } else if (key == "greater" && cut_) {
      cut_->at_m += 10 * voxel_m;
    } else {
      return false;
    }
    stage_->cut(cut_);
    return true;
  }

  void press_playback(const std::string& key) {
    if (!playback_) return;
    const auto last = static_cast<std::ptrdiff_t>(feed_.rows.size());
    if (key == "space") playback_->toggle();
    if (key == "Right") playback_->step(shift() ? 10 : 1);
    if (key == "Left") playback_->step(shift() ? -10 : -1);
    if (key == "Home") playback_->step(-last);
    if (key == "End") playback_->step(last);
    if (key == "minus") speed_ = std::max(speed_ / 2, 1.0 / 64);
    if (key == "plus" || key == "equal") speed_ = std::min(2 * speed_, 16.0);
    if (key == "n" || key == "N") playback_->jump_to_contact(key == "n");
    if (key == "g" || key == "G") playback_->jump_to_guard_cut(key == "g");
  }

  // Turns the scene once; percentiles of how long the frames took.
  nlohmann::ordered_json turn() {
    constexpr int kFrames = 72;
    std::vector<double> frame_ms;
    int quick = 0;
    for (int n = 0; n < kFrames; ++n) {
      const auto begin = Clock::now();
      world_->GetActiveCamera()->Azimuth(360.0 / kFrames);
      refresh();
      if (n < 2) continue;  // they fill buffers
      frame_ms.push_back(1e3 * seconds_since(begin));
      quick += quick_;
    }
    std::sort(frame_ms.begin(), frame_ms.end());
    const auto at = [&](double fraction) {
      return frame_ms[static_cast<std::size_t>(fraction *
                                               static_cast<double>(frame_ms.size() - 1))];
    };
    return {{"frames", frame_ms.size()},
            {"in_coarser_voxels", quick},
            {"p50", at(0.5)},
            {"p90", at(0.9)},
            {"p99", at(0.99)},
            {"max", at(1)}};
  }

  // Measures the time of frames while the camera turns: as a user sees them, and whole ones.
  Status measure_turning() {
    nlohmann::ordered_json report = report_of(plan_, scene_);
    if (scene_.voxmap) report["force_layer_voxels"] = scene_.voxmap->header().surface_voxels;
    report["rectangles"] = stage_->voxel_rectangles();
    refresh();  // so that it is known whether whole frames are slow
    report["frame_ms"] = turn();
    smooth_s_ = std::numeric_limits<double>::infinity();
    report["whole_frame_ms"] = turn();
    return command::write_report(options_.frame_times, report);
  }

  struct Call {
    Window* window;
    void (*function)(Window&);
  };

  const ViewScene& scene_;
  const ViewOptions& options_;
  const PicturePlan& plan_;
  ItemSet shown_;
  RunFeed feed_;
  std::optional<Playback> playback_;
  NotableRows notable_;
  std::unique_ptr<ContactViewSource> contact_source_;
  std::optional<Moment> moment_;
  std::optional<Cut> cut_;
  Measurement measurement_;
  std::optional<glm::dvec3> followed_m_;  // where the part was when the camera went with it
  Pose grip_;
  double speed_ = 1;  // of playing, in run time per time
  std::vector<StripPoint> strip_points_;
  ObjectTree objects_;
  bool tree_open_ = false;
  std::optional<std::array<int, 2>> pointer_;  // where it was last seen, pixels
  std::string pointed_at_;                     // the name of the object under it
  bool help_ = false;
  bool changed_ = false;        // the picture is out of date
  bool quick_ = false;          // the last frame was drawn in coarser voxels
  double smooth_s_ = kSmoothS;  // longest whole frame while the camera moves
  double full_frame_s_ = 0;     // how long the last whole frame took
  Clock::time_point moved_;     // when the camera moved last
  std::array<glm::dvec3, 3> camera_place_{};
  bool silent_ = false;               // a stream that was heard is heard no more
  Clock::time_point started_, last_;  // of the window, of the last tick
  Clock::time_point heard_;           // when a pose came last
  std::deque<Call> calls_;
  vtkNew<BlendingRenderer> world_;
  vtkNew<vtkRenderer> marks_, words_;
  vtkNew<vtkRenderWindow> window_;
  vtkNew<vtkRenderWindowInteractor> interactor_;
  vtkNew<CadStyle> style_;
  std::optional<Stage> stage_;
  std::optional<Triad> triad_;
  std::optional<Overlay> overlay_;
  std::optional<Strip> strip_;
};

}  // namespace

Status show_window(const ViewScene& scene, const ViewOptions& options, const PicturePlan& plan,
                   RunFeed feed) {
  return Window(scene, options, plan, std::move(feed)).run();
}

}  // namespace forcelayer::viewer
