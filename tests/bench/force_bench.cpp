// How true and how smooth each force model is, against contacts with a closed formula, and what a
// collected point costs. force.md says what the oracle is and where it is not to be trusted.
//
//   force_bench [--s S [--cover C]] [--contact NAME]... [--json FILE]
//   force_bench --cost [--vectors TARGET] [--json FILE]
//
// S is one voxel size, in units of 10 mm, C the shell's covering radius in voxels.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "runtime/field/distance_field.h"
#include "runtime/field/level_field.h"
#include "runtime/field/tangent_plane.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/force_bench_case.h"
#include "tests/bench/force_bench_contacts.h"
#include "tests/support/curve_order.h"
#include "tests/support/point_part.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;

// Qualities of all random orientations, one list per quality, in Quality's order.
using Sample = std::array<std::vector<double>, 6>;
constexpr const char* kColumns[6] = {"stiffness",     "bias",   "noise",
                                     "direction_deg", "torque", "step"};

void add(Sample& sample, const Quality& q) {
  const double values[6] = {q.stiffness, q.bias, q.noise, q.direction_deg, q.torque, q.step};
  for (std::size_t i = 0; i < 6; ++i) {
    if (std::isfinite(values[i])) sample[i].push_back(values[i]);
  }
}

double share(std::vector<double> values, double at) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(at * static_cast<double>(values.size() - 1) + 0.5)];
}

Json to_json(const Sample& sample) {
  Json json;
  for (std::size_t i = 0; i < 6; ++i) {
    json[kColumns[i]] = {{"median", share(sample[i], 0.5)},
                         {"p10", share(sample[i], 0.1)},
                         {"p90", share(sample[i], 0.9)}};
  }
  json["cases"] = sample[0].size();
  return json;
}

void print(const std::string& name, const Sample& q) {
  const auto at = [&](std::size_t i) { return share(q[i], 0.5); };
  std::printf("  %-26s %5.2f (%.2f-%.2f) %7.1f%% %6.1f%% %7.2f %8.4f %8.3f%%\n", name.c_str(),
              at(0), share(q[0], 0.1), share(q[0], 0.9), 100 * at(1), 100 * at(2), at(3), at(4),
              100 * at(5));
}

void print_header(const std::string& title) {
  std::printf("%s\n  %-26s %17s %8s %7s %7s %8s %9s\n", title.c_str(), "", "stiffness (p10-p90)",
              "bias", "noise", "deg", "torque", "step");
}

struct Choice {
  bool cost = false;
  double only_s = 0;  // 0: all
  double cover = kPaperCover;
  std::vector<std::string> only;
  std::string vectors;  // empty: all
  std::string json;

  bool wants(const std::string& name) const {
    return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
  }
};

// The group that a contact is pooled with; null for none.
const char* group_of(const Combination& combination) {
  if (combination.smooth) return "flush_and_smooth";
  if (combination.wall_by_wall) return "wedges";
  const bool wedge = combination.body == StaticKind::kWedge && combination.free_angle < M_PI;
  return wedge ? "wedges_one_offset" : nullptr;
}

// The contacts that are asked for at one voxel size and shell density. A contact's draws do not
// depend on which others are judged.
Json judge_all(const Choice& choice, double s_units, double cover, int orientations) {
  const double s = s_units * kUnitM;
  std::map<Part, PartShells> shells;
  for (const Part part : {Part::kSphere, Part::kBox, Part::kCylinder}) {
    shells[part] = shells_of(part, s, cover);
  }
  std::map<std::string, std::map<Method, Sample>> pooled;
  Json contacts;
  std::uint64_t seed = 20260101;
  for (const Combination& combination : combinations()) {
    std::mt19937_64 random(seed++);
    if (!choice.wants(combination.name)) continue;
    std::map<Method, Sample> own;
    const char* const group = group_of(combination);
    for (int i = 0; i < orientations; ++i) {
      // The same contact in maps of every kind.
      const std::mt19937_64 same = random;
      for (const VoxelKind kind : {VoxelKind::kChebyshev, VoxelKind::kLean, VoxelKind::kFull}) {
        random = same;
        const ContactCase contact(combination, shells[combination.part], s, random, kind);
        for (const Method method : kMethods) {
          if (kind_of(method) != kind) continue;
          const Quality q = contact.judge(method);
          add(own[method], q);
          if (group != nullptr) add(pooled[group][method], q);
        }
      }
    }
    for (const Method method : kMethods) {
      contacts[combination.name][name_of(method)] = to_json(own[method]);
    }
    if (!combination.smooth && s_units == 0.5) {
      print_header(combination.name);
      for (const Method method : kMethods) print(name_of(method), own[method]);
    }
  }
  Json size = {{"s", s_units},
               {"voxel_size_m", s},
               {"covering_radius_voxels", cover},
               {"orientations", orientations},
               {"contacts", contacts}};
  if (!choice.only.empty()) return size;
  for (const auto& [group, methods] : pooled) {
    char title[128];
    std::snprintf(title, sizeof title, "%s, oblique: s = %g (%g mm), covering radius %.3g s",
                  group.c_str(), s_units, 1000 * s, cover);
    print_header(title);
    for (const Method method : kMethods) {
      print(name_of(method), methods.at(method));
      size[group][name_of(method)] = to_json(methods.at(method));
    }
  }
  return size;
}

// Least time of a call in ns, over so many seconds: other work on the machine and a slower clock
// can only add. So many calls at a time are measured: reading the time takes as long as ten points,
// and a clock may tick no oftener than that.
template <class Call>
double least_ns(double seconds, int calls, Call call) {
  double least = 1e300;
  const double end = now_s() + seconds;
  do {
    const double start = now_s();
    for (int i = 0; i < calls; ++i) call();
    least = std::min(least, (now_s() - start) / calls);
  } while (now_s() < end);
  return 1e9 * least;
}

// So many at a time where a call is short (from 0.4 us on) and the same every time.
constexpr int kCalls = 16;

// The same part and plane in a map of distances: what a point costs there, beside the level
// field in turns.
Json measure_distance_cost(VoxelKind kind, const AnalyticStatic& plane, double s,
                           const Pshell& pshell, double height_m, const field::ForceField& level,
                           const query::CollectedPoints& level_points) {
  const test::VoxelScene scene = bake(kind, plane, s, 2, glm::dvec3(-0.11), glm::dvec3(0.11));
  const Voxmap voxmap = test::make_voxmap(scene);
  const glm::dvec3 normal = plane.rotation[2];
  query::ContactQuery query(voxmap, pshell);
  query::CollectedPoints points;
  points.reserve(pshell.view().point_count);
  Pose pose;
  pose.orientation = glm::quat_cast(plane.rotation);
  // As deep as in the layers: a quarter of a voxel along the slant.
  const double zero = zero_force_voxels(kind, 2, normal);
  pose.position_m = normal * (height_m + (zero - 0.25 * norm1(normal)) * s);
  query.run(pose, points);
  field::FieldSamples samples;
  samples.reserve(points.count + level_points.count);
  const double count = points.count, level_count = level_points.count;
  const field::DistanceField distance(voxmap);
  const field::TangentPlaneField nearest(s);
  double distance_ns = 1e300, nearest_ns = 1e300, level_ns = 1e300, query_ns = 1e300;
  for (int turn = 0; turn < 20; ++turn) {
    constexpr double kTurnS = 0.05;
    distance_ns =
        std::min(distance_ns, least_ns(kTurnS, kCalls, [&] { distance.measure(points, samples); }));
    level_ns =
        std::min(level_ns, least_ns(kTurnS, kCalls, [&] { level.measure(level_points, samples); }));
    nearest_ns =
        std::min(nearest_ns, least_ns(kTurnS, kCalls, [&] { nearest.measure(points, samples); }));
    query_ns = std::min(query_ns, least_ns(kTurnS, kCalls, [&] { query.run(pose, points); }));
  }
  double cold_ns = 1e300;
  for (int i = 0; i < 20; ++i) {
    const field::DistanceField fresh(voxmap);
    cold_ns = std::min(cold_ns, least_ns(0, 1, [&] { fresh.measure(points, samples); }));
  }
  std::printf(
      "  %u points collected; per point distance %.2f ns (every brick new: %.1f), nearest "
      "and tangent plane %.2f ns, level beside it %.2f ns; query %.1f us\n",
      points.count, distance_ns / count, cold_ns / count, nearest_ns / count,
      level_ns / level_count, query_ns / 1000);
  return {{"collected_points", points.count},
          {"distance_ns_per_point", distance_ns / count},
          {"distance_every_brick_new_ns_per_point", cold_ns / count},
          {"nearest_ns_per_point", nearest_ns / count},
          {"level_ns_per_point", level_ns / level_count},
          {"query_ns", query_ns}};
}

// A part of the bench's shell, in pointshell's order, lying on an oblique plane, halfway into the
// force layer.
Json measure_cost(const char* name, const AnalyticShell& shell, double height_m) {
  const double s = 0.0025;
  AnalyticStatic plane;
  plane.rotation = glm::mat3_cast(glm::normalize(glm::dquat(0.9, 0.3, -0.2, 0.25)));
  const glm::dvec3 normal = plane.rotation[2];
  const test::VoxelScene scene = bake(plane, s, 2, glm::dvec3(-0.11), glm::dvec3(0.11));
  const Voxmap voxmap = test::make_voxmap(scene);
  test::PointPart part;
  part.voxel_size_m = s;
  for (const std::size_t i : test::curve_order(shell.points_m, shell.radius_m)) {
    const auto& p = shell.points_m[i];
    const auto& n = shell.normals[i];
    part.add({p.x, p.y, p.z}, {n.x, n.y, n.z});
  }
  const Pshell pshell = test::make_pshell(part);
  query::ContactQuery query(voxmap, pshell);
  query::CollectedPoints points;
  points.reserve(shell.points_m.size());
  Pose pose;
  pose.orientation = glm::quat_cast(plane.rotation);
  pose.position_m = normal * (height_m + 1.75 * norm1(normal) * s);
  query.run(pose, points);
  field::FieldSamples samples;
  samples.reserve(points.count);
  const double count = points.count;
  const field::LevelField level(voxmap);
  const field::TangentPlaneField tangent_plane(s);
  // In turns, so that all meet the machine in the same states.
  double level_ns = 1e300, tangent_ns = 1e300, query_ns = 1e300;
  for (int turn = 0; turn < 20; ++turn) {
    constexpr double kTurnS = 0.1;
    level_ns =
        std::min(level_ns, least_ns(kTurnS, kCalls, [&] { level.measure(points, samples); }));
    tangent_ns = std::min(
        tangent_ns, least_ns(kTurnS, kCalls, [&] { tangent_plane.measure(points, samples); }));
    query_ns = std::min(query_ns, least_ns(kTurnS, kCalls, [&] { query.run(pose, points); }));
  }
  double cold_ns = 1e300;
  for (int i = 0; i < 20; ++i) {
    const field::LevelField fresh(voxmap);
    cold_ns = std::min(cold_ns, least_ns(0, 1, [&] { fresh.measure(points, samples); }));
  }
  const double ratio = (query_ns + level_ns) / (query_ns + tangent_ns);
  std::printf(
      "cost of %s, one core: %u of %zu points collected; per point level %.2f ns (every brick new: "
      "%.1f), tangent plane %.2f ns; query %.1f us; frame, level over tangent plane: %.3f\n",
      name, points.count, shell.points_m.size(), level_ns / count, cold_ns / count,
      tangent_ns / count, query_ns / 1000, ratio);
  return {{"part", name},
          {"shell_points", shell.points_m.size()},
          {"collected_points", points.count},
          {"level_ns_per_point", level_ns / count},
          {"level_every_brick_new_ns_per_point", cold_ns / count},
          {"tangent_plane_ns_per_point", tangent_ns / count},
          {"query_ns", query_ns},
          {"frame_level_over_tangent_plane", ratio},
          {"distances",
           {measure_distance_cost(VoxelKind::kFull, plane, s, pshell, height_m, level, points)}}};
}

// Finer voxels mean more points, which average over the lattice as more orientations do.
int orientations_at(double s_units) { return s_units > 0.3 ? 8 : s_units > 0.2 ? 4 : 2; }

Json judge_sizes(const Choice& choice) {
  Json sizes;
  const auto judge = [&](double s, double cover) {
    sizes.push_back(judge_all(choice, s, cover, orientations_at(s)));
  };
  if (choice.only_s > 0) {
    judge(choice.only_s, choice.cover);
    return sizes;
  }
  for (const double s : {1.0, 0.5, 0.25, 0.125}) judge(s, kPaperCover);
  judge(0.5, kPaperCover / 2);
  return sizes;
}

int run(int argc, char** argv) {
  CLI::App app{"Force models against exact distances, on analytic contacts", "force_bench"};
  Choice choice;
  const auto size =
      app.add_option("--s", choice.only_s, "voxel size, in units of 10 mm (default: all)")
          ->check(CLI::PositiveNumber);
  app.add_option("--cover", choice.cover, "covering radius, voxels")
      ->check(CLI::PositiveNumber)
      ->needs(size);
  std::vector<std::string> names;
  for (const Combination& combination : combinations()) names.push_back(combination.name);
  const auto contact =
      app.add_option("--contact", choice.only, "\"sphere on plane\", ... (default: all)")
          ->check(CLI::IsMember(names));
  CLI::Option* const cost =
      app.add_flag("--cost", choice.cost, "times instead")->excludes(size)->excludes(contact);
  app.add_option("--vectors", choice.vectors, "AVX2, SSE4, ...: none wider")->needs(cost);
  app.add_option("--json", choice.json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  const Json about = machine();
  std::printf("%s, %s\n", about["cpu"].get<std::string>().c_str(),
              about["date"].get<std::string>().c_str());
  Json results;
  if (!choice.vectors.empty()) use_vectors(choice.vectors);
  if (choice.cost) {
    const double cover_m = kPaperCover * 0.0025;
    results.push_back(
        measure_cost("a box lying flush", box_shell({0.08, 0.06, 0.04}, cover_m), 0.04));
    results.push_back(measure_cost("a sphere", sphere_shell(0.1, cover_m), 0.1));
    write_report("force_cost", argc, argv, results, choice.json);
    return 0;
  }
  const double start = cpu_s();
  results["sizes"] = judge_sizes(choice);
  results["cpu_seconds"] = cpu_s() - start;
  std::printf("%.1f CPU seconds\n", cpu_s() - start);
  write_report(choice.only_s > 0 ? "force_part" : "force", argc, argv, results, choice.json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("force_bench", forcelayer::bench::run, argc, argv);
}
