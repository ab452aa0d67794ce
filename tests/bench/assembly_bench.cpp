// Assembly tasks that others can run with their own renderer (assembly.md):
//
//   assembly_bench peg [SEEDS]      a peg into a hole, by clearance, chamfer and tilt
//   assembly_bench nut [SEEDS]      a nut turned and pulled on an M20 thread, by play
//   assembly_bench scans [SEEDS]    scans that fly at each other: contacts that are missed
//   assembly_bench meshes FOLDER    the meshes of the first two, as OBJ files in millimeters
//
// --short makes fewer of each. Seeds run from 1. --json FILE writes the report elsewhere.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <stdexcept>

#include "formats/guard.h"
#include "formats/mesh/scene.h"
#include "runtime/coupling/coupling.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/run/separation.h"
#include "tests/bench/assembly_bench_meshes.h"
#include "tests/bench/bench_report.h"
#include "tests/stress/exact_distance.h"
#include "tests/stress/shapes.h"
#include "tests/stress/trial.h"
#include "tests/support/models.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;
using stress::BakedPart;
using stress::BakedScene;
using test::Random;
using test::random_direction;
using test::uniform;

constexpr double kDtS = 1e-3;

struct Choice {
  std::string what, folder, json;
  int seeds = 0;  // 0: as the task has it
  bool brief = false;

  int seeds_or(int usual, int few) const { return seeds > 0 ? seeds : brief ? few : usual; }
};

// A scene stands anywhere on the grid, turned at random.
Pose random_frame(Random& random) {
  const glm::dvec3 origin(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1));
  return {origin, coupling::rotation_by(random_direction(random) * uniform(random, 0, M_PI))};
}

mesh::Mesh moved(const mesh::Mesh& mesh, const Pose& pose) {
  mesh::Mesh result;
  result.single_precision = false;
  stress::append(result, mesh, pose);
  return result;
}

double guaranteed_m(const model::Simulation& simulation) {
  const VoxmapHeader& scene = simulation.voxmap().header();
  const DistanceGuard guard{guard_distance_m(scene), simulation.shell().surface_distance_terms()};
  return separation_guarantee(scene, simulation.shell().header(),
                              simulation.query().rounding_bound_m(), guard)
      .tested_m.value_or(0);
}

// Clopper and Pearson's interval of a share, by bisection of the binomial's tails.
std::pair<double, double> share_95(int events, int of) {
  const auto at_most = [of](int k, double p) {
    double sum = 0, term = std::pow(1 - p, of);
    for (int i = 0; i <= k; ++i) {
      sum += term;
      term *= p / (1 - p) * (of - i) / (i + 1);
    }
    return sum;
  };
  const auto where = [&](int k, double tail) {
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
      const double middle = (low + high) / 2;
      (at_most(k, middle) > tail ? low : high) = middle;
    }
    return low;
  };
  return {events == 0 ? 0 : where(events - 1, 0.975), events == of ? 1 : where(events, 0.025)};
}

// --- the peg

constexpr double kPegVoxelM = 0.0002, kStandoffVoxels = 1.3;
constexpr double kMissM = 0.001, kAboveM = 0.003, kDeepM = 0.018, kInM = 0.015;

// The hand draws the peg down with its tip aside of the axis and the peg aslant, and does not mend
// either: what guides the peg is the hole.
stress::Trial peg_trial(double clearance_m, double chamfer_m, double tilt_deg, double standoff_m,
                        const std::shared_ptr<const BakedPart>& part, int seed) {
  Random random(static_cast<std::uint64_t>(seed));
  const Pose frame = random_frame(random);
  const double toward = uniform(random, 0, 2 * M_PI), miss = uniform(random, 0, kMissM);
  const double about = uniform(random, 0, 2 * M_PI);
  const glm::dvec3 aside = miss * glm::dvec3(std::cos(toward), std::sin(toward), 0);
  const glm::dquat aslant = coupling::rotation_by(tilt_deg * M_PI / 180 *
                                                  glm::dvec3(std::cos(about), std::sin(about), 0));
  stress::Trial trial;
  trial.scene = std::make_shared<BakedScene>(moved(plate_with_hole(clearance_m, chamfer_m), frame),
                                             kPegVoxelM, standoff_m);
  trial.part = part;
  trial.hand.emplace();
  trial.duration_s = 0.8;
  trial.slide_from_s = 0;
  trial.slide_direction = frame.orientation * glm::dvec3(0, 0, -1);
  trial.target = [=](double t) {
    const double depth = std::min(kDeepM, -kAboveM + 0.04 * t);
    const glm::dvec3 tip = aside + glm::dvec3(0, 0, -depth);
    return frame * Pose{tip + aslant * glm::dvec3(0, 0, kPegLengthM / 2), aslant};
  };
  trial.start = trial.target(0);
  return trial;
}

Json peg_table(const Choice& choice) {
  const std::vector<double> clearances_mm =
      choice.brief ? std::vector{0.6, 1.2} : std::vector{0.3, 0.5, 0.6, 0.8, 1.2, 1.6};
  const std::vector<double> chamfers_mm =
      choice.brief ? std::vector{0.0, 1.0} : std::vector{0.0, 0.5, 1.0, 2.0};
  const std::vector<double> tilts_deg =
      choice.brief ? std::vector{0.0, 2.0} : std::vector{0.0, 2.0, 4.0};
  const int seeds = choice.seeds_or(20, 2);
  const auto part = std::make_shared<const BakedPart>(peg(), kPegVoxelM);
  Json rows = Json::array();
  for (const double standoff : {0.0, kStandoffVoxels}) {
    for (const double clearance_mm : clearances_mm) {
      for (const double chamfer_mm : chamfers_mm) {
        for (const double tilt_deg : tilts_deg) {
          stress::Metrics sum;
          int in = 0;
          for (int seed = 1; seed <= seeds; ++seed) {
            stress::Trial trial = peg_trial(clearance_mm * 1e-3, chamfer_mm * 1e-3, tilt_deg,
                                            standoff * kPegVoxelM, part, seed);
            trial.exact_distance = seed == 1 && tilt_deg == tilts_deg.back();  // seconds each
            const stress::Metrics m = stress::run(trial, Model::kDefault);
            in += !m.progress.empty() && m.progress[0] * (kDeepM + kAboveM) > kInM + kAboveM;
            sum.add(m);
          }
          const auto [low, high] = share_95(in, seeds);
          rows.push_back({{"map", standoff > 0 ? "standoff 1.3" : "two layers"},
                          {"voxel_m", kPegVoxelM},
                          {"clearance_m", clearance_mm * 1e-3},
                          {"chamfer_m", chamfer_mm * 1e-3},
                          {"tilt_deg", tilt_deg},
                          {"trials", seeds},
                          {"in", in},
                          {"in_95_low", low},
                          {"in_95_high", high},
                          {"frames", sum.frames},
                          {"penetrating_frames", sum.penetration_frames},
                          {"nearest_m", sum.distances_visited > 0 ? Json(sum.smallest_distance_m)
                                                                  : Json(nullptr)},
                          {"guaranteed_m", sum.guaranteed_m}});
          std::printf(
              "peg: %-12s clearance %.1f mm chamfer %.1f mm tilt %g deg: %d of %d in, %llu "
              "penetrating, proven %.3f mm\n",
              standoff > 0 ? "standoff 1.3" : "two layers", clearance_mm, chamfer_mm, tilt_deg, in,
              seeds, static_cast<unsigned long long>(sum.penetration_frames),
              1e3 * sum.guaranteed_m);
          std::fflush(stdout);
        }
      }
    }
  }
  return rows;
}

// --- the nut

struct NutRow {
  double play_m, voxel_m, standoff_voxels;
};
constexpr NutRow kNutRows[] = {{0.0012, 0.0001, 0},
                               {0.0008, 0.0001, 0},
                               {0.0008, 0.0001, 1.3},
                               {0.0006, 0.0001, 1.3},
                               {0.000436, 0.000075, 1.3}};

constexpr int kJudgedEvery = 150;  // frames: between threads an exact distance takes a second

struct Screwed {
  double turned_rad = 0, advance_m = 0;
  std::uint64_t frames = 0, penetrating = 0;
  double nearest_m = 1e300, guaranteed_m = 0;
  std::vector<double> step_us;  // of processor time
  bool starts_inside = false;   // the guard bars the start: nothing was simulated
};

// A hand on the nut wants what `wanted` says, in the bolt's frame.
template <class Wanted>
Screwed screw(const stress::Trial& trial, const Pose& frame, double seconds, const Wanted& wanted) {
  const auto simulation = stress::make_simulation(trial, Model::kDefault);
  const stress::ExactDistance exact(trial.scene->mesh(), trial.part->mesh());
  devices::SimHand hand({}, frame);
  State state = simulation->registered(frame, frame);
  Screwed out;
  out.guaranteed_m = guaranteed_m(*simulation);
  loop::HandleVelocity velocity;
  Wrench felt;
  Pose last;
  for (int i = 0; i < static_cast<int>(seconds / kDtS); ++i) {
    StepInput input;
    input.world_from_handle = hand.step(frame * wanted(i * kDtS), felt, kDtS);
    input.handle_velocity = velocity.update(input.world_from_handle, kDtS);
    input.valid = kInputValid;
    const double before_s = cpu_s();
    const StepResult result = simulation->step(state, input, kDtS);
    out.step_us.push_back(1e6 * (cpu_s() - before_s));
    if (i == 0 && result.report.interior > 0) {
      out.starts_inside = true;
      return out;
    }
    felt = result.at_handle;
    ++out.frames;
    out.penetrating += result.report.interior > 0;
    const Pose at = simulation->world_from_part(result.report.world_from_center);
    if (i % kJudgedEvery == 0) out.nearest_m = std::min(out.nearest_m, exact.at(at, out.nearest_m));
    const Pose in_bolt = inverse(frame) * at;
    out.turned_rad +=
        coupling::rotation_vector(in_bolt.orientation * glm::conjugate(last.orientation)).z;
    out.advance_m = in_bolt.position_m.z;
    last = in_bolt;
  }
  return out;
}

Json nut_table(const Choice& choice) {
  Json rows = Json::array();
  const int seeds = choice.seeds_or(8, 1);
  for (const NutRow& row : kNutRows) {
    if (choice.brief && row.play_m != 0.0012) continue;
    const auto part = std::make_shared<const BakedPart>(nut(row.play_m), row.voxel_m);
    int turned = 0, held = 0, refused = 0;
    std::vector<double> lead, pulled_m;
    Screwed sum;
    for (int seed = 1; seed <= seeds; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Pose frame = random_frame(random);
      stress::Trial trial;
      trial.scene = std::make_shared<BakedScene>(moved(bolt(), frame), row.voxel_m,
                                                 row.standoff_voxels * row.voxel_m);
      trial.part = part;
      trial.voxels = test::VoxelKind::kFull;
      // Half a turn in half a second, without a pull along the axis: the thread leads the nut.
      const Screwed turn = screw(trial, frame, 0.6, [](double t) {
        return Pose{glm::dvec3(0), coupling::rotation_by({0, 0, 2 * M_PI * std::min(t, 0.5)})};
      });
      if (turn.starts_inside) {
        ++refused;
        sum.guaranteed_m = turn.guaranteed_m;
        continue;
      }
      // As hard along the axis as hand and device can, without a turn.
      const Screwed pull = screw(trial, frame, 0.3, [](double t) {
        return Pose{glm::dvec3(0, 0, 0.1 * std::min(1.0, t / 0.2)), {1, 0, 0, 0}};
      });
      const double turns = turn.turned_rad / (2 * M_PI);
      turned += turns > 0.475;
      held += std::abs(pull.advance_m) < kPitchM / 2;
      if (turns > 0.1) lead.push_back(turn.advance_m / turns / kPitchM);
      pulled_m.push_back(std::abs(pull.advance_m));
      for (const Screwed& one : {turn, pull}) {
        sum.frames += one.frames, sum.penetrating += one.penetrating;
        sum.nearest_m = std::min(sum.nearest_m, one.nearest_m);
        sum.guaranteed_m = one.guaranteed_m;
        sum.step_us.insert(sum.step_us.end(), one.step_us.begin(), one.step_us.end());
      }
    }
    const auto [low, high] = share_95(turned, seeds);
    const double median_lead = lead.empty() ? NAN : percentiles(lead).p50;
    rows.push_back(
        {{"map", row.standoff_voxels > 0 ? "standoff 1.3" : "two layers"},
         {"voxel_m", row.voxel_m},
         {"play_m", row.play_m},
         {"room_voxels", row.play_m / 2 / row.voxel_m},
         {"points", part->open().header().point_count},
         {"trials", seeds},
         {"starts_inside", refused},
         {"turned", turned},
         {"turned_95_low", low},
         {"turned_95_high", high},
         {"lead_pitches", lead.empty() ? Json(nullptr) : Json(median_lead)},
         {"held", held},
         {"pulled_m", pulled_m.empty() ? Json(nullptr) : Json(percentiles(pulled_m).max)},
         {"frames", sum.frames},
         {"frame_p50_us", sum.step_us.empty() ? Json(nullptr) : Json(percentiles(sum.step_us).p50)},
         {"penetrating_frames", sum.penetrating},
         {"nearest_m", sum.frames > 0 ? Json(sum.nearest_m) : Json(nullptr)},
         {"guaranteed_m", sum.guaranteed_m}});
    if (sum.frames == 0) {
      std::printf("nut: voxel %.3f mm play %.3f mm: the start is inside\n", 1e3 * row.voxel_m,
                  1e3 * row.play_m);
      continue;
    }
    std::printf(
        "nut: %-12s voxel %.3f mm play %.3f mm (%.1f voxels): %d of %d turned, %.3f pitches "
        "a turn, %d held within %.3f mm, %llu penetrating, nearest %.4f mm, proven %.4f mm; frame "
        "%.0f us\n",
        row.standoff_voxels > 0 ? "standoff 1.3" : "two layers", 1e3 * row.voxel_m,
        1e3 * row.play_m, row.play_m / 2 / row.voxel_m, turned, seeds, median_lead, held,
        1e3 * percentiles(pulled_m).max, static_cast<unsigned long long>(sum.penetrating),
        1e3 * sum.nearest_m, 1e3 * sum.guaranteed_m, percentiles(sum.step_us).p50);
    std::fflush(stdout);
  }
  return rows;
}

// --- the scans

constexpr double kScanVoxelM = 0.002, kSceneM = 0.3, kPartM = 0.06, kRunUpM = 0.3;
constexpr double kSpeedsMps[] = {0.2, 1, 5, 20};

// A scan about the middle of its box, so large across.
mesh::Mesh scan(const char* file, double across_m) {
  const auto assembly = mesh::read_assembly(test::model_path(file));
  if (!assembly) throw std::runtime_error(to_line(assembly.error()));
  mesh::Mesh mesh = assembly->meshes.at(0);
  mesh.single_precision = false;
  glm::dvec3 low(1e300), high(-1e300);
  for (const auto& v : mesh.vertices) {
    low = glm::min(low, {v[0], v[1], v[2]}), high = glm::max(high, {v[0], v[1], v[2]});
  }
  const glm::dvec3 size = high - low, middle = (low + high) / 2.0;
  const double scale = across_m / std::max({size.x, size.y, size.z});
  for (auto& v : mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) v[axis] = (v[axis] - middle[axis]) * scale;
  }
  return mesh;
}

// Whether the exact meshes meet, at every pose of a path; a pose is measured unless the part cannot
// have come that far since the last that was.
class Meeting {
 public:
  Meeting(const stress::ExactDistance& exact, double radius_m)
      : exact_(exact), radius_m_(radius_m) {}
  bool at(const Pose& pose) {
    if (known_) {
      at_least_m_ -= glm::length(pose.position_m - last_.position_m) +
                     radius_m_ * glm::length(coupling::rotation_vector(
                                     pose.orientation * glm::conjugate(last_.orientation)));
    }
    last_ = pose;
    if (known_ && at_least_m_ > 0) return false;
    known_ = true;
    at_least_m_ = exact_.at(pose, kFarM);
    nearest_m = std::min(nearest_m, at_least_m_);
    return at_least_m_ <= 0;
  }
  double nearest_m = 1e300;  // of those that were measured; kFarM or less

 private:
  static constexpr double kFarM = 0.005;
  const stress::ExactDistance& exact_;
  double radius_m_, at_least_m_ = 0;
  Pose last_;
  bool known_ = false;
};

// The counts of one way of moving.
struct Flight {
  std::uint64_t poses = 0, reported = 0;  // reported: with a point in value 2 or 1
  std::uint64_t meeting = 0, missed = 0;  // of the exact meshes; not reported
  double nearest_m = 1e300, guaranteed_m = 0;
  void count(bool meets, bool reports) {
    ++poses;
    reported += reports, meeting += meets, missed += meets && !reports;
  }
};

// Straight through a point near the scene's middle at a speed, turning on the way.
struct Throw {
  Pose from;
  glm::dvec3 along, spin_rad_per_s;
  double speed_mps;
  Pose at(double t_s) const {
    return {from.position_m + along * (speed_mps * t_s),
            coupling::rotation_by(spin_rad_per_s * t_s) * from.orientation};
  }
};

Throw random_throw(Random& random, double speed_mps) {
  Throw one;
  one.along = random_direction(random);
  const glm::dvec3 through = 0.25 * kSceneM * uniform(random, 0, 1) * random_direction(random);
  one.from = {through - kRunUpM * one.along,
              coupling::rotation_by(random_direction(random) * uniform(random, 0, M_PI))};
  one.spin_rad_per_s = random_direction(random) * (uniform(random, 0, M_PI) * speed_mps / kRunUpM);
  one.speed_mps = speed_mps;
  return one;
}

// The query at the handle's own poses, whatever a model makes of them.
void fly_freely(const stress::Trial& trial, const Throw& one, Meeting meeting, Flight& out) {
  const Voxmap voxmap = trial.scene->open(test::VoxelKind::kFull);
  const Pshell shell = trial.part->open();
  query::ContactQuery query(voxmap, shell, {});
  query::CollectedPoints points;
  points.reserve(shell.view().point_count);
  const auto& c = shell.header().center_m;
  const Pose part_from_center{{c[0], c[1], c[2]}, {1, 0, 0, 0}};
  for (double t = 0; t < 2 * kRunUpM / one.speed_mps; t += kDtS) {
    const Pose pose = one.at(t);
    query.run(pose * part_from_center, points);
    out.count(meeting.at(pose), points.surface_count + points.interior_count > 0);
  }
  out.nearest_m = std::min(out.nearest_m, meeting.nearest_m);
}

// The part of a model whose handle flies like that.
void fly_held(const stress::Trial& trial, Model model, const Throw& one, Meeting meeting,
              Flight& out) {
  const auto simulation = stress::make_simulation(trial, model);
  State state = simulation->registered(one.from, one.from);
  loop::HandleVelocity velocity;
  if (model == Model::kDefault) out.guaranteed_m = guaranteed_m(*simulation);
  for (double t = 0; t < 2 * kRunUpM / one.speed_mps + 0.05; t += kDtS) {
    StepInput input;
    input.world_from_handle = one.at(std::min(t, 2 * kRunUpM / one.speed_mps));
    input.handle_velocity = velocity.update(input.world_from_handle, kDtS);
    input.valid = kInputValid;
    const StepResult result = simulation->step(state, input, kDtS);
    const Pose at = simulation->world_from_part(result.report.world_from_center);
    out.count(meeting.at(at), result.report.surface + result.report.interior > 0);
  }
  out.nearest_m = std::min(out.nearest_m, meeting.nearest_m);
}

Json scan_table(const Choice& choice) {
  stress::Trial trial;
  trial.scene = std::make_shared<BakedScene>(scan("dragon.drc", kSceneM), kScanVoxelM);
  trial.part = std::make_shared<BakedPart>(scan("bunny.drc", kPartM), kScanVoxelM);
  const stress::ExactDistance exact(trial.scene->mesh(), trial.part->mesh());
  const double radius_m = stress::radius_m(trial.part->mesh());
  const int seeds = choice.seeds_or(20, 2);
  Json rows = Json::array();
  for (const double speed_mps : kSpeedsMps) {
    std::map<std::string, Flight> flights;
    for (int seed = 1; seed <= seeds; ++seed) {
      Random random(static_cast<std::uint64_t>(seed));
      const Throw one = random_throw(random, speed_mps);
      const Meeting meeting(exact, radius_m);
      fly_freely(trial, one, meeting, flights["the handle's poses"]);
      fly_held(trial, Model::kPaper, one, meeting, flights["held by `paper`"]);
      fly_held(trial, Model::kDefault, one, meeting, flights["held by `default`"]);
    }
    for (const auto& [way, f] : flights) {
      const stress::Interval of_missed =
          stress::interval95(f.missed, std::max<std::uint64_t>(1, f.meeting));
      const stress::Interval of_meeting =
          stress::interval95(f.meeting, std::max<std::uint64_t>(1, f.poses));
      rows.push_back({{"speed_mps", speed_mps},
                      {"way", way},
                      {"trials", seeds},
                      {"poses", f.poses},
                      {"reported", f.reported},
                      {"meeting", f.meeting},
                      {"meeting_95_high", of_meeting.high},
                      {"missed", f.missed},
                      {"missed_95_high", f.meeting > 0 ? Json(of_missed.high) : Json(nullptr)},
                      {"nearest_m", f.nearest_m},
                      {"guaranteed_m", f.guaranteed_m}});
      std::printf(
          "scans: %4g m/s %-20s %llu poses, %llu reported, meshes meet in %llu, missed %llu, "
          "nearest %.3f mm, proven %.3f mm\n",
          speed_mps, way.c_str(), static_cast<unsigned long long>(f.poses),
          static_cast<unsigned long long>(f.reported), static_cast<unsigned long long>(f.meeting),
          static_cast<unsigned long long>(f.missed), 1e3 * f.nearest_m, 1e3 * f.guaranteed_m);
      std::fflush(stdout);
    }
  }
  return rows;
}

void write_meshes(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_obj(peg(), folder / "peg.obj");
  for (const int clearance_um : {300, 500, 600, 800, 1200, 1600}) {
    for (const int chamfer_um : {0, 500, 1000, 2000}) {
      write_obj(plate_with_hole(1e-6 * clearance_um, 1e-6 * chamfer_um),
                folder / ("plate_" + std::to_string(clearance_um) + "um_chamfer_" +
                          std::to_string(chamfer_um) + "um.obj"));
    }
  }
  write_obj(bolt(), folder / "bolt_m20.obj");
  for (const NutRow& row : kNutRows) {
    write_obj(nut(row.play_m),
              folder / ("nut_m20_" + std::to_string(std::lround(1e6 * row.play_m)) + "um.obj"));
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Assembly tasks that others can run", "assembly_bench"};
  Choice choice;
  std::string amount;
  app.add_option("task", choice.what, "peg, nut, scans or meshes")
      ->required()
      ->check(CLI::IsMember({"peg", "nut", "scans", "meshes"}));
  app.add_option("amount", amount, "seeds; of meshes, the folder");
  app.add_flag("--short", choice.brief, "fewer of each");
  app.add_option("--json", choice.json, "report; by default under build/bench");
  CLI11_PARSE(app, argc, argv);
  if (choice.what == "meshes") {
    write_meshes(amount.empty() ? "." : amount);
    return 0;
  }
  if (!amount.empty()) choice.seeds = std::stoi(amount);
  const Json results = choice.what == "peg"   ? peg_table(choice)
                       : choice.what == "nut" ? nut_table(choice)
                                              : scan_table(choice);
  write_report("assembly_" + choice.what, argc, argv, results, choice.json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("assembly_bench", forcelayer::bench::run, argc, argv);
}
