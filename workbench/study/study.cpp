#include "workbench/study/study.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "formats/command/command.h"
#include "formats/command/quantity.h"
#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/command/verdict/hosts.h"
#include "formats/command/verdict/verdict.h"
#include "formats/file/descriptor.h"
#include "formats/file/file_bytes.h"
#include "workbench/study/curve.h"
#include "workbench/study/page.h"
#include "workbench/study/steps.h"

namespace forcelayer::study {
namespace {

using nlohmann::json;

constexpr int kAnswerIsNo = exit_status(ErrorCode::kAnswerIsNo);

json read_json(const std::string& path) {
  std::ifstream file(path);
  return json::parse(file, nullptr, false);
}

// One study, step by step.
class Study {
 public:
  Study(const Options& options, Steps steps) : options_(options), steps_(std::move(steps)) {}

  Status make();

 private:
  std::string in(const char* name) const {
    return (std::filesystem::path(options_.folder) / name).string();
  }
  std::string part_mesh() const { return options_.assembly + "#" + options_.node; }

  std::vector<std::string> left_out() const;
  void add_reading(Step& step) const;
  void add_meshes(Step& step) const;
  void add_bake_reading(Step& step) const;
  Step scene_step() const;
  Step part_step() const;
  Step pull_step() const;
  Step plan_step() const;
  Step check_step() const;
  Step picture_step() const;

  Status bake();
  Status find_path();
  Status pull();
  Status write_straight_path();
  Status check();
  Status say_that_no_path_was_found();
  Status draw();
  Status write_page();
  Status report() const;
  Status judge() const;

  // A step that must not fail; `or_no`: the answer no is not a failure.
  Result<StepEnd> run(const Step& step, bool or_no = false);

  const Options& options_;
  Steps steps_;
  std::string path_;  // that is checked; empty where the search found none
  json checked_;      // report of voxcheck; null where there is no path
  command::Verdict verdict_;
  std::string held_;      // how far the pulled part went; empty: to the end, or its path was given
  std::string sentence_;  // the first one
  std::string text_;      // that and the lines that follow it
};

// The objects that a path is not clear of, by name. Those that are entered deepest come first, to
// the micrometer: depths that differ by rounding alone keep the order of the report.
std::vector<std::string> blockers(const json& verdict) {
  if (!verdict.is_object()) return {};
  std::vector<std::pair<long long, std::string>> found;
  for (const json& violation : verdict.value("violations", json::array())) {
    const json& object = violation["object"];
    if (!object.is_string()) continue;
    const long long depth_um = std::llround(1e6 * violation.value("depth_m", 0.0));
    const auto same = std::find_if(found.begin(), found.end(),
                                   [&](const auto& other) { return other.second == object; });
    if (same == found.end()) {
      found.emplace_back(depth_um, object.get<std::string>());
    } else {
      same->first = std::max(same->first, depth_um);
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> names;
  for (auto& [depth_um, name] : found) names.push_back(std::move(name));
  return names;
}

Result<StepEnd> Study::run(const Step& step, bool or_no) {
  const auto end = steps_.run(step);
  if (!end || end->status == 0 || (or_no && end->status == kAnswerIsNo)) return end;
  ErrorCode code = ErrorCode::kInternal;
  for (const ErrorCode other :
       {ErrorCode::kUsage, ErrorCode::kMeshUnreadable, ErrorCode::kNotThisFormat,
        ErrorCode::kDeviceFailed, ErrorCode::kAnswerIsNo}) {
    if (end->status == exit_status(other)) code = other;
  }
  // The system's refusals and signals pass; a wrong command line or file stays wrong.
  const bool may_pass = end->status == exit_status(ErrorCode::kInternal) || end->status >= 128;
  return Error{
      code, "", step.program,
      "ended with status " + std::to_string(end->status) + ", so the study is not finished",
      std::string("see its line above") +
          (may_pass ? "; the same command goes on from there" : "")};
}

std::vector<std::string> Study::left_out() const {
  std::vector<std::string> arguments{"--without", options_.node};
  for (const std::string& node : options_.without) {
    arguments.insert(arguments.end(), {"--without", node});
  }
  return arguments;
}

void Study::add_reading(Step& step) const {
  if (options_.sandbox) step.arguments.push_back("--sandbox");
  if (options_.units.empty()) return;
  step.arguments.insert(step.arguments.end(), {"--units", options_.units});
}

// The meshes settle what the files leave open.
void Study::add_meshes(Step& step) const {
  const auto add = [&](const std::vector<std::string>& more) {
    step.arguments.insert(step.arguments.end(), more.begin(), more.end());
  };
  add({"--exact", options_.assembly, "--part", part_mesh()});
  add(left_out());
  if (!options_.seat.empty() && !options_.seat_depth.empty()) {
    add({"--seat-depth", options_.seat_depth});
  }
  add_reading(step);
}

// The reports of the baked files.
void Study::add_bake_reading(Step& step) const {
  add_reading(step);
  if (!options_.up.empty()) step.arguments.insert(step.arguments.end(), {"--up", options_.up});
  if (options_.missing_faces.empty()) return;
  step.arguments.insert(step.arguments.end(), {"--missing-faces", options_.missing_faces});
}

Step Study::scene_step() const {
  Step step{"voxelize",
            {options_.assembly},
            with_references(options_.assembly),
            {in("scene.vox"), in("scene.json")},
            "forcelayer-tools"};
  const auto out = left_out();
  step.arguments.insert(step.arguments.end(), out.begin(), out.end());
  step.arguments.insert(step.arguments.end(), {"--voxel-size", options_.voxel_size, "-o",
                                               in("scene.vox"), "--json", in("scene.json")});
  if (!options_.range.empty())
    step.arguments.insert(step.arguments.end(), {"--range", options_.range});
  add_bake_reading(step);
  return step;
}

Step Study::part_step() const {
  Step step{"pointshell",
            {part_mesh(), "--voxel-size", options_.voxel_size, "-o", in("part.pshell"), "--json",
             in("part.json")},
            with_references(options_.assembly),
            {in("part.pshell"), in("part.json")},
            "forcelayer-tools"};
  add_bake_reading(step);
  return step;
}

Step Study::pull_step() const {
  Step step{"voxrun",
            {in("scene.vox"), in("part.pshell"), "--pull", options_.pull, "--as-fast-as-possible",
             "--save-path", in("path.csv"), "--trace", in("trace.csv"), "--json", in("run.json")},
            {in("scene.vox"), in("part.pshell")},
            {in("path.csv"), in("trace.csv"), in("run.json")},
            "forcelayer-runtime"};
  if (!options_.seat.empty()) {
    step.arguments.insert(step.arguments.end(), {"--seat", options_.seat});
  }
  return step;
}

Step Study::plan_step() const {
  Step step{"voxplan",
            {in("scene.vox"), in("part.pshell"), "--clearance", options_.clearance, "--seat",
             options_.seat, "-o", in("path.csv"), "--json", in("plan.json")},
            {in("scene.vox"), in("part.pshell")},
            {in("path.csv"), in("plan.json")},
            "forcelayer-tools"};
  for (const std::string& object : options_.allow) {
    step.arguments.insert(step.arguments.end(), {"--allow", object});
  }
  if (!options_.files_alone) add_meshes(step);
  if (!options_.time.empty()) {
    step.arguments.insert(step.arguments.end(), {"--time", options_.time});
  }
  if (!options_.seed.empty()) {
    step.arguments.insert(step.arguments.end(), {"--seed", options_.seed});
  }
  return step;
}

Step Study::check_step() const {
  Step step{"voxcheck",
            {in("scene.vox"), in("part.pshell"), path_, "--clearance", options_.clearance},
            {in("scene.vox"), in("part.pshell"), path_},
            {in("verdict.json"), in("curve.csv"), in("verdict.xml")},
            "forcelayer-runtime"};
  const auto add = [&](const std::vector<std::string>& more) {
    step.arguments.insert(step.arguments.end(), more.begin(), more.end());
  };
  if (!options_.seat.empty()) add({"--seat", options_.seat});
  for (const std::string& object : options_.allow) add({"--allow", object});
  if (!options_.files_alone) add_meshes(step);
  add({"--json", in("verdict.json"), "--report", "csv:" + in("curve.csv"), "--report",
       "junit:" + in("verdict.xml")});
  if (!options_.no_pictures) {
    add({"--picture", in("worst.png")});
    step.outputs.push_back(in("worst.png"));
  }
  return step;
}

// Where the part is installed.
Step Study::picture_step() const {
  Step step{"voxview",
            {"draw", options_.assembly, "--part", part_mesh(), in("scene.vox"), in("part.pshell"),
             "--part-pose", "0,0,0m", "--title", "where the part is installed", "--show",
             "meshes,part", "--screenshot", in("installed.png"), "--size", "1200x800"},
            with_references(options_.assembly),
            {in("installed.png")},
            "forcelayer-viewer"};
  step.arguments.insert(step.arguments.end(), {"--hide", options_.node});
  for (const std::string& node : options_.without) {
    step.arguments.insert(step.arguments.end(), {"--hide", node});
  }
  if (!options_.units.empty()) {
    step.arguments.insert(step.arguments.end(), {"--units", options_.units});
  }
  return step;
}

Status Study::bake() {
  if (const auto scene = run(scene_step()); !scene) return scene.error();
  if (const auto part = run(part_step()); !part) return part.error();
  return {};
}

Status Study::find_path() {
  path_ = options_.path;
  if (!path_.empty()) return {};
  path_ = in("path.csv");
  if (!options_.searches()) return pull();
  const auto planned = run(plan_step(), true);
  if (!planned) return planned.error();
  if (planned->status != 0) path_.clear();
  return {};
}

// A part that is held off the end of its pull did not follow the straight path. Whether that path
// is free is asked of the meshes, and which objects block it: a simulated hand feels one of them.
Status Study::pull() {
  if (const auto pulled = run(pull_step(), true); !pulled) return pulled.error();
  const json run = read_json(in("run.json"));
  const json ended = run.is_object() ? run.value("pull", json()) : json();
  if (!ended.is_object() || !ended.value("held", false)) return {};
  held_ = command::text("pulled %.4g mm, it moved %.3g mm", 1e3 * ended.value("led_m", 0.0),
                        1e3 * ended.value("went_m", 0.0));
  path_ = in("straight.csv");
  return write_straight_path();
}

Status Study::write_straight_path() {
  const auto pull_m = command::parse_point(options_.pull);
  const auto seat = command::parse_pose(options_.seat.empty() ? "0,0,0m" : options_.seat);
  if (!pull_m || !seat) return pull_m ? seat.error() : pull_m.error();
  const auto& [position_m, orientation] = *seat;
  std::string rows = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
  for (const double fraction : {0.0, 1.0}) {
    rows += command::text("%.17g", fraction);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows += command::text(",%.17g", position_m[axis] + fraction * (*pull_m)[axis]);
    }
    for (const double q : orientation) rows += command::text(",%.17g", q);
    rows += "\n";
  }
  return command::write_text(path_, rows);
}

Status Study::check() {
  if (path_.empty()) return say_that_no_path_was_found();
  const auto checked = run(check_step(), true);
  if (!checked) return checked.error();
  checked_ = read_json(in("verdict.json"));
  verdict_.kind = command::verdict_kind(checked_.value("kind", ""));
  verdict_.required_m = checked_.value("required_clearance_m", 0.0);
  if (checked_["direction"].is_string()) verdict_.motion = checked_["direction"];
  sentence_ = checked_.value("sentence", "");
  text_ = checked->output;
  if (!held_.empty() && command::is_yes(verdict_.kind)) {
    text_ += "  a simulated hand did not follow this path: " + held_ + "\n";
  } else if (!held_.empty()) {
    verdict_.kind = command::VerdictKind::kDoesNotComeOut;
    verdict_.finding = held_;
    verdict_.blocked_by = blockers(checked_);
    sentence_ = command::sentence(verdict_);
    text_ = sentence_ + "\n  the straight path: " + text_;
  }
  return command::write_text(in("verdict.txt"), text_);
}

// In the words of voxplan: what it tried, and what was in the way. The files of an earlier verdict
// would say something else.
Status Study::say_that_no_path_was_found() {
  const json plan = read_json(in("plan.json"));
  const json found = plan.is_object() ? plan : json::object();
  verdict_.kind = command::VerdictKind::kNoPathFound;
  verdict_.required_m = found.value("required_clearance_m", 0.0);
  if (found.contains("finding") && found["finding"].is_string()) {
    verdict_.finding = found["finding"];
    verdict_.blocked_by = found["blocked_by"].get<std::vector<std::string>>();
  } else {  // refused before the search
    verdict_.finding = found.value("error", json::object()).value("what", "it was refused");
    const auto required_m = command::parse_length(options_.clearance);
    verdict_.required_m = required_m ? *required_m : 0;
  }
  sentence_ = command::sentence(verdict_);
  text_ = command::terminal_text(verdict_);
  for (const char* name : {"curve.csv", "curve.svg", "worst.png"}) std::remove(in(name).c_str());
  const std::string verdict = command::verdict_json(verdict_).dump(2) + "\n";
  if (Status s = command::write_text(in("verdict.json"), verdict); !s) return s;
  const command::Subject subject{"forcelayer study", "forcelayer.study", options_.node};
  const std::string test = command::junit_text(subject, verdict_, 0);
  if (Status s = command::write_text(in("verdict.xml"), test); !s) return s;
  return command::write_text(in("verdict.txt"), text_);
}

Status Study::draw() {
  if (options_.no_pictures) return {};
  const auto drawn = run(picture_step());
  return drawn ? Status{} : drawn.error();
}

Status Study::write_page() {
  Page page;
  page.part = options_.node;
  page.assembly = std::filesystem::path(options_.assembly).filename().string();
  page.verdict = verdict_;
  page.text = text_;
  page.report = checked_;
  page.scene = read_json(in("scene.json"));
  page.shell = read_json(in("part.json"));
  page.files = {in("scene.vox"), in("part.pshell"), in("verdict.json")};
  if (!path_.empty()) {
    auto svg = curve_svg(in("curve.csv"), page.report);
    if (!svg) return svg.error();
    page.curve_svg = std::move(*svg);
    if (Status s = command::write_text(in("curve.svg"), page.curve_svg); !s) return s;
    page.files.insert(page.files.end(), {path_, in("curve.csv")});
    if (!options_.no_pictures) page.pictures.push_back({in("worst.png"), "The worst moment"});
  }
  if (!options_.no_pictures) {
    page.pictures.push_back({in("installed.png"), "Where the part is installed"});
  }
  for (const auto& line : steps_.lines()) page.commands.push_back(line.command);
  const auto html = html_of(page);
  if (!html) return html.error();
  if (Status written = command::write_text(in("report.html"), *html); !written) return written;
  if (!options_.quiet) std::printf("%s\n", escaped(in("report.html")).c_str());
  return {};
}

Status Study::report() const {
  if (options_.json.empty()) return {};
  nlohmann::ordered_json report;
  report.update(command::verdict_json(verdict_));
  report["sentence"] = sentence_;
  report["words"] = text_;
  report["page"] = in("report.html");
  report["path"] = path_.empty() ? json() : json(path_);
  report["blocked_by"] = path_.empty() ? verdict_.blocked_by : blockers(checked_);
  report["check"] = checked_;
  for (const auto& line : steps_.lines()) {
    report["steps"].push_back(
        {{"command", line.command}, {"status", line.status}, {"unchanged", line.again}});
  }
  return command::write_report(options_.json, report);
}

Status Study::judge() const {
  if (command::is_yes(verdict_.kind)) return {};
  const std::string mend =
      path_.empty()
          ? "the same search finds no path again; try a longer --time, another --seed, a smaller "
            "--clearance or --voxel-size, or give a path of your own with --path or --pull"
          : "see " + in("report.html");
  return Error{ErrorCode::kAnswerIsNo, options_.assembly, options_.node,
               sentence_.substr(0, sentence_.size() - 1), mend};
}

Status Study::make() {
  if (!options_.path.empty()) {  // before minutes of baking
    if (const auto path = FileBytes::read(options_.path); !path) return path.error();
  }
  if (Status s = bake(); !s) return s;
  if (Status s = find_path(); !s) return s;
  if (Status s = check(); !s) return s;
  if (Status s = draw(); !s) return s;
  if (Status s = write_page(); !s) return s;
  if (Status s = report(); !s) return s;
  return judge();
}

// The folder, locked for as long as this lives: two studies at once would mix their files. The
// system lets it go however this program ends, and nothing is written. A file system that knows no
// such lock refuses nobody.
Result<Descriptor> lock_folder(const std::string& folder) {
  Descriptor locked(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (locked.valid() && ::flock(locked.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return Error{ErrorCode::kWriteFailed, folder, "--output", "another study is writing to it",
                 "wait for its end, or name another folder"};
  }
  return locked;
}

}  // namespace

Status make_study(const Options& options) {
  std::error_code failure;
  const bool made = std::filesystem::create_directories(options.folder, failure);
  if (failure) {
    return Error{ErrorCode::kWriteFailed, options.folder, "--output", failure.message(),
                 "name a folder that can be written to"};
  }
  const auto locked = lock_folder(options.folder);
  if (!locked) return locked.error();
  auto steps =
      Steps::open((std::filesystem::path(options.folder) / "study.json").string(), options.quiet);
  if (!steps) return steps.error();
  Status status = Study(options, std::move(*steps)).make();
  if (!status && made) std::filesystem::remove(options.folder, failure);  // where it is empty
  return status;
}

}  // namespace forcelayer::study
