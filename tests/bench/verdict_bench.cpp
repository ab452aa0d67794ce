// A verdict of voxcheck --exact or of forcelayer study, confirmed pose by pose: at each pose of the
// path FCL measures the distance of the meshes anew, and vertices tell how deep they go into the
// objects of the seat. It knows neither voxels nor points, nor anything between poses.
//
//   verdict_bench ASSEMBLY#PART --check verdict.json --path path.csv --voxel-size 1mm
//                 [--without NODE]... [--units U] [--seat-poses N] [--json FILE]
//
// Exit status 1 where a pose contradicts the verdict.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <glm/geometric.hpp>
#include <numbers>
#include <set>
#include <stdexcept>

#include "formats/command/quantity.h"
#include "formats/mesh/scene.h"
#include "formats/path/path_file.h"
#include "tests/bench/bench_report.h"
#include "tests/stress/exact_distance.h"

namespace forcelayer::bench {
namespace {

using Json = nlohmann::ordered_json;
using Corners = std::array<glm::dvec3, 3>;
using Triangles = std::vector<Corners>;

// FCL's error, as that of voxcheck-exact, and the step in which it tells where a stretch ends.
constexpr double kRounding = 0x1p-24;

template <typename T>
T take(Result<T> result) {
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

Pose pose_of(const PathRow& row) {
  const auto& p = row.position_m;
  const auto& q = row.orientation_wxyz;
  return {{p[0], p[1], p[2]}, {q[0], q[1], q[2], q[3]}};
}

// The objects of a scene as one mesh, m: those that are chosen.
template <typename IsChosen>
mesh::Mesh united(const mesh::Scene& scene, const IsChosen& is_chosen) {
  mesh::Mesh all;
  for (const mesh::MeshObject& object : scene.objects) {
    if (!is_chosen(object.name)) continue;
    const mesh::Mesh& own = scene.mesh_of(object);
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    for (const mesh::Vec3d& v : own.vertices)
      all.vertices.push_back(apply(object.world_from_mesh, v));
    for (const mesh::Triangle& t : own.triangles) {
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  }
  return all;
}

Triangles placed(const mesh::Mesh& mesh, const Pose& pose) {
  Triangles all;
  for (const mesh::Triangle& t : mesh.triangles) {
    Corners corners;
    for (std::size_t n = 0; n < 3; ++n) {
      const mesh::Vec3d& v = mesh.vertices[t[n]];
      corners[n] = pose.position_m + pose.orientation * glm::dvec3(v[0], v[1], v[2]);
    }
    all.push_back(corners);
  }
  return all;
}

double to_segment_m(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const double square = glm::dot(b - a, b - a);
  const double share = square > 0 ? std::clamp(glm::dot(p - a, b - a) / square, 0.0, 1.0) : 0;
  return glm::length(p - a - share * (b - a));
}

double to_triangle_m(const glm::dvec3& p, const Corners& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area = glm::length(normal);
  bool inside = area > 0;
  double least_m = 1e300;
  for (std::size_t n = 0; n < 3; ++n) {
    const glm::dvec3 &a = t[n], &b = t[(n + 1) % 3];
    inside = inside && glm::dot(glm::cross(normal, b - a), p - a) >= 0;
    least_m = std::min(least_m, to_segment_m(p, a, b));
  }
  return inside ? std::abs(glm::dot(normal, p - t[0])) / area : least_m;
}

// How deep a place lies in a body, by every triangle of it; 0 outside.
double depth_m(const glm::dvec3& p, const Triangles& body) {
  double turn = 0, least_m = 1e300;
  for (const Corners& t : body) {
    const glm::dvec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    turn += 2 * std::atan2(
                    glm::dot(a, glm::cross(b, c)),
                    la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
  }
  if (std::abs(turn) <= 2 * std::numbers::pi) return 0;
  for (const Corners& t : body) least_m = std::min(least_m, to_triangle_m(p, t));
  return least_m;
}

// The deepest of the corners of one body inside the other, and of the middles of its triangles.
double deepest_m(const Triangles& surface, const Triangles& body) {
  glm::dvec3 low(1e300), high(-1e300);
  for (const Corners& t : body) {
    for (const glm::dvec3& v : t) low = glm::min(low, v), high = glm::max(high, v);
  }
  double deepest = 0;
  for (const Corners& t : surface) {
    for (const glm::dvec3& p : {t[0], t[1], t[2], (t[0] + t[1] + t[2]) / 3.0}) {
      if (glm::any(glm::lessThan(p, low)) || glm::any(glm::greaterThan(p, high))) continue;
      deepest = std::max(deepest, depth_m(p, body));
    }
  }
  return deepest;
}

bool lies_in(double time_s, const Json& stretches, const char* kind = nullptr) {
  return std::any_of(stretches.begin(), stretches.end(), [&](const Json& s) {
    if (kind != nullptr && !s.value(kind, false)) return false;
    return s["from_s"].get<double>() <= time_s && time_s <= s["to_s"].get<double>();
  });
}

struct Inputs {
  std::string part, assembly, check, path, voxel_size, units;
  std::vector<std::string> without;
  std::size_t seat_poses = 12;
};

class Confirmation {
 public:
  explicit Confirmation(const Inputs& inputs) : inputs_(inputs) {
    std::ifstream file(inputs.check);
    check_ = Json::parse(file);
    rows_ = take(read_path(inputs.path, PathOf::kPart));
    std::optional<double> unit_m;
    if (!inputs.units.empty()) unit_m = take(command::parse_unit(inputs.units));
    mesh::SceneReading reading;
    reading.without = inputs.without;
    reading.voxel_size_m = take(command::parse_length(inputs.voxel_size));
    scene_ = take(mesh::read_scene({{inputs.assembly}}, unit_m, reading));
    reading.without.clear();
    part_ = united(take(mesh::read_scene({{inputs.part}}, unit_m, reading)),
                   [](const std::string&) { return true; });
    for (const Json& name : check_["seat"]) seat_.insert(name.get<std::string>());
  }

  Json confirm() {
    const stress::ExactDistance all(united(scene_, [](const auto&) { return true; }), part_);
    const stress::ExactDistance rest(
        united(scene_, [&](const auto& name) { return !seat_.contains(name); }), part_);
    const bool has_rest = seat_.size() < scene_.objects.size();
    const double required_m = check_["required_clearance_m"];
    const double told_m = check_["least_clearance"].value("exact_m", 0.0);
    double least_m = 1e300;
    std::size_t seated = 0, too_near = 0, contradictions = 0;
    for (const PathRow& row : rows_) {
      const bool is_seated = lies_in(row.time_s, check_["seated"]);
      seated += is_seated;
      if (is_seated && !has_rest) continue;
      const double distance_m = (is_seated ? rest : all).at(pose_of(row));
      least_m = std::min(least_m, distance_m);
      too_near += distance_m < required_m;
      if (distance_m < required_m - rounding_m() && !lies_in(row.time_s, check_["violations"])) {
        std::printf("  at %.3f s: %.6f mm, and it is told to be clear\n", row.time_s,
                    1e3 * distance_m);
        ++contradictions;
      }
    }
    contradictions += least_m < told_m - rounding_m();
    Json row{{"part", inputs_.part.substr(inputs_.part.rfind('#') + 1)},
             {"verdict", check_["verdict"]},
             {"poses", rows_.size()},
             {"seated_poses", seated},
             {"told_m", told_m},
             {"least_m", least_m},
             {"too_near", too_near}};
    contradictions += add_seat(row);
    row["contradictions"] = contradictions;
    return row;
  }

 private:
  double rounding_m() const { return 2 * kRounding * largest_m(); }
  double largest_m() const {
    double largest = 0;
    for (const PathRow& row : rows_) {
      for (const double x : row.position_m) largest = std::max(largest, std::abs(x));
    }
    for (const mesh::MeshObject& object : scene_.objects) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        largest = std::max(
            {largest, std::abs(object.box_m.low[axis]), std::abs(object.box_m.high[axis])});
      }
    }
    return largest;
  }

  // The objects of the seat at some of the seated poses, by the vertices.
  std::size_t add_seat(Json& row) const {
    std::vector<Pose> poses;
    std::vector<double> times_s;
    for (const PathRow& path_row : rows_) {
      if (!lies_in(path_row.time_s, check_["seated"])) continue;
      poses.push_back(pose_of(path_row)), times_s.push_back(path_row.time_s);
    }
    double deeper_m = 0, told_deeper_m = 0;
    std::size_t contradictions = 0;
    for (const Json& seat : check_.value("seat_depths", Json::array())) {
      const double installed_m = seat["installed_m"], allowed_m = seat["allowed_m"];
      told_deeper_m = std::max(told_deeper_m, seat["deepest_m"].get<double>() - installed_m);
      const Triangles object =
          placed(united(scene_, [&](const auto& name) { return name == seat["object"]; }), Pose{});
      const std::size_t count = std::min(inputs_.seat_poses, poses.size());
      for (std::size_t n = 0; n < count; ++n) {
        const std::size_t at = count > 1 ? n * (poses.size() - 1) / (count - 1) : 0;
        const Triangles part = placed(part_, poses[at]);
        const double depth = std::max(deepest_m(part, object), deepest_m(object, part));
        deeper_m = std::max(deeper_m, depth - installed_m);
        if (depth > allowed_m && !lies_in(times_s[at], check_["violations"], "pushed_into_seat")) {
          std::printf("  at %.3f s: %.6f mm deep in %s, %.6f mm allowed\n", times_s[at],
                      1e3 * depth, seat["object"].get<std::string>().c_str(), 1e3 * allowed_m);
          contradictions += seat["settled"].get<bool>();
        }
      }
    }
    row["told_deeper_m"] = told_deeper_m;
    row["deeper_m"] = deeper_m;
    return contradictions;
  }

  const Inputs& inputs_;
  Json check_;
  std::vector<PathRow> rows_;
  mesh::Scene scene_;
  mesh::Mesh part_;
  std::set<std::string> seat_;
};

int run(int argc, char** argv) {
  CLI::App app{"A verdict, confirmed pose by pose", "verdict_bench"};
  Inputs inputs;
  std::string json;
  app.add_option("part", inputs.part, "ASSEMBLY#PART, as given to forcelayer study")->required();
  app.add_option("--check", inputs.check, "report of voxcheck --json")->required();
  app.add_option("--voxel-size", inputs.voxel_size,
                 "of the bakes: it decides the triangles of STEP")
      ->required();
  app.add_option("--path", inputs.path, "the path that was checked")->required();
  app.add_option("--without", inputs.without, "other nodes that the scene leaves out")
      ->allow_extra_args(false);
  app.add_option("--units", inputs.units, "unit of meshes whose format defines none");
  app.add_option("--seat-poses", inputs.seat_poses, "at which the seat is looked at");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  const std::size_t hash = inputs.part.rfind('#');
  if (hash == std::string::npos) throw std::runtime_error(inputs.part + " names no part");
  inputs.assembly = inputs.part.substr(0, hash);
  inputs.without.push_back(inputs.part.substr(hash + 1));
  const Json row = Confirmation(inputs).confirm();
  std::printf("%s\n", row.dump().c_str());
  write_report("verdict", argc, argv, Json::array({row}), json);
  return row["contradictions"].get<std::size_t>() > 0 ? 1 : 0;
}

}  // namespace
}  // namespace forcelayer::bench

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("verdict_bench", forcelayer::bench::run, argc, argv);
}
