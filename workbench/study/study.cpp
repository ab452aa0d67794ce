#include "workbench/study/study.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "formats/command/command.h"
#include "formats/command/program.h"
#include "formats/command/quantity.h"
#include "formats/command/report.h"
#include "formats/command/spelling/spelling.h"
#include "formats/command/text.h"
#include "formats/command/verdict/hosts.h"
#include "formats/command/verdict/verdict.h"
#include "formats/command/version.h"
#include "formats/file/descriptor.h"
#include "formats/file/file_bytes.h"
#include "formats/path/path_file.h"
#include "workbench/study/curve.h"
#include "workbench/study/page.h"
#include "workbench/study/steps.h"
#include "workbench/study/voxel_size.h"

namespace forcelayer::study {
namespace {

using nlohmann::json;

constexpr const char* kPathHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
const std::string kSmallerOnes = "with smaller ones, down to ";
constexpr const char* kTooDeep = "the part starts ";  // more than so deep inside of something
constexpr const char* kMeshesHelp = "leave out --files-alone: meshes can give an answer";
const std::string kDefaultTime = "120s";  // for all of a study, without --time
constexpr const char* kBakeReports[] = {"scene.json", "part.json"};
constexpr int kCheckReadings = 2;  // a check may read the meshes twice
constexpr int kAnswerIsNo = exit_status(ErrorCode::kAnswerIsNo);

json read_json(const std::string& path) {
  std::ifstream file(path);
  return json::parse(file, nullptr, false);
}

// The files of an answer. While smaller voxels are tried, they wait in this folder. The picture of
// the installed part does not depend on voxels, and stays.
constexpr const char* kKeptFolder = "larger_voxels";
constexpr const char* kAnswerFiles[] = {
    "scene.vox",   "scene.json",  "part.pshell",  "part.json",    "path.csv",      "trace.csv",
    "run.json",    "plan.json",   "straight.csv", "farthest.csv", "hand.json",     "check.json",
    "curve.csv",   "curve.svg",   "worst.png",    "motion.glb",   "clearance.glb", "verdict.json",
    "verdict.txt", "verdict.xml", "report.html"};

// The answer with the files of one voxel size.
struct Answer {
  std::string path;    // that is checked; empty where the search found none,
  double moved_m = 0;  // which then moved the part so far
  json checked;        // report of voxcheck; null where there is no path
  command::Verdict verdict;
  std::string heading;   // the first words of the sentence
  std::string sentence;  // the first one
  std::string text;      // that and the lines that follow it
  bool draws = false;
};

// An answer that is used again where smaller voxels give none.
struct KeptAnswer {
  std::string voxel_size;
  Answer answer;
  Steps steps;
};

// One study, step by step.
class Study {
 public:
  ~Study() { drop_kept(); }

  Study(const Options& options, Steps steps)
      : options_(options),
        steps_(std::move(steps)),
        voxel_size_(options.voxel_size),
        begun_(std::chrono::steady_clock::now()),
        allowed_s_(*command::parse_duration(time_option())) {}

  Status make();

 private:
  std::string in(const char* name) const {
    return (std::filesystem::path(options_.folder) / name).string();
  }
  // Whether the file is the one of --path, which is only read.
  bool is_own_path(const std::string& file) const {
    std::error_code failure;
    return std::filesystem::equivalent(file, options_.path, failure);
  }
  std::string part_mesh() const { return options_.assembly + "#" + options_.node; }

  std::vector<std::string> left_out() const;
  void add_reading(Step& step) const;
  void add_meshes(Step& step) const;
  void add_check_meshes(Step& step, double fraction) const;
  void add_time(Step& step, double fraction, int readings) const;
  double left_s() const;
  double reading_s() const;
  const std::string& time_option() const {
    return options_.time.empty() ? kDefaultTime : options_.time;
  }
  std::string limit_text() const;
  void add_bake_reading(Step& step) const;
  bool is_deep() const;
  Step scene_step() const;
  Step part_step() const;
  Step pull_step() const;
  Step plan_step() const;
  Step check_step() const;
  Step hand_step() const;
  Step rules_step() const;
  Status read_search_rules();
  void add_rules(Step& step) const;
  Step picture_step() const;
  Step list_step() const;
  Step installed_step() const;

  Status choose_voxel_size();
  Result<nlohmann::json> look();
  void take_look(const nlohmann::json& look);
  Result<double> look_size() const;
  bool has_time_for(double voxel_size_m) const;
  bool is_out_of_time() const;
  Status keep_size(const std::string& key, const std::vector<std::string>& inputs,
                   const json& installed);
  Status keep_answer();
  Status restore_answer();
  void drop_kept();
  bool is_kept_better() const;
  Status plan() const;
  Status answer();
  Status answer_once();
  std::string open_answer() const;
  Play measured_play() const;
  nlohmann::ordered_json play_json() const;
  void note_voxel_size();
  void add_seconds(const Step& step, const StepEnd& end);
  std::string seconds_text() const;

  Status bake();
  Status find_path();
  Status pull();
  Status write_path(const char* name, std::initializer_list<double> fractions) const;
  Status write_farthest(const json& plan);
  Status check();
  Result<StepEnd> check_path(const std::string& path);
  Status say_that_no_path_was_found();
  command::Subject subject() const {
    return {"forcelayer study", "forcelayer.study", options_.node};
  }
  Status write_verdict(const std::string& junit, const json& exit_status);
  Status write_bare_page(const command::Verdict& verdict) const;
  Status draw();
  Status write_page();
  Status report(int status = 0) const;
  Status judge() const;
  std::string advice() const;

  Step question() const;
  Status begin_step(const Step& step);
  command::Verdict unfinished(const std::string& why) const;
  Status make_all();
  void say_that_it_failed(const Error& error);

  // Runs a step that must end so; any other end is a failure, which is printed.
  enum class MayEnd { kDone, kAnswered, kRefused };
  Result<StepEnd> run(const Step& step, MayEnd may_end = MayEnd::kDone);

  const Options& options_;
  Steps steps_;
  std::string voxel_size_;  // of the bakes
  // With --rules: the largest clearance that an object requires, and those that none is asked of.
  std::string search_clearance_;
  std::vector<std::string> search_allow_;
  bool is_deep_ = false;      // files were refused because the part overlaps too deep,
  bool is_too_deep_ = false;  // as were those of the last step
  std::optional<SizeCost> look_;
  Play play_;
  SizeChoice choice_;
  std::vector<json> tried_;  // sizes that left the answer open, and why
  std::chrono::steady_clock::time_point begun_;
  double allowed_s_;                       // for the whole study
  std::map<std::string, double> seconds_;  // of the steps, by kind
  std::string no_finer_;  // why a smaller size gave no answer at all; empty: none was tried
  Answer answer_;
  std::optional<KeptAnswer> kept_;
  bool is_held_ = false;     // the simulated hand did not reach the end of its pull
  bool is_known_ = false;    // the page is there, of the same question
  bool is_checked_ = false;  // the verdict in the folder is that of these voxels
  std::string failure_;      // why a step failed, in its own words
};

// The error that a command wrote into its report since `begun`, in words about options of a study.
std::optional<Error> written_error(const Step& step, std::filesystem::file_time_type begun) {
  const auto option = std::find(step.arguments.begin(), step.arguments.end(), "--json");
  if (option == step.arguments.end() || option + 1 == step.arguments.end()) return {};
  std::error_code failure;
  const auto written = std::filesystem::last_write_time(*(option + 1), failure);
  if (failure || written < begun) return {};
  const json report = read_json(*(option + 1));
  if (!report.is_object() || !report.contains("error") || !report["error"].is_object()) return {};
  const json& told = report["error"];
  Error error{static_cast<ErrorCode>(told.value("code", 0)), told.value("file", ""),
              told.value("where", ""), told.value("what", ""), told.value("mend", "")};
  const std::string known = command::with_known_options(error.mend);
  if (known == error.mend) return error;
  const bool is_of_start = error.where == "start" || error.where == "--seat";
  error.mend = known;
  if (error.what.find("lies inside the part") != std::string::npos) {
    error.mend = "leave this object out (--without)";
  } else if (is_of_start && (known.empty() || error.what.starts_with(kTooDeep))) {
    // Voxels fill a closed cavity, and the distances that they store end at some depth.
    error.what = error.what.substr(0, error.what.find("; the stored distances"));
    error.mend =
        "check --units; leave out the objects that enclose or overlap the part (--without), or use "
        "a smaller --voxel-size if it can leave through an opening narrower than a voxel";
  }
  return error;
}

// Whether a path, or a recording, may turn the part. Without turns a clearance map is exact, and
// made in little time.
bool does_turn(const std::string& path) {
  const auto rows = read_path(path, PathOf::kPart);
  return !rows || std::ranges::any_of(*rows, [&](const PathRow& row) {
    return row.orientation_wxyz != rows->front().orientation_wxyz;
  });
}

// Without its full stop.
std::string bare_sentence(const std::string& sentence) {
  return sentence.substr(0, sentence.size() - 1);
}

std::string end_text(int status) {
  if (status <= 128) return "ended with status " + std::to_string(status);
  const char* const name = sigabbrev_np(status - 128);
  return std::string("was ended by ") + (name == nullptr ? "a signal" : "SIG" + std::string(name));
}

Error stopped_error(const std::string& program) {
  return {
      ErrorCode::kInternal, "", "",
      std::string("SIG") + sigabbrev_np(command::stop_signal()) + " stopped the step " + program,
      ""};
}

// voxplan refuses a seat beside objects from which the files prove too little.
bool is_refused_search(const Error& error) {
  return error.code == ErrorCode::kUsage && error.where == "voxplan";
}

Result<StepEnd> Study::run(const Step& step, MayEnd may_end) {
  failure_.clear();
  is_too_deep_ = false;
  if (command::stop_signal() != 0) return stopped_error(step.program);
  const auto begun = std::filesystem::file_time_type::clock::now();
  const auto end = steps_.run(step, [&] { return begin_step(step); });
  if (!end) return end;
  add_seconds(step, *end);
  if (end->status != 0 && command::stop_signal() != 0) return stopped_error(step.program);
  const bool is_refused = end->status == exit_status(ErrorCode::kUsage);
  if (end->status == 0 || (may_end == MayEnd::kRefused && is_refused)) return end;
  const std::optional<Error> error = written_error(step, begun);
  // That force is needed is said once, by the study.
  const bool needs_force = end->status == exit_status(ErrorCode::kNeedsForce);
  is_too_deep_ = error && error->what.starts_with(kTooDeep) && !is_deep() && !options_.files_alone;
  if (error && !needs_force && !is_too_deep_) command::print_error(step.program.c_str(), *error);
  if (may_end != MayEnd::kDone && command::is_answer(end->status)) return end;
  failure_ = step.program + " " + end_text(end->status) + (error ? ": " + to_line(*error) : "");
  ErrorCode code = ErrorCode::kInternal;
  for (const ErrorCode other :
       {ErrorCode::kUsage, ErrorCode::kMeshUnreadable, ErrorCode::kNotThisFormat,
        ErrorCode::kDeviceFailed, ErrorCode::kAnswerIsNo}) {
    if (end->status == exit_status(other)) code = other;
  }
  // The system's refusals and signals pass; a wrong command line or file stays wrong.
  const bool may_pass = end->status == exit_status(ErrorCode::kInternal) || end->status >= 128;
  return Error{code, "", step.program, end_text(end->status) + ", so the study is not finished",
               std::string("see the error above") +
                   (may_pass ? "; the same command continues from there" : "")};
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

// The time that is left for the study; negative where more was spent.
double Study::left_s() const {
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun_;
  return allowed_s_ - spent.count();
}

// "--time (60s)", or of a study to which none was given.
std::string Study::limit_text() const {
  return options_.time.empty() ? "the default time (" + kDefaultTime + "; --time changes it)"
                               : "--time (" + options_.time + ")";
}

// How long the last bakes read the meshes: each step that measures between them does it again.
double Study::reading_s() const {
  if (options_.files_alone) return 0;
  double seconds = 0;
  for (const char* const name : kBakeReports) {
    const json report = read_json(in(name));
    if (report.is_object() && report.contains("seconds")) {
      seconds += report["seconds"]["read"].get<double>();
    }
  }
  return seconds;
}

// The last argument: so much of the time that is left for the whole study, when this and later
// steps have read the meshes so often. A little is always allowed: a question that is answered at
// once has an answer.
void Study::add_time(Step& step, double fraction, int readings) const {
  constexpr double kLeastFraction = 0.02;
  step.arguments.insert(step.arguments.end(), {"--time", time_option()});
  step.left_s =
      std::max(kLeastFraction * allowed_s_, fraction * (left_s() - readings * reading_s()));
}

// For voxcheck, which has the meshes measured for so much of the time that is left.
void Study::add_check_meshes(Step& step, double fraction) const {
  if (options_.files_alone) return;
  add_meshes(step);
  add_time(step, fraction, kCheckReadings);
}

// The reports of the baked files.
void Study::add_bake_reading(Step& step) const {
  add_reading(step);
  if (!options_.up.empty()) step.arguments.insert(step.arguments.end(), {"--up", options_.up});
  if (options_.missing_faces.empty()) return;
  step.arguments.insert(step.arguments.end(), {"--missing-faces", options_.missing_faces});
}

// Whether the part overlaps a neighbor by more than the distances that are usually stored.
bool Study::is_deep() const {
  constexpr double kUsualVoxels = 0.5;
  return is_deep_ || play_.overlap_m > kUsualVoxels * *command::parse_length(voxel_size_);
}

Step Study::scene_step() const {
  Step step{"voxelize",
            {options_.assembly},
            with_references(options_.assembly),
            {in("scene.vox"), in("scene.json")},
            "forcelayer-tools"};
  const auto out = left_out();
  step.arguments.insert(step.arguments.end(), out.begin(), out.end());
  step.arguments.insert(step.arguments.end(), {"--voxel-size", voxel_size_, "-o", in("scene.vox"),
                                               "--json", in("scene.json")});
  if (is_deep()) {
    const double voxel_m = *command::parse_length(voxel_size_);
    step.arguments.insert(step.arguments.end(), {"--range", size_option(kDeepestVoxels * voxel_m)});
  }
  add_bake_reading(step);
  return step;
}

Step Study::part_step() const {
  Step step{"pointshell",
            {part_mesh(), "--voxel-size", voxel_size_, "-o", in("part.pshell"), "--json",
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
            "forcelayer-runtime",
            false};
  if (!options_.seat.empty()) {
    step.arguments.insert(step.arguments.end(), {"--seat", options_.seat});
  }
  return step;
}

Step Study::plan_step() const {
  const bool has_rules = !search_clearance_.empty();
  Step step{"voxplan",
            {in("scene.vox"), in("part.pshell"), "--clearance",
             has_rules ? search_clearance_ : options_.clearance, "--seat", options_.seat, "-o",
             in("path.csv"), "--json", in("plan.json")},
            {in("scene.vox"), in("part.pshell")},
            {in("path.csv"), in("plan.json")},
            "forcelayer-tools",
            false};
  for (const std::string& object : has_rules ? search_allow_ : options_.allow) {
    step.arguments.insert(step.arguments.end(), {"--allow", object});
  }
  if (!options_.files_alone) add_meshes(step);
  // A path that is found may take as long again to be proven, and so may its check.
  constexpr double kOfSearch = 1.0 / 3;
  add_time(step, kOfSearch, 1 + kCheckReadings);
  return step;
}

Step Study::check_step() const {
  Step step{"voxcheck",
            {in("scene.vox"), in("part.pshell"), answer_.path, "--clearance", options_.clearance,
             "--fail-on", "nothing"},  // a "no" is said once, by the study
            {in("scene.vox"), in("part.pshell"), answer_.path},
            {in("check.json"), in("curve.csv"), in("verdict.xml")},
            "forcelayer-runtime",
            false};
  const auto add = [&](const std::vector<std::string>& more) {
    step.arguments.insert(step.arguments.end(), more.begin(), more.end());
  };
  if (!options_.center.empty()) add({"--center", options_.center});
  if (!options_.seat.empty()) add({"--seat", options_.seat});
  for (const std::string& object : options_.allow) add({"--allow", object});
  if (!options_.files_alone) add_meshes(step);
  add_rules(step);
  add({"--json", in("check.json"), "--report", "csv:" + in("curve.csv"), "--report",
       "junit:" + in("verdict.xml")});
  if (!options_.files_alone) {
    add({"--report", "animation:" + in("motion.glb")});
    step.outputs.push_back(in("motion.glb"));
    if (!does_turn(answer_.path)) {
      add({"--report", "map:" + in("clearance.glb")});
      step.outputs.push_back(in("clearance.glb"));
    }
  }
  if (answer_.draws) {
    add({"--report", "picture:" + in("worst.png")});
    step.outputs.push_back(in("worst.png"));
  }
  // The answer about a path is worth more than the default time.
  if (!options_.files_alone && !options_.time.empty()) add_time(step, 1, kCheckReadings);
  return step;
}

// The path of the simulated hand, beside the straight one.
Step Study::hand_step() const {
  Step step{"voxcheck",
            {in("scene.vox"), in("part.pshell"), in("path.csv"), "--clearance", options_.clearance,
             "--fail-on", "nothing", "--json", in("hand.json")},
            {in("scene.vox"), in("part.pshell"), in("path.csv")},
            {in("hand.json")},
            "forcelayer-runtime",
            false};
  if (!options_.seat.empty()) {
    step.arguments.insert(step.arguments.end(), {"--seat", options_.seat});
  }
  for (const std::string& object : options_.allow) {
    step.arguments.insert(step.arguments.end(), {"--allow", object});
  }
  add_rules(step);
  add_check_meshes(step, 1);
  return step;
}

void Study::add_rules(Step& step) const {
  if (options_.rules.empty()) return;
  step.arguments.insert(step.arguments.end(), {"--rules", options_.rules});
  step.inputs.push_back(options_.rules);
}

// The requirement of each object, from a check of the installed part.
Step Study::rules_step() const {
  Step step{
      "voxcheck",
      {in("scene.vox"), in("part.pshell"), in("installed.csv"), "--clearance", options_.clearance,
       "--seat", options_.seat, "--fail-on", "nothing", "--json", in("rules.json")},
      {in("scene.vox"), in("part.pshell"), in("installed.csv")},
      {in("rules.json")},
      "forcelayer-runtime",
      false};
  for (const std::string& object : options_.allow) {
    step.arguments.insert(step.arguments.end(), {"--allow", object});
  }
  add_rules(step);
  add_meshes(step);
  return step;
}

// A search knows one clearance: the largest is enough for every object.
Status Study::read_search_rules() {
  if (Status s = write_path("installed.csv", {0}); !s) return s;
  if (const auto asked = run(rules_step()); !asked) return asked.error();
  double largest_m = 0;
  search_allow_.clear();
  const json report = read_json(in("rules.json"));
  for (const json& rule : report.at("rules")) {
    if (rule.at("required_clearance_m").is_number()) {
      largest_m = std::max<double>(largest_m, rule.at("required_clearance_m"));
    } else {
      search_allow_ = rule.at("objects").get<std::vector<std::string>>();
    }
  }
  search_clearance_ = command::text("%.17gm", largest_m);
  return {};
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

// The part first: a wrong name of it is refused in words about the part.
Status Study::bake() {
  const auto part = run(part_step());
  if (!part) return part.error();
  const auto scene = run(scene_step());
  if (!scene) return scene.error();
  return {};
}

Status Study::find_path() {
  answer_.path = options_.path;
  if (!answer_.path.empty()) return {};
  answer_.path = in("path.csv");
  if (!options_.searches()) return pull();
  if (!options_.rules.empty()) {
    if (Status s = read_search_rules(); !s) return s;
  }
  const auto planned = run(plan_step(), MayEnd::kAnswered);
  if (!planned) return planned.error();
  if (planned->status == kAnswerIsNo) answer_.path.clear();
  return {};
}

// Whether the straight path is free is asked of the meshes, and which objects block it: a simulated
// hand feels one of them, and what it feels depends on the voxels.
Status Study::pull() {
  // Where the voxels refuse to move the part, the meshes may still have an answer.
  const auto pulled = run(pull_step(), options_.files_alone ? MayEnd::kAnswered : MayEnd::kRefused);
  if (!pulled) return pulled.error();
  const json run = read_json(in("run.json"));
  const json ended = run.is_object() ? run.value("pull", json()) : json();
  is_held_ =
      !command::is_answer(pulled->status) || (ended.is_object() && ended.value("held", false));
  answer_.path = in("straight.csv");
  return write_path("straight.csv", {0, 1});
}

// Straight by fractions of the pull, from the seat.
Status Study::write_path(const char* name, std::initializer_list<double> fractions) const {
  const auto pull_m = command::parse_point(options_.pull.empty() ? "0,0,0m" : options_.pull);
  const auto seat = command::parse_pose(options_.seat.empty() ? "0,0,0m" : options_.seat);
  if (!pull_m || !seat) return pull_m ? seat.error() : pull_m.error();
  const auto& [position_m, orientation] = *seat;
  std::string rows = kPathHeader;
  for (const double fraction : fractions) {
    rows += command::text("%.17g", fraction);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows += command::text(",%.17g", position_m[axis] + fraction * (*pull_m)[axis]);
    }
    for (const double q : orientation) rows += command::text(",%.17g", q);
    rows += "\n";
  }
  return command::write_text(in(name), rows);
}

Result<StepEnd> Study::check_path(const std::string& path) {
  answer_.path = path;
  auto checked = run(check_step());
  is_checked_ = true;
  if (!checked) return checked;
  // The report of voxcheck, which ended with status 0 for any answer, with the status of this one.
  std::ifstream file(in("check.json"));
  auto report = nlohmann::ordered_json::parse(file, nullptr, false);
  if (!report.is_object()) report = nlohmann::ordered_json::object();
  const auto kind = command::verdict_kind(report.value("kind", ""));
  report["exit_status"] = command::is_yes(kind) ? 0 : exit_status(command::error_code(kind));
  answer_.checked = report;
  if (Status s = command::write_report(in("verdict.json"), report); !s) return s.error();
  return checked;
}

Status Study::check() {
  answer_.checked = nullptr;
  answer_.verdict = {};
  answer_.moved_m = 0;
  std::remove(in("farthest.csv").c_str());  // of an earlier search
  if (answer_.path.empty()) return say_that_no_path_was_found();
  auto checked = check_path(answer_.path);
  if (!checked) return checked.error();
  std::string hand_note;
  // Another path may lead around what the part meets. Where it is only too near, the answer is how
  // near.
  const auto kind = command::verdict_kind(answer_.checked.value("kind", ""));
  const bool is_blocked =
      kind == command::VerdictKind::kDoesNotComeOut || kind == command::VerdictKind::kCollides;
  if (!options_.pull.empty() && !is_held_ && is_blocked) {
    // The hand went to the end of its pull. Where its own path is clear, that is the answer.
    if (const auto hand = run(hand_step()); !hand) return hand.error();
    const json hand = read_json(in("hand.json"));
    if (command::passes(command::verdict_kind(hand.value("kind", "")))) {
      checked = check_path(in("path.csv"));
    } else {
      hand_note =
          "a simulated hand pulled the part out along a path of its own, for which the "
          "answer is: " +
          hand.value("kind", "") + " (hand.json)";
    }
    if (!checked) return checked.error();
  }
  answer_.verdict = {};
  answer_.verdict.kind = command::verdict_kind(answer_.checked.value("kind", ""));
  answer_.verdict.required_m = answer_.checked.value("required_clearance_m", 0.0);
  if (answer_.checked["direction"].is_string())
    answer_.verdict.motion = answer_.checked["direction"];
  if (answer_.checked["finding"].is_string()) answer_.verdict.finding = answer_.checked["finding"];
  answer_.verdict.blocked_by = answer_.checked.value("blocked_by", std::vector<std::string>());
  answer_.heading = answer_.checked.value("heading", "");
  answer_.sentence = answer_.checked.value("sentence", "");
  answer_.text = checked->output;
  if (!hand_note.empty()) answer_.text += "  " + hand_note + "\n";
  const bool is_open = answer_.verdict.kind == command::VerdictKind::kUndecided;
  if (options_.files_alone && is_open) answer_.text += std::string("  ") + kMeshesHelp + "\n";
  return command::write_text(in("verdict.txt"), answer_.text);
}

// In the words of voxplan: what it tried, and what was in the way. The files of an earlier verdict
// would say something else.
Status Study::say_that_no_path_was_found() {
  const json plan = read_json(in("plan.json"));
  const json found = plan.is_object() ? plan : json::object();
  answer_.verdict.kind = command::VerdictKind::kNoPathFound;
  const json scene = read_json(in("scene.json"));
  for (const json& part : scene.value("parts", json::array())) {
    answer_.verdict.scene_names.push_back(part.value("name", ""));
  }
  answer_.verdict.required_m = found.value("required_clearance_m", 0.0);
  if (found.contains("finding") && found["finding"].is_string()) {
    answer_.verdict.kind = command::verdict_kind(found.value("kind", ""));
    answer_.verdict.finding = found["finding"];
    answer_.verdict.blocked_by = found["blocked_by"].get<std::vector<std::string>>();
    const json best = found.value("best", json::object());
    answer_.moved_m = best.value("out_m", 0.0);
    answer_.verdict.notes = best.value("notes", std::vector<std::string>());
  } else {  // refused before the search
    answer_.verdict.finding =
        found.value("error", json::object()).value("what", "the search did not begin");
    const auto required_m = command::parse_length(options_.clearance);
    answer_.verdict.required_m = required_m ? *required_m : 0;
  }
  if (Status s = write_farthest(found); !s) return s;
  return write_verdict(command::junit_text(subject(), answer_.verdict, 0), kAnswerIsNo);
}

// The path by which the search moved the part farthest, for voxview.
Status Study::write_farthest(const json& plan) {
  const json best = plan.value("best", json::object());
  std::string rows;
  for (const json& pose : best.value("path", json::array())) {
    for (const json& number : pose) {
      rows += (rows.empty() || rows.back() == '\n' ? "" : ",") +
              command::text("%.17g", number.get<double>());
    }
    rows += "\n";
  }
  if (rows.empty()) return {};
  answer_.verdict.notes.push_back("voxview --trace " + in("farthest.csv") +
                                  " shows how far the search moved the part");
  return command::write_text(in("farthest.csv"), std::string(kPathHeader) + rows);
}

// Where no path was checked.
Status Study::write_verdict(const std::string& junit, const json& exit_status) {
  answer_.heading = command::heading(answer_.verdict);
  answer_.sentence = command::sentence(answer_.verdict);
  answer_.text = command::terminal_text(answer_.verdict);
  for (const char* name :
       {"check.json", "curve.csv", "curve.svg", "worst.png", "motion.glb", "clearance.glb"})
    std::remove(in(name).c_str());
  // It begins as the report of voxcheck, which replaces nothing else.
  nlohmann::ordered_json verdict{{"schema_version", command::kReportSchema},
                                 {"tool", "forcelayer"},
                                 {"tool_version", command::kVersion},
                                 {"commit", command::commit()},
                                 {"exit_status", exit_status}};
  verdict.update(command::verdict_json(answer_.verdict));
  if (Status s = command::write_report(in("verdict.json"), verdict); !s) return s;
  if (Status s = command::write_text(in("verdict.xml"), junit); !s) return s;
  return command::write_text(in("verdict.txt"), answer_.text);
}

command::Verdict Study::unfinished(const std::string& why) const {
  command::Verdict verdict;
  const auto required_m = command::parse_length(options_.clearance);
  verdict.required_m = required_m ? *required_m : 0;
  verdict.is_asked = false;  // nothing was checked
  verdict.finding = "the study is not finished: " + why;
  return verdict;
}

// Until there is an answer, the folder says that there is none, however this ends.
Status Study::begin_step(const Step& step) {
  if (is_known_ || options_.plan) return {};
  const command::Verdict verdict =
      unfinished("the step " + step.program + " is running, or was stopped");
  if (!is_checked_) {
    answer_.verdict = verdict;
    const Error error{ErrorCode::kInternal, "", "", bare_sentence(command::sentence(verdict)), ""};
    if (Status s = write_verdict(command::junit_text(subject(), error), nullptr); !s) return s;
  }
  return write_bare_page(verdict);
}

// A study without pictures is still one: where voxview is not installed, or cannot draw.
Status Study::draw() {
  if (options_.no_pictures) return {};
  if (command::program_path("voxview").empty()) {
    command::warn("voxview is not installed: the page has no pictures", options_.quiet);
    return {};
  }
  const Step picture = picture_step();
  const auto drawn = steps_.run(picture, [&] { return begin_step(picture); });
  if (!drawn) return drawn.error();
  add_seconds(picture, *drawn);
  if (command::stop_signal() != 0) return stopped_error(picture.program);
  answer_.draws = drawn->status == 0;
  if (!answer_.draws)
    command::warn("voxview cannot draw: the page has no pictures", options_.quiet);
  return {};
}

// The whole assembly, for the size of the part and of all.
Step Study::list_step() const {
  Step step{"voxelize",
            {"--list", options_.assembly, "--json", in("list.json")},
            with_references(options_.assembly),
            {in("list.json")},
            "forcelayer-tools",
            false};
  add_reading(step);
  if (!options_.up.empty()) step.arguments.insert(step.arguments.end(), {"--up", options_.up});
  return step;
}

// How near the part is to its neighbors as installed.
Step Study::installed_step() const {
  Step step{"voxcheck",
            {in("scene.vox"), in("part.pshell"), in("installed.csv"), "--clearance",
             options_.clearance, "--fail-on", "nothing", "--json", in("installed.json")},
            {in("scene.vox"), in("part.pshell"), in("installed.csv")},
            {in("installed.json")},
            "forcelayer-runtime",
            false};
  if (!options_.seat.empty()) {
    step.arguments.insert(step.arguments.end(), {"--seat", options_.seat});
  }
  constexpr double kOfPlay = 0.25;  // the answer does not depend on it
  add_check_meshes(step, kOfPlay);
  return step;
}

Result<double> Study::look_size() const {
  const json list = read_json(in("list.json"));
  const auto longest_m = [](const json& node) {
    double longest = 0;
    for (std::size_t axis = 0; axis < 3 && node.contains("low_m"); ++axis) {
      const double low = node["low_m"][axis], high = node["high_m"][axis];
      longest = std::max(longest, high - low);
    }
    return longest;
  };
  const std::string part = command::without_first_numbers(options_.node);
  double scene_m = 0, part_m = INFINITY;
  for (const json& file : list.is_object() ? list.value("files", json::array()) : json::array()) {
    scene_m = std::max(scene_m, longest_m(file["whole"]));
    for (const json& node : file["nodes"]) {
      const std::string path = node.value("node", "");
      const bool is_part = path == part || path.ends_with("/" + part);
      if (is_part && longest_m(node) > 0) part_m = std::min(part_m, longest_m(node));
    }
  }
  if (scene_m == 0) {
    return Error{ErrorCode::kUsage, options_.assembly, "--voxel-size",
                 "auto needs the size of the assembly, but the files state no unit",
                 "add --units, for example --units mm"};
  }
  const auto required_m = command::parse_length(options_.clearance);
  return look_size_m(std::min(part_m, scene_m), scene_m, required_m ? *required_m : 0);
}

// Bakes coarse files, and measures with them how near the part is to its neighbors. Returns all
// that take_look() needs.
Result<json> Study::look() {
  if (options_.is_auto()) {
    if (const auto listed = run(list_step()); !listed) return listed.error();
    const auto size_m = look_size();
    if (!size_m) return size_m.error();
    voxel_size_ = size_option(*size_m);
  }
  if (Status s = bake(); !s) return s.error();
  if (Status s = write_path("installed.csv", {0}); !s) return s.error();
  auto installed = run(installed_step(), options_.is_auto() ? MayEnd::kRefused : MayEnd::kDone);
  if (installed && installed->status != 0) {
    is_deep_ = true;
    if (Status s = bake(); !s) return s.error();
    installed = run(installed_step());
  }
  if (!installed) return installed.error();
  const json scene = read_json(in("scene.json")), part = read_json(in("part.json"));
  const json expected = scene.value("expected", json::object()), shell = part["expected"];
  return json{{"voxel_size", voxel_size_},
              {"is_deep", is_deep_},
              {"installed", read_json(in("installed.json"))},
              {"fits_m", scene["zero_force_m"]},
              {"points", part["points"]},
              {"bytes", std::max(expected.value("bytes", 0.0), shell.value("bytes", 0.0))},
              {"thread_s", expected.value("thread_s", 0.0) + shell.value("thread_s", 0.0)},
              {"part_m", 2 * part["bounding_radius_m"].get<double>()},
              {"seconds", seconds_}};
}

// Chooses the voxel sizes by a look of this study, or of an earlier one that was stopped.
void Study::take_look(const json& look) {
  voxel_size_ = look["voxel_size"];
  is_deep_ = look["is_deep"];
  seconds_ = look["seconds"].get<std::map<std::string, double>>();
  play_ = play_of(look["installed"]);
  look_ = SizeCost{*command::parse_length(voxel_size_), look["fits_m"], look["points"],
                   look["bytes"], look["thread_s"]};
  SizeQuestion question;
  question.part_m = look["part_m"];
  question.required_m = *command::parse_length(options_.clearance);
  question.time_s = allowed_s_;
  question.memory_bytes =
      static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  choice_ = choose_size(question, *look_, play_);
}

// All that the answer depends on, and the files that hold it.
Step Study::question() const {
  Step question;
  question.program = "study";
  question.arguments = {options_.assembly, options_.node, options_.clearance};
  for (const std::string* text :
       {&options_.voxel_size, &options_.units, &options_.up, &options_.path, &options_.center,
        &options_.pull, &options_.time, &options_.seat, &options_.seat_depth,
        &options_.missing_faces, &options_.rules}) {
    question.arguments.push_back(*text);
  }
  for (const auto* list : {&options_.allow, &options_.without}) {
    question.arguments.push_back("--");
    question.arguments.insert(question.arguments.end(), list->begin(), list->end());
  }
  question.arguments.push_back(options_.files_alone ? "files" : "meshes");
  question.inputs = with_references(options_.assembly);
  if (!options_.path.empty()) question.inputs.push_back(options_.path);
  if (!options_.rules.empty()) question.inputs.push_back(options_.rules);
  question.outputs = {in("report.html"), in("verdict.json"), in("verdict.xml"), in("verdict.txt")};
  return question;
}

// Moves the files of the answer aside, before smaller voxels are tried.
Status Study::keep_answer() {
  drop_kept();
  const std::filesystem::path folder = in(kKeptFolder);
  std::error_code failure;
  std::filesystem::create_directory(folder, failure);
  for (const char* name : kAnswerFiles) {
    const std::string file = in(name);
    if (failure || !std::filesystem::exists(file) || is_own_path(file)) continue;
    std::filesystem::rename(file, folder / name, failure);
  }
  if (failure)
    return Error{ErrorCode::kWriteFailed, folder.string(), "--output", failure.message(), ""};
  kept_ = {voxel_size_, answer_, steps_};
  return {};
}

// Goes back to the answer that was kept.
Status Study::restore_answer() {
  const std::filesystem::path folder = in(kKeptFolder);
  std::error_code failure;
  for (const char* name : kAnswerFiles) {
    const std::string file = in(name);
    if (is_own_path(file)) continue;
    std::filesystem::remove(file, failure);
    if (std::filesystem::exists(folder / name)) {
      std::filesystem::rename(folder / name, file, failure);
    }
    if (failure) return Error{ErrorCode::kWriteFailed, file, "--output", failure.message(), ""};
  }
  voxel_size_ = kept_->voxel_size;
  answer_ = kept_->answer;
  steps_ = kept_->steps;
  drop_kept();
  std::erase_if(tried_, [&](const json& size) {
    return size_option(size["voxel_size_m"].get<double>()) == voxel_size_;
  });
  return {};
}

// Removes the files that were moved aside, also those of a study that was killed.
void Study::drop_kept() {
  kept_.reset();
  const std::filesystem::path folder = in(kKeptFolder);
  std::error_code failure;
  for (const char* name : kAnswerFiles) std::filesystem::remove(folder / name, failure);
  std::filesystem::remove(folder, failure);  // where it is empty
}

// A path whose check is open says more than a search that found none. Of searches, that says most
// which moved the part farthest: smaller voxels leave less time.
bool Study::is_kept_better() const {
  if (!kept_ || !answer_.path.empty()) return false;
  return !kept_->answer.path.empty() || answer_.moved_m <= kept_->answer.moved_m;
}

// Takes the size that an earlier study of the same inputs chose: its files are still there.
Status Study::choose_voxel_size() {
  const std::vector<std::string> inputs = question().inputs;
  const std::string key = "auto: " + command_line(question());
  const json known = steps_.recall(key, inputs);
  if (known.is_object()) {
    voxel_size_ = known["voxel_size"];
    is_deep_ = known["is_deep"];
    tried_ = known["tried"].get<std::vector<json>>();
    no_finer_ = known["no_finer"];
    play_ = play_of(known["installed"]);
    choice_ = {known["first_m"], known["last_m"], known["why_first"], known["why_last"]};
    if (Status s = answer(); !s) return s;
    seconds_ = known["seconds"].get<std::map<std::string, double>>();  // of all sizes
    return {};
  }
  const std::string look_key = "look: " + key;
  json looked = steps_.recall(look_key, inputs);
  if (looked.is_null()) {
    auto made = look();
    if (!made) return made.error();
    looked = std::move(*made);
    if (Status s = steps_.keep(look_key, inputs, looked); !s) return s;
  }
  take_look(looked);
  const json& installed = looked["installed"];
  // No bake is begun that leaves too little time for an answer: the files of the look serve, too.
  if (choice_.first_m < look_->voxel_size_m * (1 - 1e-9) && !has_time_for(choice_.first_m)) {
    choice_.first_m = look_->voxel_size_m;
    choice_.why_first = "smaller voxels would leave too little of " + limit_text();
  }
  double size_m = choice_.first_m;
  // Files with which the play was measured. They answer where no smaller voxels do.
  const bool has_look = look_->voxel_size_m > size_m * (1 + 1e-9);
  while (true) {
    voxel_size_ = size_option(size_m);
    const std::string size_text = "voxels of " + command::length_text(size_m);
    const double next_m = smaller_size_m(size_m);
    const bool is_last = next_m < choice_.last_m * (1 - 1e-9);
    const Status answered = answer();
    if (const int signal = command::stop_signal(); !answered && signal != 0) {
      if (!kept_) return answered;
      // The answer of the larger voxels stays. The next study goes on from here.
      no_finer_ = std::string("SIG") + sigabbrev_np(signal) + " stopped the study before " +
                  size_text + " gave an answer; the same command continues from there";
      return restore_answer();
    }
    if (!answered && (is_last || !is_refused_search(answered.error()))) {
      if (!kept_ && !has_look) return answered;
      no_finer_ = size_text +
                  " gave no answer: " + (failure_.empty() ? to_line(answered.error()) : failure_);
      break;
    }
    if (kept_ && is_out_of_time()) {
      no_finer_ = limit_text() + " ended before " + size_text + " gave an answer";
      break;
    }
    const std::string open =
        answered ? open_answer() : "the proven clearance of the installed part is too small";
    const bool is_over = !open.empty() && !is_last && !has_time_for(next_m);
    if (open.empty() || is_last || is_over) {
      const std::string no_time = "voxels of " + command::length_text(next_m) +
                                  " were not tried, because too little of " + limit_text() +
                                  " was left";
      if (answered && is_kept_better()) {
        tried_.push_back({{"voxel_size_m", size_m}, {"open", open}});
        no_finer_ = kept_->answer.path.empty() ? kSmallerOnes + command::length_text(size_m) +
                                                     ", no path was found either; " +
                                                     (is_over ? no_time : choice_.why_last)
                                               : "with " + size_text + " " + open;
        break;
      }
      if (!is_over) return keep_size(key, inputs, installed);
      no_finer_ = no_time;
      if (!answered) break;
      return keep_size(key, inputs, installed);
    }
    if (answered && !is_kept_better()) {
      if (Status s = keep_answer(); !s) return s;
    }
    steps_.say("trying smaller voxels, because " + open + "\n");
    tried_.push_back({{"voxel_size_m", size_m}, {"open", open}});
    size_m = next_m;
  }
  if (kept_) {
    if (Status s = restore_answer(); !s) return s;
  } else {
    voxel_size_ = size_option(look_->voxel_size_m);
    if (Status s = answer(); !s) return s;
  }
  return keep_size(key, inputs, installed);
}

// Remembers the size for the next study of the same inputs.
Status Study::keep_size(const std::string& key, const std::vector<std::string>& inputs,
                        const json& installed) {
  return steps_.keep(key, inputs,
                     {{"voxel_size", voxel_size_},
                      {"is_deep", is_deep_},
                      {"tried", tried_},
                      {"no_finer", no_finer_},
                      {"installed", installed},
                      {"seconds", seconds_},
                      {"first_m", choice_.first_m},
                      {"last_m", choice_.last_m},
                      {"why_first", choice_.why_first},
                      {"why_last", choice_.why_last}});
}

// With files of one voxel size. Where the part overlaps a neighbor by more than is usually stored,
// with others.
Status Study::answer() {
  Status made = answer_once();
  if (made || !is_too_deep_) return made;
  is_deep_ = true;
  return answer_once();
}

// All steps with the same files.
Status Study::answer_once() {
  steps_.forget_lines();
  is_checked_ = false;
  if (Status s = bake(); !s) return s;
  if (Status s = draw(); !s) return s;
  if (Status s = find_path(); !s) return s;
  return check();
}

// Why smaller voxels may give another answer; empty where they cannot.
std::string Study::open_answer() const {
  using command::VerdictKind;
  const json violations = answer_.checked.is_object()
                              ? answer_.checked.value("violations", json::array())
                              : json::array();
  switch (answer_.verdict.kind) {
    case VerdictKind::kNoPathFound:
      return "no path was found";
    case VerdictKind::kTooCloseToCall: {
      // STEP surfaces get finer triangles; of other meshes only rounding is left.
      const json exact = answer_.checked.value("exact", json::object());
      const bool helps = exact.value("deviations_and_rounding_m", 0.0) > 1e-6;
      return helps ? "the verdict was 'too close to call'" : "";
    }
    case VerdictKind::kUndecided:
      for (const json& violation : violations) {
        // Smaller voxels close no mesh, and give no time.
        const bool stays_open =
            violation.value("seat_not_settled", false) || violation.value("out_of_time", false);
        if (!stays_open) return "the answer was undecided";
      }
      return "";
    case VerdictKind::kDoesNotComeOut: {
      if (!options_.files_alone) return "";  // the meshes have settled it
      // So deep the stored distances of a part that slides along its seat may err.
      double depth_m = 0;
      for (const json& violation : violations) {
        depth_m = std::max(depth_m, violation.value("depth_m", 0.0));
      }
      const bool helps = depth_m > 0 && depth_m < *command::parse_length(voxel_size_);
      return helps ? "the part goes less than a voxel too deep into its seat" : "";
    }
    default:
      return "";
  }
}

// Whether the bakes of smaller voxels leave half of the time for the search and the check. Meshes
// are read in much the same time whatever the voxels. A forecast is for one core, and of any
// machine: what was measured here tells more.
bool Study::has_time_for(double voxel_size_m) const {
  double bakes_s = 0;
  for (const char* const name : kBakeReports) {
    const json report = read_json(in(name));
    if (!report.is_object() || !report.contains("seconds")) continue;
    const double read_s = report["seconds"]["read"], total_s = report["seconds"]["total"];
    const SizeCost last{.voxel_size_m = report["voxel_size_m"], .thread_s = total_s - read_s};
    bakes_s += read_s + cost_at(last, voxel_size_m).thread_s;
  }
  return bakes_s + kCheckReadings * reading_s() <= left_s() / 2;
}

// Whether the time was over before there was an answer.
bool Study::is_out_of_time() const {
  const json violations = answer_.checked.is_object()
                              ? answer_.checked.value("violations", json::array())
                              : json::array();
  return answer_.verdict.kind == command::VerdictKind::kUndecided &&
         std::any_of(violations.begin(), violations.end(),
                     [](const json& violation) { return violation.value("out_of_time", false); });
}

// That of the check, where it has one: its voxels are smaller, and so are the triangles of STEP
// surfaces.
Play Study::measured_play() const {
  const bool is_checked = !options_.files_alone && answer_.checked.is_object() &&
                          !answer_.checked.value("seat_depths", json::array()).empty();
  return is_checked ? play_of(answer_.checked) : play_;
}

nlohmann::ordered_json Study::play_json() const {
  const Play play = measured_play();
  if (!play.is_measured) return nullptr;
  const bool any = !play.object.empty();
  return {{"smallest_m", any ? json(play.play_m) : json()},
          {"object", any ? json(play.object) : json()},
          {"in_contact_with", play.touched}};
}

// Notes how long a step took: now, or the last time where it is unchanged.
void Study::add_seconds(const Step& step, const StepEnd& end) {
  const std::string& program = step.program;
  const char* const kind = program == "voxcheck"                              ? "checks"
                           : program == "voxplan" || program == "voxrun"      ? "search"
                           : program == "voxelize" || program == "pointshell" ? "bakes"
                                                                              : "pictures";
  seconds_[kind] += end.seconds;
}

// "time: 12.3 of 60 s (bakes 5.1 s, checks 3 s, search 4.2 s)".
std::string Study::seconds_text() const {
  double total_s = 0;
  std::string kinds;
  for (const auto& [kind, seconds] : seconds_) {
    total_s += seconds;
    kinds += (kinds.empty() ? "" : ", ") + kind + command::text(" %.3g s", seconds);
  }
  return command::text("time: %.3g of %.4g s (", total_s, allowed_s_) + kinds + ")" +
         (options_.time.empty() ? "; --time changes the limit" : "");
}

// Lines behind the sentence: the voxels that were chosen, and why.
void Study::note_voxel_size() {
  const double size_m = *command::parse_length(voxel_size_);
  std::string line = "voxels of " + command::length_text(size_m);
  if (no_finer_.starts_with(kSmallerOnes)) {
    line += "; " + no_finer_;
  } else if (!no_finer_.empty()) {
    // Where the meshes have settled the answer, smaller voxels would not change it.
    const bool matters = options_.files_alone || !open_answer().empty();
    line += ", the smallest that gave an answer" + (matters ? "; " + no_finer_ : "");
  } else if (tried_.empty()) {
    line += ", chosen: " + choice_.why_first;
  } else {
    line += ", refined from " + command::length_text(tried_.front()["voxel_size_m"]) + ": " +
            tried_.back()["open"].get<std::string>();
  }
  answer_.text += "  " + play_text(measured_play()) + "\n  " + line + "\n";
  if (open_answer().empty() || !no_finer_.empty()) return;
  const std::string smallest = command::length_text(choice_.last_m) + ": " + choice_.why_last;
  const bool is_no = answer_.verdict.kind == command::VerdictKind::kDoesNotComeOut ||
                     answer_.verdict.kind == command::VerdictKind::kNoPathFound;
  answer_.text +=
      is_no ? "  smaller voxels might change the answer; none are smaller than " + smallest + "\n"
            : "  the answer is still open at the smallest size, " + smallest + "\n";
}

// The sizes from the first that is chosen to the last that would be tried.
Status Study::plan() const {
  SizeChoice choice = choice_;
  if (!options_.is_auto()) {
    choice.first_m = look_->voxel_size_m;
    choice.last_m = std::min(choice.last_m, choice.first_m);
    choice.why_first = "given with --voxel-size";
  }
  const auto sizes = sizes_of(choice, *look_);
  const std::string words = play_text(play_) + "\nvoxels of " +
                            command::length_text(choice.first_m) + ", chosen: " + choice.why_first +
                            "\nsmallest size " + command::length_text(choice.last_m) + ": " +
                            choice.why_last + "\n";
  if (!options_.quiet) std::fputs((table_of(sizes) + words).c_str(), stdout);
  if (options_.json.empty()) return {};
  nlohmann::ordered_json report;
  for (const SizeCost& size : sizes) {
    report["plan"].push_back({{"voxel_size_m", size.voxel_size_m},
                              {"fits_down_to_m", size.fits_m},
                              {"points", std::round(size.points)},
                              {"bytes", std::round(size.bytes)},
                              {"thread_s", size.thread_s}});
  }
  report["play"] = play_json();
  report["words"] = words;
  return command::write_report(options_.json, report);
}

Status Study::write_bare_page(const command::Verdict& verdict) const {
  Page page;
  page.part = options_.node;
  page.assembly = std::filesystem::path(options_.assembly).filename().string();
  page.kind = verdict.kind;
  page.heading = command::heading(verdict);
  page.text = command::terminal_text(verdict);
  for (const auto& line : steps_.lines()) page.commands.push_back(line.command);
  const auto html = html_of(page);
  if (!html) return html.error();
  return command::write_text(in("report.html"), *html);
}

Status Study::write_page() {
  Page page;
  page.part = options_.node;
  page.assembly = std::filesystem::path(options_.assembly).filename().string();
  page.kind = answer_.verdict.kind;
  page.heading = answer_.heading;
  page.text = answer_.text;
  page.report = answer_.checked;
  page.scene = read_json(in("scene.json"));
  page.shell = read_json(in("part.json"));
  page.files = {in("scene.vox"), in("part.pshell"), in("verdict.json")};
  if (!answer_.path.empty()) {
    auto svg = curve_svg(in("curve.csv"), page.report);
    if (!svg) return svg.error();
    page.curve_svg = std::move(*svg);
    if (Status s = command::write_text(in("curve.svg"), page.curve_svg); !s) return s;
    page.files.insert(page.files.end(), {answer_.path, in("curve.csv")});
    page.curve = in("curve.csv");
    if (!options_.files_alone) {
      page.motion = in("motion.glb");
      if (!does_turn(answer_.path)) page.map = in("clearance.glb");
    }
    if (answer_.draws) page.pictures.push_back({in("worst.png"), "The worst moment"});
  }
  if (answer_.path.empty() && std::filesystem::exists(in("farthest.csv"))) {
    page.files.push_back(in("farthest.csv"));
  }
  if (answer_.draws) {
    page.pictures.push_back({in("installed.png"), "Where the part is installed"});
  }
  for (const auto& line : steps_.lines()) page.commands.push_back(line.command);
  const auto html = html_of(page);
  if (!html) return html.error();
  if (Status written = command::write_text(in("report.html"), *html); !written) return written;
  if (!options_.quiet) {
    std::fputs(answer_.text.c_str(), stdout);
    std::printf("%s\n", escaped(in("report.html")).c_str());
  }
  return {};
}

Status Study::report(int status) const {
  if (options_.json.empty()) return {};
  nlohmann::ordered_json report;
  if (status != 0) report["exit_status"] = status;
  report.update(command::verdict_json(answer_.verdict));
  report["heading"] = answer_.heading;
  report["sentence"] = answer_.sentence;
  report["words"] = answer_.text;
  report["page"] = in("report.html");
  report["path"] = answer_.path.empty() ? json() : json(answer_.path);
  if (!answer_.path.empty()) report["blocked_by"] = answer_.checked["blocked_by"];
  report["check"] = answer_.checked;
  const auto voxel_m = command::parse_length(voxel_size_);
  report["voxel_size_m"] = voxel_m ? json(*voxel_m) : json();
  if (options_.is_auto() && choice_.first_m > 0) {
    report["voxel_size_why"] = !no_finer_.empty() ? json(no_finer_)
                               : tried_.empty()   ? json(choice_.why_first)
                                                  : tried_.back()["open"];
    report["voxel_sizes_tried"] = tried_;
    report["smallest_voxel_size_m"] = choice_.last_m;
    report["play"] = play_json();
  }
  report["seconds"] = seconds_;
  for (const auto& line : steps_.lines()) {
    report["steps"].push_back(
        {{"command", line.command}, {"status", line.status}, {"unchanged", line.again}});
  }
  return command::write_report(options_.json, report);
}

// The way on where the answer is open.
std::string Study::advice() const {
  if (answer_.path.empty()) {
    if (answer_.verdict.kind == command::VerdictKind::kDoesNotComeOut) return "";
    // Where the search gave up, more time would change nothing.
    const json plan = read_json(in("plan.json"));
    const bool is_out_of_time = plan.is_object() && plan.value("out_of_time", false);
    return "this does not prove that there is no path: try " +
           std::string(is_out_of_time ? "a longer --time, " : "") +
           "a smaller --clearance or --voxel-size, or give your own path with --path or --pull";
  }
  if (command::passes(answer_.verdict.kind)) return command::kOverlapAdvice;
  if (answer_.verdict.kind != command::VerdictKind::kUndecided) return "";
  const json violations = answer_.checked.value("violations", json::array());
  if (violations.empty()) return command::kCracksAdvice;
  const auto any = [&](const char* key) {
    return std::any_of(violations.begin(), violations.end(),
                       [&](const json& violation) { return violation.value(key, false); });
  };
  if (any("out_of_time")) return "give a longer --time";
  if (options_.files_alone) return kMeshesHelp;
  if (any("seat_not_settled"))
    return "close all open edges of one of the two meshes, and repeat the study";
  return "";
}

Status Study::judge() const {
  if (command::is_yes(answer_.verdict.kind)) return {};
  std::string mend = advice();
  if (!answer_.path.empty()) mend += (mend.empty() ? "" : "; ") + ("see " + in("report.html"));
  return Error{command::error_code(answer_.verdict.kind), options_.assembly, options_.node,
               bare_sentence(answer_.sentence), mend};
}

// The answer is not known: the page says why, in the words of the command that failed.
void Study::say_that_it_failed(const Error& error) {
  // Nothing is said of an input that is not there, unless the folder says something else.
  if (steps_.lines().empty() && !std::filesystem::exists(in("report.html"))) return;
  answer_.path.clear();
  answer_.checked = nullptr;
  answer_.verdict = unfinished(failure_.empty() ? to_line(error) : failure_);
  const int stopped = command::stop_signal();
  const int status = stopped != 0 ? 128 + stopped : exit_status(error.code);
  const bool is_refused =
      status >= exit_status(ErrorCode::kUsage) && status <= exit_status(ErrorCode::kNotThisFormat);
  if (is_refused) answer_.verdict.kind = command::VerdictKind::kRefused;
  const Error told{error.code, "", "", bare_sentence(command::sentence(answer_.verdict)), ""};
  if (!options_.quiet) std::fputs(command::terminal_text(answer_.verdict).c_str(), stdout);
  Status written = write_verdict(command::junit_text(subject(), told), status);
  if (written) written = write_bare_page(answer_.verdict);
  if (written) written = report(status);
  if (written) return;
  // No answer is better than one that is not true.
  for (const std::string& file : question().outputs) std::remove(file.c_str());
}

Status Study::make() {
  is_known_ = !options_.plan && steps_.is_known(question());
  const Status made = make_all();
  if (!made && !options_.plan && !command::is_answer(made.error().code)) {
    say_that_it_failed(made.error());
  }
  return made;
}

Status Study::make_all() {
  if (!options_.path.empty()) {  // before minutes of baking
    const auto path = FileBytes::read(options_.path);
    if (!path) return path.error();
    const bool is_recording = std::ranges::find(path->bytes(), std::byte{0}) != path->bytes().end();
    if (const auto rows = read_path(options_.path, PathOf::kPart); !is_recording && !rows) {
      return rows.error();
    }
  }
  if (options_.plan) {
    const auto looked = look();
    if (!looked) return looked.error();
    take_look(*looked);
    return plan();
  }
  if (Status s = options_.is_auto() ? choose_voxel_size() : answer(); !s) return s;
  if (options_.is_auto()) note_voxel_size();
  answer_.text += "  " + seconds_text() + "\n";
  if (Status s = command::write_text(in("verdict.txt"), answer_.text); !s) return s;
  if (Status s = report(); !s) return s;
  if (Status s = write_page(); !s) return s;
  if (command::stop_signal() != 0) return judge();  // the answer of an unfinished study
  if (Status s = steps_.remember(question()); !s) return s;
  return judge();
}

// The folder, locked for as long as this lives: two studies at once would mix their files. The
// system lets it go however this program ends, and nothing is written. A file system that knows no
// such lock refuses nobody.
Result<Descriptor> lock_folder(const std::string& folder) {
  Descriptor locked(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (locked.valid() && ::flock(locked.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return Error{ErrorCode::kWriteFailed, folder, "--output",
                 "another study is writing to this folder",
                 "wait until it has ended, or name another folder"};
  }
  return locked;
}

// A plan whose files nobody asked for.
Status measure_only(Options options) {
  std::error_code failure;
  const auto place = std::filesystem::temp_directory_path(failure) / "forcelayer-XXXXXX";
  options.folder = place.string();
  if (failure || mkdtemp(options.folder.data()) == nullptr) {
    return Error{ErrorCode::kWriteFailed, options.folder, "--plan", "no folder can be made here",
                 "set TMPDIR to a folder that can be written to, or add -o"};
  }
  const Status made = make_study(options);
  std::filesystem::remove_all(options.folder, failure);
  return made;
}

}  // namespace

Status make_study(const Options& options) {
  std::error_code failure;
  if (options.folder.empty()) return measure_only(options);
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
