// Contact wrench against truth, and what a frame costs, beside distance fields, exact closest
// points and mesh colliders: every method on the same contacts, poses and offset surface.
//
//   wrench_bench [--contact NAME]... [--s S]... [--orientations N] [--pair-cases N]
//                [--hand-only] [--covering RADIUS] [--models FOLDER] [--json FILE]
//
// S are voxel sizes in units of 10 mm. README.md says what the truth is.
#include <oneapi/tbb/global_control.h>
#include <openvdb/openvdb.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>

#include "runtime/field/tangent_plane.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/spread.h"
#include "tests/bench/wrench_bench_contacts.h"
#include "tests/bench/wrench_bench_frame.h"
#include "tests/bench/wrench_bench_hand.h"
#include "tests/bench/wrench_bench_level_set.h"
#include "tests/bench/wrench_bench_meshes.h"
#include "tests/bench/wrench_bench_pairs.h"
#include "tests/bench/wrench_bench_peers.h"
#include "tests/stress/baked.h"
#include "tests/stress/shapes.h"
#include "tests/support/places.h"
#include "tests/support/random_numbers.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;
using test::VoxelKind;

// A mesh deviates from the body by at most this fraction of a voxel: far below what is measured.
constexpr double kDeviationVoxels = 0.02;
constexpr VoxelKind kKinds[] = {VoxelKind::kChebyshev, VoxelKind::kLean, VoxelKind::kFull};

// The methods that are compared. `skips`: how it avoids looking at every point or triangle.
struct Contender {
  const char* name;
  const char* skips;
  VoxelKind kind;            // whose force layer it is judged in
  std::size_t shifts;        // fewer where the lattice says nothing
  bool has_our_unit = true;  // of force, so that it can be judged raw
  LoadOfTruth load = LoadOfTruth::kWhole;
};
constexpr std::size_t kAll = 100;
constexpr Contender kContenders[] = {
    {"default, distances", "blocks and rows", VoxelKind::kFull, kAll},
    {"default as voxrun runs it", "blocks and rows", VoxelKind::kFull, kAll},
    {"default, Euclidean layers", "blocks and rows", VoxelKind::kLean, kAll},
    {"default, Chebyshev layers", "blocks and rows", VoxelKind::kChebyshev, kAll},
    {"paper: tangent plane, N/10", "blocks and rows", VoxelKind::kChebyshev, kAll, true,
     LoadOfTruth::kByTen},
    {"dense float distances, our query", "blocks and rows", VoxelKind::kFull, kAll},
    {"OpenVDB level set, as people use it", "nothing", VoxelKind::kFull, kAll},
    {"FCL contacts", "by a tree", VoxelKind::kFull, 2, false},
    {"FCL distance", "by a tree", VoxelKind::kFull, 2, false}};
enum Name : std::size_t {
  kDistances,
  kAsRun,
  kEuclidean,
  kChebyshev,
  kPaper,
  kDense,
  kLevelSet,
  kFclContacts,
  kFclDistance
};

// The figures of a method in a case.
struct Figure {
  const char* name;
  double Quality::*value;
  bool raw = false;
};
constexpr Figure kFigures[] = {{"force", &Quality::force_error},
                               {"raw force", &Quality::raw_error, true},
                               {"touching", &Quality::touching_error},
                               {"torque", &Quality::torque_error}};
constexpr const char* kFrameUs = "frame, us";  // median of the frames of a case

using Values = std::map<std::string, std::map<std::string, std::vector<double>>>;  // by figure

// All that was measured at one voxel size.
struct Samples {
  std::map<std::string, Values> groups;  // [contacts]: figures by method

  void add(const std::string& group, const std::string& contact,
           const std::map<std::size_t, Quality>& qualities,
           const std::map<std::size_t, double>& frames_us) {
    const auto put = [&](const char* method, const char* figure, double value) {
      for (const std::string& of : {group, contact}) groups[of][method][figure].push_back(value);
    };
    for (const auto& [m, quality] : qualities) {
      for (const Figure& figure : kFigures) {
        if (figure.raw && !kContenders[m].has_our_unit) continue;
        put(kContenders[m].name, figure.name, quality.*figure.value);
      }
    }
    for (const auto& [m, us] : frames_us) put(kContenders[m].name, kFrameUs, us);
  }
};

// A row for each method and figure of these contacts; of the force alone where `force_only`.
void add_rows(double voxel_m, const std::string& contacts, const Values& methods, bool force_only,
              Json& rows) {
  for (const Contender& method : kContenders) {
    const auto found = methods.find(method.name);
    if (found == methods.end()) continue;
    for (const auto& [figure, values] : found->second) {
      if (force_only && figure != kFigures[0].name) continue;
      const Spread s = spread(values);
      rows.push_back({{"voxel_m", voxel_m},
                      {"contacts", contacts},
                      {"method", method.name},
                      {"skips", method.skips},
                      {"figure", figure},
                      {"n", s.n},
                      {"p5", s.p5},
                      {"p25", s.p25},
                      {"p50", s.p50},
                      {"p75", s.p75},
                      {"p95", s.p95},
                      {"median_low", s.median_low},
                      {"median_high", s.median_high}});
    }
  }
}

constexpr double kTimedS = 0.02;  // that a method may take in one contact, but for the least frames
constexpr std::size_t kMinFrames = 5;

// The median time of frames along poses, evenly spread over them where a method is slow, us.
template <class WrenchAt>
double frame_us(const std::vector<Pose>& poses, const WrenchAt& wrench_at) {
  const double first_s = now_s();
  wrench_at(poses[0]);
  const double fits = kTimedS / std::max(now_s() - first_s, 1e-9);
  const auto stride =
      static_cast<std::size_t>(std::clamp(static_cast<double>(poses.size()) / fits, 1.0,
                                          static_cast<double>(poses.size() / kMinFrames)));
  std::vector<double> us;
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    const double start_s = now_s();
    wrench_at(poses[i]);
    us.push_back(1e6 * (now_s() - start_s));
  }
  return percentiles(std::move(us)).p50;
}

// The fields over one map, and the frames of the methods that read it.
class MapFrames {
 public:
  MapFrames(VoxelKind kind, const Voxmap& voxmap, const Pshell& shell)
      : shell_(shell), voxmap_(voxmap), tangent_plane_(voxmap.voxel_size_m()) {
    auto usual = field::make_force_field(Model::kDefault,
                                         field::usual_force(Model::kDefault, voxmap), voxmap);
    if (!usual) throw std::runtime_error(to_line(usual.error()));
    usual_ = std::move(*usual);
    if (kind == VoxelKind::kFull) {
      add(kDistances, *usual_, Averaging::kDirections);
      add(kAsRun, *usual_, Averaging::kStep);
    }
    if (kind == VoxelKind::kLean) add(kEuclidean, *usual_, Averaging::kDirections);
    if (kind != VoxelKind::kChebyshev) return;
    add(kChebyshev, *usual_, Averaging::kDirections);
    add(kPaper, tangent_plane_, Averaging::kByTen);
  }
  MapFrames(const MapFrames&) = delete;  // the frames know the other members

  void add(std::size_t method, const field::ForceField& field, Averaging averaging) {
    auto& frame =
        frames_.emplace(method, std::make_unique<ModelFrame>(voxmap_, shell_, field, averaging))
            .first->second;
    if (averaging != Averaging::kByTen && averaging != Averaging::kStep) frame->weigh_by_area();
  }
  const std::map<std::size_t, std::unique_ptr<ModelFrame>>& all() const { return frames_; }

 private:
  const Pshell& shell_;
  const Voxmap& voxmap_;
  field::TangentPlaneField tangent_plane_;
  std::unique_ptr<field::ForceField> usual_;
  std::map<std::size_t, std::unique_ptr<ModelFrame>> frames_;
};

Pose pose_of(const ContactCase::Placed& placed) {
  return {placed.position_m, glm::quat_cast(placed.rotation)};
}

// The exact distance at the voxel centers around the contact.
DenseDistances distances_of(const ContactCase& contact) {
  const test::VoxelScene& scene = contact.dense().scene;
  DenseDistances box;
  for (std::size_t d = 0; d < 3; ++d) {
    box.low[d] = scene.min[d], box.dims[d] = static_cast<std::int32_t>(scene.dims[d]);
  }
  const auto far_m = static_cast<float>(contact.middle_m() + 4 * scene.voxel_size_m);
  for (std::int64_t x = 0; x < scene.dims[0]; ++x) {
    for (std::int64_t y = 0; y < scene.dims[1]; ++y) {
      for (std::int64_t z = 0; z < scene.dims[2]; ++z) {
        const glm::ivec3 voxel(scene.min[0] + x, scene.min[1] + y, scene.min[2] + z);
        box.distance_m.push_back(std::min(contact.dense().distance_at(voxel), far_m));
      }
    }
  }
  return box;
}

struct Choice {
  std::vector<double> sizes = {1, 0.5, 0.25};
  int orientations = 1, pair_cases = 4;
  double covering_voxels = kPaperCover;
  bool hand_only = false;
  std::vector<std::string> only;
  std::string models = test::source_path("../shared/models"), json;

  bool wants(const std::string& name) const {
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  }
};

constexpr const char* kGroups[] = {"flush and smooth", "corners and wedges", "mesh pairs"};

using Hands = std::map<std::string, Hand>;  // by group of contacts

// The exact surfaces of the truth are meshes that deviate by so little that no figure shows it.
constexpr double kTruthDeviationM = 1e-5;

void see_hand(const Combination& combination, const ContactCase& contact, const Pshell& pshell,
              Hand& hand) {
  const mesh::Mesh scene = offset_mesh(contact.body(), 0, kTruthDeviationM),
                   part = part_mesh(combination.part, kTruthDeviationM);
  const auto slide = contact.slide();
  const Pose first = pose_of(slide.front()), last = pose_of(slide.back());
  hand.see({combination.name, contact.voxmap(), pshell, scene, part, first, -contact.out(),
            glm::normalize(last.position_m - first.position_m)},
           hand.seen());
}

void judge(const Combination& combination, const PartShells& shells, const Pshell& pshell, double s,
           std::mt19937_64& random, Samples& samples, Hand& hand) {
  std::map<std::size_t, Quality> qualities;
  std::map<std::size_t, double> frames_us;
  const std::mt19937_64 same = random;
  for (const VoxelKind kind : kKinds) {
    random = same;
    const ContactCase contact(combination, shells, s, random, kind);
    std::vector<Pose> slide;
    for (const ContactCase::Placed& placed : contact.slide()) slide.push_back(pose_of(placed));
    const auto run = [&](std::size_t m, const auto& wrench_at) {
      qualities[m] = contact.judge(
          [&](const ContactCase::Placed& placed) { return wrench_at(pose_of(placed)); },
          std::min(ContactCase::kShifts, kContenders[m].shifts), kContenders[m].load);
      frames_us[m] = frame_us(slide, wrench_at);
    };
    MapFrames maps(kind, contact.voxmap(), pshell);
    DenseDistances distances;
    std::optional<DenseField> dense;
    if (kind == VoxelKind::kFull) {
      distances = distances_of(contact);
      dense.emplace(contact.voxmap(), distances, contact.middle_m());
      maps.add(kDense, *dense, Averaging::kNone);
    }
    for (const auto& [m, frame] : maps.all()) {
      run(m, [&frame = *frame](const Pose& pose) { return frame.at(pose); });
    }
    if (kind != VoxelKind::kFull) continue;
    see_hand(combination, contact, pshell, hand);
    const LevelSetFrame level_set(distances, shells.tested, s, contact.middle_m());
    run(kLevelSet, [&](const Pose& pose) { return level_set.at(pose); });
    const double deviation_m = kDeviationVoxels * s;
    const mesh::Mesh part = part_mesh(combination.part, deviation_m);
    const auto collide = [&](std::size_t m, const std::unique_ptr<MeshContacts>& peer,
                             double offset_m) {
      peer->set_scene(offset_mesh(contact.body(), offset_m, deviation_m));
      run(m, [&](const Pose& pose) { return peer->at(pose); });
    };
    collide(kFclContacts, fcl_contacts(part), contact.middle_m());
    collide(kFclDistance, fcl_distance(part, contact.middle_m()), 0);
  }
  samples.add(kGroups[combination.smooth ? 0 : 1], combination.name, qualities, frames_us);
}

void see_hand(const MeshPair& pair, const PairPart& part, const PairContact& contact, Hand& hand) {
  mesh::Mesh scene;
  stress::append(scene, pair.scene, contact.world_from_scene(0));
  const std::vector<Pose> line = contact.frames(VoxelKind::kFull);
  const glm::dvec3 in = glm::normalize(line.back().position_m - line.front().position_m);
  test::Random random(hand.seen());
  const glm::dvec3 along = glm::normalize(glm::cross(in, test::random_direction(random)));
  const Voxmap voxmap = contact.bake(VoxelKind::kFull, 0, true);
  const auto& c = part.shell.header().center_m;
  Pose above = line.front();
  above.position_m -= above.orientation * glm::dvec3(c[0], c[1], c[2]);
  hand.see({pair.name, voxmap, part.shell, scene, part.mesh, above, in, along}, hand.seen());
}

// The colliders of a pair: they know the scene in its own frame.
struct PairColliders {
  PairColliders(const MeshPair& pair, const PairPart& part, double offset_m)
      : contacts(fcl_contacts(part.mesh)), distance(fcl_distance(part.mesh, offset_m)) {
    distance->set_scene(pair.scene);
  }
  std::unique_ptr<MeshContacts> contacts, distance;
};

// One of the maps that a contact is judged in, and what reads it.
struct PairMap {
  explicit PairMap(Voxmap map) : voxmap(std::move(map)) {}

  Voxmap voxmap;
  DenseDistances distances;
  std::optional<DenseField> dense;
  std::optional<LevelSetFrame> level_set;
  std::optional<MapFrames> frames;
};

// Judges all methods; times them where `timed`, over the whole map.
void judge(const PairContact& contact, const PairPart& part, PairColliders& colliders, double s,
           bool timed, std::map<std::size_t, Quality>& qualities,
           std::map<std::size_t, double>& frames_us) {
  const auto run = [&](std::size_t m, const PairContact::WrenchAt& wrench_at) {
    const Contender& method = kContenders[m];
    qualities[m] = contact.judge(method.kind, wrench_at,
                                 std::min(PairContact::kShifts, method.shifts), method.load);
    if (!timed) return;
    frames_us[m] =
        frame_us(contact.frames(method.kind), [&](const Pose& pose) { return wrench_at(0, pose); });
  };
  for (const VoxelKind kind : kKinds) {
    std::vector<std::unique_ptr<PairMap>> at;
    const double offset_m = contact.offset_m(kind);
    for (std::size_t i = 0; i < PairContact::kShifts; ++i) {
      at.push_back(std::make_unique<PairMap>(contact.bake(kind, i, timed && i == 0)));
      PairMap& here = *at.back();
      here.frames.emplace(kind, here.voxmap, part.shell);
      if (kind != VoxelKind::kFull) continue;
      here.distances = contact.distances(i);
      here.dense.emplace(here.voxmap, here.distances, offset_m);
      here.level_set.emplace(here.distances, part.tested, s, offset_m);
      here.frames->add(kDense, *here.dense, Averaging::kNone);
    }
    for (const auto& [m, first] : at[0]->frames->all()) {
      run(m, [&, method = m](std::size_t i, const Pose& pose) {
        return at[i]->frames->all().at(method)->at(pose);
      });
    }
    if (kind != VoxelKind::kFull) continue;
    run(kLevelSet, [&](std::size_t i, const Pose& pose) { return at[i]->level_set->at(pose); });
  }
  const auto collide = [&](std::size_t m, MeshContacts& peer) {
    run(m, [&](std::size_t i, const Pose& pose) {
      const Pose& world_from_scene = contact.world_from_scene(i);
      const Wrench w = peer.at(inverse(world_from_scene) * pose);
      return Wrench{world_from_scene.orientation * w.force_n,
                    world_from_scene.orientation * w.torque_nm};
    });
  };
  collide(kFclContacts, *colliders.contacts);
  collide(kFclDistance, *colliders.distance);
}

constexpr int kTimedEvery = 10;  // cases
constexpr std::size_t kCheckedPlaces = 200;

// The deviation of the colliders' offset surfaces is returned, in voxels.
double judge(const MeshPair& pair, double s, const Choice& choice, std::uint64_t seed,
             Samples& samples, Hand& hand) {
  std::mt19937_64 random(seed);
  const PairPart part(pair, s,
                      choice.covering_voxels == kPaperCover ? 0 : choice.covering_voxels * s);
  const ExactDistance distance(pair.scene);
  distance.check(kCheckedPlaces, 10 * s, random);
  std::optional<PairColliders> colliders;
  double deviation_m = 0;
  for (int number = 0; number < choice.pair_cases; ++number) {
    const PairContact contact(pair.scene, distance, part, s, random);
    const bool timed = number % kTimedEvery == 0;
    if (timed || choice.hand_only) see_hand(pair, part, contact, hand);
    if (choice.hand_only) continue;
    if (!colliders) colliders.emplace(pair, part, contact.offset_m(VoxelKind::kFull));
    const mesh::Mesh offset_mesh = contact.offset_mesh();
    colliders->contacts->set_scene(offset_mesh);
    std::map<std::size_t, Quality> qualities, cropped;
    std::map<std::size_t, double> frames_us;
    judge(contact, part, *colliders, s, timed, qualities, frames_us);
    if (timed) deviation_m = std::max(deviation_m, contact.offset_mesh_deviation_m(offset_mesh));
    if (number == 0) {  // a map around the contact tells what the whole one does
      judge(contact, part, *colliders, s, false, cropped, frames_us);
      for (const auto& [m, quality] : cropped) {
        if (std::abs(quality.force_error - qualities[m].force_error) < 1e-4) continue;
        throw std::runtime_error(pair.name + ": the cropped map differs: " + kContenders[m].name);
      }
    }
    samples.add(kGroups[2], pair.name, qualities, frames_us);
  }
  return deviation_m / s;
}

void print(const std::string& group, const Values& methods) {
  std::printf("%-40s%8s %15s %8s %8s %8s %8s %8s\n", group.c_str(), "force", "95%", "raw",
              "touching", "torque", "n", "us");
  for (const Contender& method : kContenders) {
    const auto found = methods.find(method.name);
    if (found == methods.end()) continue;
    const auto of = [&](const char* figure) {
      const auto values = found->second.find(figure);
      return spread(values == found->second.end() ? std::vector<double>() : values->second);
    };
    const auto median = [&](const char* figure) {
      const double value = of(figure).p50;
      char text[16] = "-";
      if (!std::isnan(value)) std::snprintf(text, sizeof text, "%.2f%%", 100 * value);
      return std::string(text);
    };
    const Spread force = of("force");
    std::printf("  %-38s%8s %6.2f - %6.2f %8s %8s %8s %8zu %8.1f\n", method.name,
                median("force").c_str(), 100 * force.median_low, 100 * force.median_high,
                median("raw force").c_str(), median("touching").c_str(), median("torque").c_str(),
                force.n, of(kFrameUs).p50);
  }
  std::fflush(stdout);
}

constexpr Part kParts[] = {Part::kSphere, Part::kBox, Part::kCylinder, Part::kCone, Part::kTorus};

// Rows of what the hand felt.
void add_hand(const Hand& hand, double voxel_m, double covering_voxels, const char* group,
              Json& results) {
  for (std::size_t motion = 0; motion < Hand::kMotions; ++motion) {
    const std::vector<double>& errors = hand.errors(motion);
    if (errors.empty()) continue;
    const Spread s = spread(errors);
    const double max = *std::max_element(errors.begin(), errors.end());
    std::printf("  E_hand %-20s %-8s n %4zu: median %.2f%%, p95 %.2f%%, max %.1f%%\n", group,
                Hand::kNames[motion], s.n, 100 * s.p50, 100 * s.p95, 100 * max);
    results["wrench_hand"].push_back({{"voxel_m", voxel_m},
                                      {"covering_voxels", covering_voxels},
                                      {"contacts", group},
                                      {"motion", Hand::kNames[motion]},
                                      {"n", s.n},
                                      {"p50", s.p50},
                                      {"p95", s.p95},
                                      {"max", max}});
  }
  for (std::size_t i = 0; i < Hand::kCauses; ++i) {
    const std::vector<double>& errors = hand.cause(i);
    if (errors.empty()) continue;
    const Spread s = spread(errors);
    const double max = *std::max_element(errors.begin(), errors.end());
    std::printf("  E_hand %-20s from %-6s n %3zu: median %.2f%%, p95 %.2f%%, max %.1f%%\n", group,
                Hand::kCauseNames[i], s.n, 100 * s.p50, 100 * s.p95, 100 * max);
    results["wrench_hand_causes"].push_back({{"voxel_m", voxel_m},
                                             {"covering_voxels", covering_voxels},
                                             {"contacts", group},
                                             {"cause", Hand::kCauseNames[i]},
                                             {"n", s.n},
                                             {"p50", s.p50},
                                             {"p95", s.p95},
                                             {"max", max}});
  }
  for (std::size_t i = 0; i < hand.each().size(); ++i) {
    const Hand::Each& each = hand.each()[i];
    Json row = {{"voxel_m", voxel_m},
                {"covering_voxels", covering_voxels},
                {"contacts", each.contact},
                {"number", i}};
    for (std::size_t motion = 0; motion < Hand::kMotions; ++motion) {
      const double error = each.median[motion];
      row[Hand::kNames[motion]] = std::isnan(error) ? Json(nullptr) : Json(error);
    }
    for (std::size_t cause = 0; cause < Hand::kCauses; ++cause) {
      const double error = each.causes[cause];
      row[Hand::kCauseNames[cause]] = std::isnan(error) ? Json(nullptr) : Json(error);
    }
    results["wrench_hand_each"].push_back(row);
  }
  const double off = hand.off().empty() ? 0 : *std::ranges::max_element(hand.off());
  std::printf(
      "  E_hand %s: %zu cases, %zu pass by, %zu not at rest; %zu poses unsolved, %zu outside the "
      "map; off by "
      "at most %.1g, %zu of three contacts or more\n",
      group, hand.seen(), hand.passed(), hand.restless(), hand.unsolved(), hand.outside(), off,
      hand.flush());
  results["wrench_hand_cases"].push_back({{"voxel_m", voxel_m},
                                          {"covering_voxels", covering_voxels},
                                          {"contacts", group},
                                          {"cases", hand.seen()},
                                          {"passed", hand.passed()},
                                          {"restless", hand.restless()},
                                          {"unsolved", hand.unsolved()},
                                          {"outside", hand.outside()},
                                          {"three_contacts", hand.flush()},
                                          {"step_p50_us", hand.step_us()},
                                          {"off_max", off}});
}

void judge_size(const Choice& choice, const std::vector<MeshPair>& pairs, double units,
                Json& results) {
  const double s = units * kUnitM;
  std::map<Part, PartShells> shells;
  std::map<Part, Pshell> pshells;
  for (const Part part : kParts) {
    shells[part] = shells_of(part, s, choice.covering_voxels);
    pshells.emplace(part, pshell_of(shells[part].tested, s));
  }
  Samples samples;
  Hands hands;
  std::mt19937_64 random(20260101);
  for (const Combination& combination : combinations()) {
    if (!choice.wants(combination.name)) continue;
    for (int i = 0; i < choice.orientations; ++i) {
      const PartShells& of_part = shells[combination.part];
      const Pshell& pshell = pshells.at(combination.part);
      Hand& hand = hands[kGroups[combination.smooth ? 0 : 1]];
      if (choice.hand_only) {
        const ContactCase contact(combination, of_part, s, random, VoxelKind::kFull);
        see_hand(combination, contact, pshell, hand);
      } else {
        judge(combination, of_part, pshell, s, random, samples, hand);
      }
    }
  }
  double deviation_voxels = 0;
  for (const MeshPair& pair : pairs) {
    // One seed, so that every choice of sizes, pairs and cases begins with the same contacts.
    const double deviated = judge(pair, s, choice, 20260101, samples, hands[kGroups[2]]);
    deviation_voxels = std::max(deviation_voxels, deviated);
  }
  std::printf("s = %g (%g mm); the offset surfaces of the pairs deviate by %.2g voxels\n", units,
              1000 * s, deviation_voxels);
  for (const char* group : kGroups) {
    if (hands.contains(group)) add_hand(hands[group], s, choice.covering_voxels, group, results);
  }
  for (const char* group : kGroups) {
    if (samples.groups.contains(group)) print(group, samples.groups[group]);
  }
  for (const auto& [contacts, methods] : samples.groups) {
    const bool is_group = std::ranges::find(kGroups, contacts) != std::end(kGroups);
    const bool is_pair = std::ranges::find(kPairNames, contacts) != std::end(kPairNames);
    if (is_group || is_pair) add_rows(s, contacts, methods, is_pair, results["wrench"]);
  }
}

int run(int argc, char** argv) {
  CLI::App app{"Contact wrench against truth and time", "wrench_bench"};
  Choice choice;
  app.add_option("--contact", choice.only,
                 "\"sphere on plane\", \"pump on bay\", ... (default: all)");
  app.add_option("--s", choice.sizes, "voxel sizes, in units of 10 mm")->check(CLI::PositiveNumber);
  app.add_option("--orientations", choice.orientations, "of each contact")
      ->check(CLI::PositiveNumber);
  app.add_option("--pair-cases", choice.pair_cases, "of each pair of meshes")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--covering", choice.covering_voxels, "covering radius of the shells, voxels")
      ->check(CLI::PositiveNumber);
  app.add_flag("--hand-only", choice.hand_only, "E_hand alone, of every case");
  app.add_option("--models", choice.models, "folder of the models");
  app.add_option("--json", choice.json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  const oneapi::tbb::global_control one_core(oneapi::tbb::global_control::max_allowed_parallelism,
                                             1);
  openvdb::initialize();
  std::vector<MeshPair> pairs;
  for (const char* name : kPairNames) {
    if (choice.pair_cases > 0 && choice.wants(name)) {
      pairs.push_back(mesh_pair(name, choice.models));
    }
  }
  Json results;
  for (const double units : choice.sizes) judge_size(choice, pairs, units, results);
  write_report("wrench", argc, argv, results, choice.json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("wrench_bench", forcelayer::bench::run, argc, argv);
}
