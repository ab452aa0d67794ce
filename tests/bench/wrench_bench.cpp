// Contact wrench against truth, and what a frame costs, beside mesh colliders: every method on the
// same contacts, poses and offset surface, one offset and one gain fitted to each.
//
//   wrench_bench [--contact NAME]... [--s S]... [--orientations N] [--pair-cases N]
//                [--models FOLDER] [--json FILE]
//
// S are voxel sizes in units of 10 mm. wrench.md says what the oracles are.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <optional>

#include "runtime/field/level_field.h"
#include "runtime/field/tangent_plane.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/force_bench_contacts.h"
#include "tests/bench/force_bench_frame.h"
#include "tests/bench/wrench_bench_level_set.h"
#include "tests/bench/wrench_bench_meshes.h"
#include "tests/bench/wrench_bench_pairs.h"
#include "tests/bench/wrench_bench_peers.h"
#include "tests/support/places.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;

// A mesh deviates from the body by at most this share of a voxel: far below what is measured.
constexpr double kDeviationVoxels = 0.02;

// What a hand can just tell apart: the least of the published ranges (wrench.md).
constexpr double kNoticeableForce = 0.07, kNoticeableTorque = 0.13, kNoticeableDeg = 20;

Pose pose_of(const ContactCase::Placed& placed) {
  return {placed.position_m, glm::quat_cast(placed.rotation)};
}

// The exact distance at the voxel centers around the contact.
openvdb::FloatGrid::Ptr distance_grid(const ContactCase& contact) {
  const test::VoxelScene& box = contact.dense().scene;
  const double s = contact.voxmap().voxel_size_m();
  auto grid = openvdb::FloatGrid::create(static_cast<float>(4 * s + contact.middle_m()));
  auto accessor = grid->getAccessor();
  openvdb::Coord c;
  for (std::int64_t x = 0; x < box.dims[0]; ++x) {
    for (std::int64_t y = 0; y < box.dims[1]; ++y) {
      for (std::int64_t z = 0; z < box.dims[2]; ++z) {
        const glm::ivec3 v(box.min[0] + x, box.min[1] + y, box.min[2] + z);
        const float distance_m = contact.dense().distance_at(v);
        if (distance_m > grid->background()) continue;
        c.reset(v.x, v.y, v.z);
        accessor.setValueOn(c, distance_m);
      }
    }
  }
  return grid;
}

// What was measured of one method, over contacts and orientations.
struct Sample {
  std::vector<double> force_error, deviation, noise, direction_deg, torque, torque_error, frame_us;

  void add(const Quality& q) {
    force_error.push_back(q.force_error);
    deviation.push_back(q.deviation);
    noise.push_back(q.noise);
    direction_deg.push_back(q.direction_deg);
    torque.push_back(q.torque);
    torque_error.push_back(q.torque_error);
  }
  void add(const Sample& other) {
    for (auto member :
         {&Sample::force_error, &Sample::deviation, &Sample::noise, &Sample::direction_deg,
          &Sample::torque, &Sample::torque_error, &Sample::frame_us}) {
      const auto& from = other.*member;
      (this->*member).insert((this->*member).end(), from.begin(), from.end());
    }
  }
};

using Samples = std::map<std::string, std::map<std::string, Sample>>;  // [group][method]

constexpr const char* kPaper = "paper: tangent plane, N/10";
constexpr const char* kLevel = "level field";
constexpr const char* kDefault = "default";
constexpr const char* kLevelSet = "shell in a trilinear level set";
constexpr const char* kFcl = "FCL mesh contacts";
constexpr const char* kBullet = "Bullet mesh contacts";

double middle(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  return values.empty() ? NAN : percentiles(std::move(values)).p50;
}

Json to_json(const Sample& sample) {
  const double force = middle(sample.force_error), degrees = middle(sample.direction_deg);
  const double torque = middle(sample.torque_error);
  return {{"force_error", force},
          {"deviation", middle(sample.deviation)},
          {"noise", middle(sample.noise)},
          {"direction_deg", degrees},
          {"torque", middle(sample.torque)},
          {"torque_error", torque},
          {"of_noticeable",
           {{"force", force / kNoticeableForce},
            {"torque", torque / kNoticeableTorque},
            {"direction", degrees / kNoticeableDeg}}},
          {"cases", sample.force_error.size()},
          {"frame_us", to_json(percentiles(sample.frame_us))}};
}

constexpr double kTimedS = 0.25;  // that a method may take in one contact
constexpr std::size_t kLeastFrames = 40;

// Times a method along poses, evenly spread over them where it is slow.
template <class Poses, class WrenchAt>
void time_frames(const Poses& poses, const WrenchAt& wrench_at, Sample& sample) {
  const double first_s = now_s();
  wrench_at(poses[0]);
  const double fits = kTimedS / std::max(now_s() - first_s, 1e-9);
  const auto stride =
      static_cast<std::size_t>(std::clamp(static_cast<double>(poses.size()) / fits, 1.0,
                                          static_cast<double>(poses.size() / kLeastFrames)));
  for (std::size_t i = 0; i < poses.size(); i += stride) {
    const double start_s = now_s();
    wrench_at(poses[i]);
    sample.frame_us.push_back(1e6 * (now_s() - start_s));
  }
}

struct MethodRun {
  const char* name;
  ContactCase::WrenchAt wrench_at;  // timed, and judged where `judged_as` is none
  std::optional<Method> judged_as;
};

// The default model's force in voxels of other kinds, each with the exact offset surface where its
// force begins.
struct KindRun {
  const char* name;
  VoxelKind voxels;
  Method judged_as;
};
constexpr KindRun kKinds[] = {
    {"default, Euclidean layers", VoxelKind::kLean, Method::kEuclideanContacts},
    {"default, distances", VoxelKind::kFull, Method::kDistance8}};

std::unique_ptr<field::ForceField> usual_field(const Voxmap& voxmap) {
  auto field =
      field::make_force_field(Model::kDefault, field::usual_force(Model::kDefault, voxmap), voxmap);
  if (!field) throw std::runtime_error(to_line(field.error()));
  return std::move(*field);
}

void judge(const ContactCase& contact, const Combination& combination, const MethodRun& method,
           Samples& samples) {
  Sample own;
  own.add(method.judged_as ? contact.judge(*method.judged_as, false)
                           : contact.judge(method.wrench_at));
  time_frames(contact.slide(), method.wrench_at, own);
  samples[combination.name][method.name].add(own);
  samples[combination.smooth ? "flush and smooth" : "corners and wedges"][method.name].add(own);
}

void judge(const Combination& combination, const PartShells& shells, const Pshell& pshell, double s,
           std::mt19937_64& random, Samples& samples) {
  const std::mt19937_64 same = random;
  const ContactCase contact(combination, shells, s, random);
  const double deviation_m = kDeviationVoxels * s;
  const mesh::Mesh part = part_mesh(combination.part, deviation_m);
  const mesh::Mesh scene = offset_mesh(contact.body(), contact.middle_m(), deviation_m);
  const field::LevelField level(contact.voxmap());
  const field::TangentPlaneField tangent_plane(s);
  ModelFrame paper(contact.voxmap(), pshell, tangent_plane, Averaging::kByTen);
  ModelFrame field(contact.voxmap(), pshell, level, Averaging::kNone);
  ModelFrame standard(contact.voxmap(), pshell, level, Averaging::kDirections);
  const LevelSetFrame level_set(distance_grid(contact), shells.tested, s, contact.middle_m());
  const auto fcl = fcl_contacts(scene, part), bullet = bullet_contacts(scene, part);
  using Placed = ContactCase::Placed;
  const MethodRun methods[] = {
      {kPaper, [&](const Placed& p) { return paper.at(pose_of(p)); },
       Method::kTangentPlaneAveraged},
      {kLevel, [&](const Placed& p) { return field.at(pose_of(p)); }, Method::kLevel},
      {kDefault, [&](const Placed& p) { return standard.at(pose_of(p)); }, Method::kContacts},
      {kLevelSet, [&](const Placed& p) { return level_set.at(pose_of(p)); }, Method::kDistance},
      {kFcl, [&](const Placed& p) { return fcl->at(pose_of(p)); }, std::nullopt},
      {kBullet, [&](const Placed& p) { return bullet->at(pose_of(p)); }, std::nullopt}};
  for (const MethodRun& method : methods) judge(contact, combination, method, samples);
  for (const KindRun& kind : kKinds) {
    std::mt19937_64 again = same;
    const ContactCase other(combination, shells, s, again, kind.voxels);
    const auto force = usual_field(other.voxmap());
    ModelFrame frame(other.voxmap(), pshell, *force, Averaging::kDirections);
    judge(other, combination,
          {kind.name, [&](const Placed& p) { return frame.at(pose_of(p)); }, kind.judged_as},
          samples);
  }
}

// The same methods between two meshes; the deviation of the colliders' offset surface is returned,
// in voxels.
double judge(const MeshPair& pair, const PairPart& part, double s, std::mt19937_64& random,
             Samples& samples) {
  const std::mt19937_64 same = random;
  const PairCase contact(pair, part, s, random);
  const mesh::Mesh scene = contact.offset_mesh();
  const auto fcl = fcl_contacts(scene, part.mesh), bullet = bullet_contacts(scene, part.mesh);
  const field::TangentPlaneField tangent_plane(s);
  std::vector<std::unique_ptr<field::LevelField>> levels;
  std::deque<ModelFrame> paper, field, standard;
  std::vector<LevelSetFrame> level_set;
  for (std::size_t i = 0; i < PairCase::kShifts; ++i) {
    const auto& at = contact.placing(i);
    levels.push_back(std::make_unique<field::LevelField>(at.voxmap));
    paper.emplace_back(at.voxmap, part.shell, tangent_plane, Averaging::kByTen);
    field.emplace_back(at.voxmap, part.shell, *levels.back(), Averaging::kNone);
    standard.emplace_back(at.voxmap, part.shell, *levels.back(), Averaging::kDirections);
    field.back().weigh_by_area(), standard.back().weigh_by_area();
    level_set.emplace_back(at.distance_m, part.tested, s, contact.middle_m());
  }
  // Colliders know the scene in its own frame.
  const auto in_scene = [&](const std::unique_ptr<MeshContacts>& contacts, std::size_t shift,
                            const Pose& pose) {
    const Pose& world_from_scene = contact.placing(shift).world_from_scene;
    const Wrench w = contacts->at(inverse(world_from_scene) * pose);
    return Wrench{world_from_scene.orientation * w.force_n,
                  world_from_scene.orientation * w.torque_nm};
  };
  const std::pair<const char*, PairCase::WrenchAt> methods[] = {
      {kPaper, [&](std::size_t i, const Pose& p) { return paper[i].at(p); }},
      {kLevel, [&](std::size_t i, const Pose& p) { return field[i].at(p); }},
      {kDefault, [&](std::size_t i, const Pose& p) { return standard[i].at(p); }},
      {kLevelSet, [&](std::size_t i, const Pose& p) { return level_set[i].at(p); }},
      {kFcl, [&](std::size_t i, const Pose& p) { return in_scene(fcl, i, p); }},
      {kBullet, [&](std::size_t i, const Pose& p) { return in_scene(bullet, i, p); }}};
  for (const auto& [name, wrench_at] : methods) {
    Sample own;
    own.add(contact.judge(wrench_at, name == kPaper));
    time_frames(
        contact.frames(), [&at = wrench_at](const Pose& p) { return at(0, p); }, own);
    samples[pair.name][name].add(own);
    samples["mesh pairs"][name].add(own);
  }
  for (const KindRun& kind : kKinds) {
    std::mt19937_64 again = same;
    const PairCase other(pair, part, s, again, kind.voxels);
    std::vector<std::unique_ptr<field::ForceField>> fields;
    std::deque<ModelFrame> frames;
    for (std::size_t i = 0; i < PairCase::kShifts; ++i) {
      const Voxmap& voxmap = other.placing(i).voxmap;
      fields.push_back(usual_field(voxmap));
      frames.emplace_back(voxmap, part.shell, *fields.back(), Averaging::kDirections)
          .weigh_by_area();
    }
    Sample own;
    own.add(other.judge([&](std::size_t i, const Pose& p) { return frames[i].at(p); }, false));
    time_frames(
        other.frames(), [&](const Pose& p) { return frames[0].at(p); }, own);
    samples[pair.name][kind.name].add(own);
    samples["mesh pairs"][kind.name].add(own);
  }
  return contact.offset_mesh_deviation_m(scene) / s;
}

// What the kinds of voxels cost on disk and to bake, on the scenes of the pairs as they are: one
// thread, from mesh in memory to file, the least of three.
Json bill_of(const std::vector<MeshPair>& pairs, double s) {
  Json bill;
  for (const MeshPair& pair : pairs) {
    double two_bits_s = 0;
    for (const VoxelKind kind : {VoxelKind::kChebyshev, VoxelKind::kLean, VoxelKind::kFull}) {
      const test::ScratchFolder folder;
      double least_s = 1e300;
      for (int turn = 0; turn < 3; ++turn) {
        const double start_s = now_s();
        stress::bake_scene_file(pair.scene, s, kind, folder / "scene.vox");
        least_s = std::min(least_s, now_s() - start_s);
      }
      const auto map = Voxmap::open(folder / "scene.vox");
      if (!map) throw std::runtime_error(to_line(map.error()));
      const auto bytes = static_cast<double>(map->header().file.file_bytes);
      const auto layer = static_cast<double>(map->header().surface_voxels);
      if (kind == VoxelKind::kChebyshev) two_bits_s = least_s;
      bill[pair.name][test::name_of(kind)] = {{"file_bytes", bytes},
                                              {"force_layer_voxels", layer},
                                              {"bytes_per_force_layer_voxel", bytes / layer},
                                              {"bake_s", least_s},
                                              {"bake_of_two_bits", least_s / two_bits_s}};
      std::printf(
          "  %-20s %-10s %9.0f bytes, %5.2f a force-layer voxel; bake %7.3f s, %4.1f times\n",
          pair.name.c_str(), test::name_of(kind), bytes, bytes / layer, least_s,
          least_s / two_bits_s);
    }
  }
  return bill;
}

void print(const std::string& group, const Json& rows) {
  std::printf("%s\n  %-32s %8s %8s %7s %7s %8s %9s %9s\n", group.c_str(), "", "force", "deviat.",
              "noise", "deg", "torque", "p50 us", "p99 us");
  for (const auto& [name, row] : rows.items()) {
    const auto at = [&, &values = row](const char* key) {
      return values[key].is_null() ? NAN : values[key].template get<double>();
    };
    std::printf("  %-32s %7.1f%% %7.1f%% %6.1f%% %7.2f %7.1f%% %9.1f %9.1f\n", name.c_str(),
                100 * at("force_error"), 100 * at("deviation"), 100 * at("noise"),
                at("direction_deg"), 100 * at("torque_error"), row["frame_us"]["p50"].get<double>(),
                row["frame_us"]["p99"].get<double>());
  }
  std::fflush(stdout);
}

constexpr const char* kGroups[] = {"flush and smooth", "corners and wedges", "mesh pairs"};
constexpr Part kParts[] = {Part::kSphere, Part::kBox, Part::kCylinder, Part::kCone, Part::kTorus};
constexpr const char* kPartNames[] = {"sphere", "box", "cylinder", "cone", "torus"};

struct Choice {
  std::vector<double> sizes = {1, 0.5, 0.25};
  int orientations = 4, pair_cases = 4;
  std::vector<std::string> only;
  std::string models = test::source_path("../shared/models"), json;

  bool wants(const std::string& name) const {
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  }
};

Json judge_size(const Choice& choice, const std::vector<MeshPair>& pairs, double units) {
  const double s = units * kUnitM;
  Json points;
  std::map<Part, PartShells> shells;
  std::map<Part, Pshell> pshells;
  for (const Part part : kParts) {
    shells[part] = shells_of(part, s, kPaperCover);
    pshells.emplace(part, pshell_of(shells[part].tested, s));
    points[kPartNames[static_cast<int>(part)]] = shells[part].tested.points_m.size();
  }
  Samples samples;
  std::mt19937_64 random(20260101);
  for (const Combination& combination : wide_combinations()) {
    if (combination.standoff) continue;  // judged by what the map holds: for our fields alone
    if (!choice.wants(combination.name)) continue;
    for (int i = 0; i < choice.orientations; ++i) {
      judge(combination, shells[combination.part], pshells.at(combination.part), s, random,
            samples);
    }
  }
  double deviation_voxels = 0;
  for (const MeshPair& pair : pairs) {
    if (!choice.wants(pair.name)) continue;
    const PairPart part(pair, s);
    points[pair.name] = part.tested.points_m.size();
    for (int i = 0; i < choice.pair_cases; ++i) {
      deviation_voxels = std::max(deviation_voxels, judge(pair, part, s, random, samples));
    }
  }
  Json groups;
  for (const auto& [group, methods] : samples) {
    for (const auto& [method, sample] : methods) groups[group][method] = to_json(sample);
  }
  std::printf("s = %g (%g mm)\n", units, 1000 * s);
  for (const char* group : kGroups) {
    if (groups.contains(group)) print(group, groups[group]);
  }
  return {{"s", units},
          {"voxel_size_m", s},
          {"orientations", choice.orientations},
          {"pair_cases", choice.pair_cases},
          {"shell_points", points},
          {"pair_offset_deviation_voxels", deviation_voxels},
          {"bill", bill_of(pairs, s)},
          {"contacts", groups}};
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
  app.add_option("--models", choice.models, "folder of the models");
  app.add_option("--json", choice.json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  openvdb::initialize();
  const std::vector<MeshPair> pairs = mesh_pairs(choice.models);
  Json results = Json::array();
  for (const double units : choice.sizes) results.push_back(judge_size(choice, pairs, units));
  write_report("wrench", argc, argv, results, choice.json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("wrench_bench", forcelayer::bench::run, argc, argv);
}
