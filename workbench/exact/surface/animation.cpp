#include "workbench/exact/surface/animation.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <map>
#include <span>

#include "formats/command/provenance.h"
#include "formats/command/text.h"
#include "formats/file/named_file.h"
#include "formats/path/path_edit.h"
#include "runtime/clearance/center_path.h"
#include "runtime/voxcheck/object_names.h"

namespace forcelayer::exact {
namespace {

using mesh::GlbMotion;
using mesh::GlbNode;

constexpr double kWithinM = 1e-6;  // of thinned(): about a step of 32-bit floats at 10 m

// More are no view of a motion, and take long to read: the farthest objects are left out.
constexpr std::size_t kMaxTriangles = 4'000'000;

// The part's color, and those of the scene's objects in turn: pale, so that the part stands out.
constexpr std::array<double, 3> kPartColor{0.85, 0.24, 0.01};
constexpr std::array<std::array<double, 3>, 6> kColors{{{0.30, 0.45, 0.62},
                                                        {0.42, 0.56, 0.40},
                                                        {0.62, 0.57, 0.36},
                                                        {0.45, 0.40, 0.60},
                                                        {0.36, 0.57, 0.58},
                                                        {0.60, 0.45, 0.48}}};

std::array<float, 3> floats_of(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// The node of some triangles: vertices that are equal as floats become one, and triangles that this
// makes a line or a point are left out.
GlbNode node_of(const Surface& surface, std::span<const std::size_t> triangles) {
  GlbNode node;
  std::map<std::array<float, 3>, std::uint32_t> numbers;
  std::vector<mesh::Triangle> kept;
  std::vector<std::array<float, 3>> corners;
  for (const std::size_t n : triangles) {
    const mesh::Triangle& t = surface.triangles[n];
    const std::array<float, 3> p[] = {floats_of(surface.vertices_m[t[0]]),
                                      floats_of(surface.vertices_m[t[1]]),
                                      floats_of(surface.vertices_m[t[2]])};
    if (p[0] == p[1] || p[1] == p[2] || p[2] == p[0]) continue;
    mesh::Triangle triangle{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto number = static_cast<std::uint32_t>(node.vertices_m.size());
      const auto [entry, is_new] = numbers.try_emplace(p[corner], number);
      if (is_new) node.vertices_m.push_back(p[corner]);
      triangle[corner] = entry->second;
    }
    node.triangles.push_back(triangle);
  }
  return node;
}

GlbMotion motion_of(std::vector<PathRow> rows, const Pshell& shell, double radius_m) {
  const auto& c = shell.header().center_m;
  const std::array<double, 3> center_m{c[0], c[1], c[2]};
  rows = thinned(rows, center_m, radius_m, kWithinM);
  const clearance::CenterPath path(rows, {c[0], c[1], c[2]}, radius_m);
  GlbMotion motion;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const auto time_s = static_cast<float>(rows[n].time_s - rows[0].time_s);
    if (n > 0 && !(time_s > motion.times_s.back())) continue;  // the same as a float
    const Pose pose = path.world_from_center({n, 0});
    const auto& q = pose.orientation;
    motion.times_s.push_back(time_s);
    motion.positions_m.push_back(floats_of(pose.position_m));
    motion.rotations_xyzw.push_back({static_cast<float>(q.x), static_cast<float>(q.y),
                                     static_cast<float>(q.z), static_cast<float>(q.w)});
  }
  return motion;
}

// The node's name behind "#", else the file's name without its ending.
std::string name_of(const std::string& input) {
  const NamedFile named = named_file(input);
  if (!named.nodes.empty() && !named.nodes[0].empty()) return named.nodes[0];
  return std::filesystem::path(named.path).stem().string();
}

// An object of the scene: its triangles, and how far its box lies from the box of all motion.
struct Object {
  std::vector<std::size_t> triangles;
  glm::dvec3 low_m{1e300}, high_m{-1e300};

  double distance_m(const glm::dvec3& low, const glm::dvec3& high) const {
    return glm::length(glm::max(glm::dvec3(0), glm::max(low - high_m, low_m - high)));
  }
};

}  // namespace

MovingScene moving_scene(const voxcheck::ExactRequest& request, const Surface& scene,
                         const Voxmap& voxmap, const Surface& part, const Pshell& shell,
                         const std::vector<PathRow>& rows, std::vector<std::string>& warnings) {
  const double radius_m = exact::radius_m(part);
  std::vector<std::size_t> all(part.triangles.size());
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = n;
  MovingScene moving;
  moving.nodes.push_back(node_of(part, all));
  moving.objects.push_back(0);
  moving.away_m.push_back(0);
  moving.nodes[0].name = name_of(request.part_meshes.front());
  moving.nodes[0].color = kPartColor;

  std::map<std::uint32_t, Object> objects;
  for (std::size_t n = 0; n < scene.triangles.size(); ++n) {
    Object& object = objects[scene.object[n]];
    object.triangles.push_back(n);
    for (const std::uint32_t vertex : scene.triangles[n]) {
      object.low_m = glm::min(object.low_m, scene.vertices_m[vertex]);
      object.high_m = glm::max(object.high_m, scene.vertices_m[vertex]);
    }
  }
  const auto& c = shell.header().center_m;
  const PathFacts facts = path_facts(rows, {c[0], c[1], c[2]});
  const glm::dvec3 low_m = glm::dvec3(facts.low_m[0], facts.low_m[1], facts.low_m[2]) - radius_m;
  const glm::dvec3 high_m =
      glm::dvec3(facts.high_m[0], facts.high_m[1], facts.high_m[2]) + radius_m;
  std::vector<std::uint32_t> order;
  for (const auto& [number, object] : objects) order.push_back(number);
  std::ranges::stable_sort(
      order, {}, [&](std::uint32_t number) { return objects[number].distance_m(low_m, high_m); });
  std::size_t triangles = part.triangles.size(), left_out = 0;
  for (const std::uint32_t number : order) {
    triangles += objects[number].triangles.size();
    if (triangles > kMaxTriangles) {
      ++left_out;
      continue;
    }
    GlbNode node = node_of(scene, objects[number].triangles);
    if (node.triangles.empty()) continue;
    node.name = number == 0 ? "scene" : voxcheck::object_name(voxmap, number);
    node.color = kColors[number % kColors.size()];
    moving.nodes.push_back(std::move(node));
    moving.objects.push_back(number);
    moving.away_m.push_back(objects[number].distance_m(low_m, high_m));
  }
  if (left_out > 0) {
    warnings.push_back(
        command::text("the animation leaves out the %zu objects farthest from the path, to have at "
                      "most %zu triangles",
                      left_out, kMaxTriangles));
  }
  moving.motion = motion_of(rows, shell, radius_m);
  moving.motion.name = moving.nodes[0].name;
  // Where the files say nothing, as STEP does, the world is z up like everywhere.
  const bool is_y_up = command::up_in(voxmap.provenance()) == mesh::name_of(mesh::Up::kY);
  moving.up = is_y_up ? mesh::Up::kY : mesh::Up::kZ;
  return moving;
}

}  // namespace forcelayer::exact
