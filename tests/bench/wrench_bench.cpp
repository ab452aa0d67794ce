// Contact wrench against truth, and what a frame costs, beside mesh colliders: every method on the
// same contacts, poses and offset surface, one offset and one gain fitted to each.
//
//   wrench_bench [--contact NAME]... [--s S]... [--orientations N] [--json FILE]
//
// S are voxel sizes in units of 10 mm. METHOD.md says what the oracle is.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <iostream>
#include <map>

#include "runtime/level_field.h"
#include "runtime/surface_directions.h"
#include "runtime/tangent_plane.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/force_bench_contacts.h"
#include "tests/bench/wrench_bench_meshes.h"
#include "tests/bench/wrench_bench_peers.h"
#include "tests/support/curve_order.h"
#include "tests/support/point_part.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;

// A mesh deviates from the body by at most this share of a voxel: far below what is measured.
constexpr double kDeviationVoxels = 0.02;

Pshell pshell_of(const AnalyticShell& shell, double voxel_size_m) {
  test::PointPart part;
  part.voxel_size_m = voxel_size_m;
  for (const std::uint32_t i : test::curve_order(shell.points_m, shell.radius_m)) {
    const auto& p = shell.points_m[i];
    const auto& n = shell.normals[i];
    part.add({p.x, p.y, p.z}, {n.x, n.y, n.z});
  }
  return test::make_pshell(part);
}

Pose pose_of(const ContactCase::Placed& placed) {
  return {placed.position_m, glm::quat_cast(placed.rotation)};
}

// One frame of a model from the two files: query, field, sum.
class FrameOfOurs {
 public:
  FrameOfOurs(const Voxmap& voxmap, const Pshell& shell, const ForceField& field, bool averaged)
      : query_(voxmap, shell),
        field_(field),
        averaged_(averaged),
        voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())) {
    points_.reserve(shell.header().point_count);
    samples_.reserve(shell.header().point_count);
    set_.reserve(static_cast<std::uint32_t>(shell.header().point_count));
  }

  Wrench at(const ContactCase::Placed& placed) {
    query_.run(pose_of(placed), points_);
    averaged_ ? field_.measure(points_, samples_) : field_.evaluate(points_, samples_);
    set_.count = samples_.count;
    for (std::uint32_t i = 0; i < set_.count; ++i) {
      set_.contacts[i].direction = {samples_.dx[i], samples_.dy[i], samples_.dz[i]};
      set_.contacts[i].depth_m = samples_.depth_m[i];
    }
    if (averaged_) average_directions(points_, samples_, voxel_size_m_, -voxel_size_m_, set_);
    Wrench sum;
    for (std::uint32_t i = 0; i < set_.count; ++i) {
      if (!(set_.contacts[i].depth_m > 0)) continue;
      const std::uint32_t at = samples_.at[i];
      const glm::dvec3 force =
          double{set_.contacts[i].depth_m} * glm::dvec3(set_.contacts[i].direction);
      const glm::dvec3 arm(points_.rx[at], points_.ry[at], points_.rz[at]);
      sum.force_n += force;
      sum.torque_nm += glm::cross(arm, force);
    }
    return sum;
  }

 private:
  ContactQuery query_;
  const ForceField& field_;
  bool averaged_;
  float voxel_size_m_;
  CollectedPoints points_;
  FieldSamples samples_;
  ContactSet set_;
};

// The same shell in a trilinear OpenVDB level set, every point looked up.
class FrameOfLevelSet {
 public:
  FrameOfLevelSet(const ContactCase& contact, const AnalyticShell& shell)
      : shell_(shell), s_(contact.voxmap().voxel_size_m()), middle_m_(contact.middle_m()) {
    const test::VoxelScene& box = contact.dense().scene;
    grid_ = openvdb::FloatGrid::create(static_cast<float>(4 * s_ + middle_m_));
    auto accessor = grid_->getAccessor();
    openvdb::Coord c;
    for (std::int64_t x = 0; x < box.dims[0]; ++x) {
      for (std::int64_t y = 0; y < box.dims[1]; ++y) {
        for (std::int64_t z = 0; z < box.dims[2]; ++z) {
          const glm::ivec3 v(box.min[0] + x, box.min[1] + y, box.min[2] + z);
          const float distance_m = contact.dense().distance_at(v);
          if (distance_m > grid_->background()) continue;
          c.reset(v.x, v.y, v.z);
          accessor.setValueOn(c, distance_m);
        }
      }
    }
  }

  Wrench at(const ContactCase::Placed& placed) {
    const auto accessor = grid_->getConstAccessor();
    Wrench sum;
    for (std::size_t i = 0; i < shell_.points_m.size(); ++i) {
      const glm::dvec3 arm = placed.rotation * shell_.points_m[i];
      const glm::dvec3 centred = (arm + placed.position_m) / s_ - 0.5, low = glm::floor(centred);
      const openvdb::Coord c(static_cast<int>(low.x), static_cast<int>(low.y),
                             static_cast<int>(low.z));
      float data[2][2][2];
      openvdb::tools::BoxSampler::getValues(data, accessor, c);
      const glm::dvec3 f = centred - low;
      const openvdb::Vec3R uvw(f.x, f.y, f.z);
      const double distance_m = openvdb::tools::BoxSampler::trilinearInterpolation(data, uvw);
      if (!(distance_m < middle_m_)) continue;
      const glm::dvec3 direction = glm::normalize(slope(data, f));
      const glm::dvec3 force = shell_.areas_m2[i] * (middle_m_ - distance_m) * direction;
      sum.force_n += force;
      sum.torque_nm += glm::cross(arm, force);
    }
    return sum;
  }

 private:
  static glm::dvec3 slope(const float (&data)[2][2][2], const glm::dvec3& f) {
    glm::dvec3 sum(0);
    for (int n = 0; n < 8; ++n) {
      const int i = n >> 2, j = n >> 1 & 1, k = n & 1;
      const double x = i ? f.x : 1 - f.x, y = j ? f.y : 1 - f.y, z = k ? f.z : 1 - f.z;
      sum += double{data[i][j][k]} *
             glm::dvec3((i ? 1 : -1) * y * z, (j ? 1 : -1) * x * z, (k ? 1 : -1) * x * y);
    }
    return sum;
  }

  const AnalyticShell& shell_;
  double s_, middle_m_;
  openvdb::FloatGrid::Ptr grid_;
};

// What was measured of one method, over contacts and orientations.
struct Sample {
  std::vector<double> force_error, noise, direction_deg, torque, step, frame_us;
};

struct MethodRun {
  const char* name;
  ContactCase::WrenchAt wrench_at;  // timed, and judged where `judged_as` is none
  std::optional<Method> judged_as;
};

double middle(std::vector<double> values) {
  std::erase_if(values, [](double x) { return !std::isfinite(x); });
  return values.empty() ? NAN : percentiles(std::move(values)).p50;
}

Json to_json(const Sample& sample) {
  return {{"force_error", middle(sample.force_error)},
          {"noise", middle(sample.noise)},
          {"direction_deg", middle(sample.direction_deg)},
          {"torque", middle(sample.torque)},
          {"step", middle(sample.step)},
          {"cases", sample.force_error.size()},
          {"frame_us", to_json(percentiles(sample.frame_us))}};
}

void add(const MethodRun& method, const ContactCase& contact, Sample& sample) {
  const Quality q =
      method.judged_as ? contact.judge(*method.judged_as) : contact.judge(method.wrench_at);
  sample.force_error.push_back(q.force_error);
  sample.noise.push_back(q.noise);
  sample.direction_deg.push_back(q.direction_deg);
  sample.torque.push_back(q.torque);
  sample.step.push_back(q.step);
  for (const ContactCase::Placed& placed : contact.slide()) {
    const double start_s = now_s();
    method.wrench_at(placed);
    sample.frame_us.push_back(1e6 * (now_s() - start_s));
  }
}

using Samples = std::map<std::string, std::map<std::string, Sample>>;  // [group][method]

void judge(const Combination& combination, const PartShells& shells, const Pshell& pshell, double s,
           std::mt19937_64& random, Samples& samples) {
  const ContactCase contact(combination, shells, s, random);
  const double deviation_m = kDeviationVoxels * s;
  const Mesh part = part_mesh(combination.part, deviation_m);
  const Mesh scene = offset_mesh(contact.body(), contact.middle_m(), deviation_m);
  const LevelField level(contact.voxmap());
  const TangentPlaneField tangent_plane(s);
  FrameOfOurs paper(contact.voxmap(), pshell, tangent_plane, false);
  FrameOfOurs field(contact.voxmap(), pshell, level, false);
  FrameOfOurs standard(contact.voxmap(), pshell, level, true);
  FrameOfLevelSet level_set(contact, shells.tested);
  const auto fcl = fcl_contacts(scene, part), bullet = bullet_contacts(scene, part);
  using Placed = ContactCase::Placed;
  const MethodRun methods[] = {
      {"paper: tangent plane, N/10", [&](const Placed& p) { return paper.at(p); },
       Method::kTangentPlaneAveraged},
      {"level field", [&](const Placed& p) { return field.at(p); }, Method::kLevel},
      {"default", [&](const Placed& p) { return standard.at(p); }, Method::kContacts},
      {"shell in a trilinear level set", [&](const Placed& p) { return level_set.at(p); },
       Method::kDistance},
      {"FCL mesh contacts", [&](const Placed& p) { return fcl->at(p); }, std::nullopt},
      {"Bullet mesh contacts", [&](const Placed& p) { return bullet->at(p); }, std::nullopt}};
  for (const MethodRun& method : methods) {
    Sample own;
    add(method, contact, own);
    for (const std::string& group :
         {combination.name,
          std::string(combination.smooth ? "flush and smooth" : "corners and wedges")}) {
      Sample& all = samples[group][method.name];
      const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
        to.insert(to.end(), from.begin(), from.end());
      };
      append(all.force_error, own.force_error);
      append(all.noise, own.noise);
      append(all.direction_deg, own.direction_deg);
      append(all.torque, own.torque);
      append(all.step, own.step);
      append(all.frame_us, own.frame_us);
    }
  }
}

void print(const std::string& group, const Json& rows) {
  std::printf("%s\n  %-32s %8s %7s %7s %8s %8s %9s %9s\n", group.c_str(), "", "force", "noise",
              "deg", "torque", "step", "p50 us", "p99 us");
  for (const auto& [name, row] : rows.items()) {
    const auto at = [&, &values = row](const char* key) {
      return values[key].is_null() ? NAN : values[key].template get<double>();
    };
    std::printf("  %-32s %7.1f%% %6.1f%% %7.2f %8.4f %7.2f%% %9.1f %9.1f\n", name.c_str(),
                100 * at("force_error"), 100 * at("noise"), at("direction_deg"), at("torque"),
                100 * at("step"), row["frame_us"]["p50"].get<double>(),
                row["frame_us"]["p99"].get<double>());
  }
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  CLI::App app{"Contact wrench against truth and time", "wrench_bench"};
  std::vector<double> sizes = {1, 0.5, 0.25};
  int orientations = 4;
  std::vector<std::string> only;
  std::string json;
  app.add_option("--contact", only, "\"sphere on plane\", ... (default: all)");
  app.add_option("--s", sizes, "voxel sizes, in units of 10 mm")->check(CLI::PositiveNumber);
  app.add_option("--orientations", orientations, "of each contact")->check(CLI::PositiveNumber);
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  openvdb::initialize();
  Json results = Json::array();
  for (const double units : sizes) {
    const double s = units * kUnitM;
    std::map<Part, PartShells> shells;
    std::map<Part, Pshell> pshells;
    for (const Part part : {Part::kSphere, Part::kBox, Part::kCylinder}) {
      shells[part] = shells_of(part, s, kPaperCover);
      pshells.emplace(part, pshell_of(shells[part].tested, s));
    }
    Samples samples;
    std::mt19937_64 random(20260101);
    for (const Combination& combination : combinations()) {
      if (combination.standoff) continue;  // judged by what the map holds: for our fields alone
      if (!only.empty() && std::find(only.begin(), only.end(), combination.name) == only.end()) {
        continue;
      }
      for (int i = 0; i < orientations; ++i) {
        judge(combination, shells[combination.part], pshells.at(combination.part), s, random,
              samples);
      }
    }
    Json groups;
    for (const auto& [group, methods] : samples) {
      for (const auto& [method, sample] : methods) groups[group][method] = to_json(sample);
    }
    std::printf("s = %g (%g mm)\n", units, 1000 * s);
    for (const char* group : {"flush and smooth", "corners and wedges"}) {
      if (groups.contains(group)) print(group, groups[group]);
    }
    Json points;
    points["sphere"] = shells[Part::kSphere].tested.points_m.size();
    points["box"] = shells[Part::kBox].tested.points_m.size();
    points["cylinder"] = shells[Part::kCylinder].tested.points_m.size();
    results.push_back({{"s", units},
                       {"voxel_size_m", s},
                       {"orientations", orientations},
                       {"shell_points", points},
                       {"contacts", groups}});
  }
  write_report("wrench", argc, argv, results, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  try {
    return forcelayer::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "wrench_bench: " << error.what() << '\n';
    return 1;
  }
}
