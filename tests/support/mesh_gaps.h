// The gaps between a part and a scene, both meshes, by exact distances of all pairs of features
// that are near each other: corners and triangles, edges and edges. The least is the distance of
// the meshes; each is smooth while its features face each other.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "formats/mesh/mesh.h"
#include "pointshell/part/triangle_tree.h"
#include "tests/support/rigid_contact.h"

namespace forcelayer::test {

class MeshGaps {
 public:
  // `scene` in the world, `part` about its center, m; gaps beyond `reach_m` are left out.
  MeshGaps(const mesh::Mesh& scene, const mesh::Mesh& part, double standoff_m, double reach_m)
      : MeshGaps(scene, soup_of(part), standoff_m, reach_m) {}
  // The same for points alone, about the part's center, with nothing between them.
  MeshGaps(const mesh::Mesh& scene, const std::vector<glm::dvec3>& points_m, double standoff_m,
           double reach_m)
      : MeshGaps(scene, soup_of(points_m), standoff_m, reach_m) {}
  MeshGaps(const MeshGaps&) = delete;  // the trees know the soups

  std::vector<Gap> operator()(const Pose& pose) {
    if (!near_of_ || way_m(*near_of_, pose) > kSlackM) find_near(pose);
    std::vector<Gap> gaps;
    for (const Pair& pair : near_) {
      const Gap gap = gap_of(pair, pose);
      if (gap.gap_m < reach_m_) gaps.push_back(gap);
    }
    return gaps;
  }

 private:
  static constexpr double kSlackM = 0.0005;
  static constexpr double kAheadM = 0.01;  // farther than needed is searched, so that it holds

  // A triangle, an edge or a corner: what is missing repeats the last.
  using Feature = std::array<std::uint32_t, 3>;
  using Corners = std::array<glm::dvec3, 3>;
  struct Pair {
    Feature of_scene, of_part;
    auto operator<=>(const Pair&) const = default;
  };

  struct Surface {
    part::Part soup;
    part::TriangleTree tree;
    std::vector<Feature> edges;

    explicit Surface(part::Part triangles) : soup(std::move(triangles)), tree(soup) {
      for (const auto& t : soup.triangles) {
        for (std::size_t n = 0; n < 3; ++n) edges.push_back(edge_of(t, n));
      }
      std::sort(edges.begin(), edges.end());
      edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    }
    Corners at(const Feature& f) const {
      return {glm_of(soup.vertices[f[0]]), glm_of(soup.vertices[f[1]]),
              glm_of(soup.vertices[f[2]])};
    }
  };

  MeshGaps(const mesh::Mesh& scene, part::Part part, double standoff_m, double reach_m)
      : scene_(soup_of(scene)), part_(std::move(part)), standoff_m_(standoff_m), reach_m_(reach_m) {
    for (const part::Vec3& v : part_.soup.vertices) {
      radius_m_ = std::max(radius_m_, glm::length(glm_of(v)));
    }
    far_m_.resize(part_.soup.vertices.size() + scene_.soup.vertices.size() + part_.edges.size());
  }

  static glm::dvec3 glm_of(const part::Vec3& v) { return {v.x, v.y, v.z}; }
  static part::Vec3 vec3_of(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
  static part::Part soup_of(const mesh::Mesh& mesh) {
    mesh::Assembly assembly;
    assembly.meshes = {mesh};
    assembly.instances = {{0, "mesh", {}}};
    assembly.meters_per_unit = 1;
    const part::PartInput input{&assembly, 1};
    return std::move(part::assemble_part({&input, 1}).value());
  }
  static part::Part soup_of(const std::vector<glm::dvec3>& points_m) {
    part::Part soup;
    for (const glm::dvec3& p : points_m) soup.vertices.push_back(vec3_of(p));
    return soup;
  }
  static Feature edge_of(const Feature& t, std::size_t n) {
    const auto [a, b] = std::minmax(t[n], t[(n + 1) % 3]);
    return {a, b, b};
  }
  Corners in_part(const Feature& f, const Pose& pose) const {
    Corners corners = part_.at(f);
    for (glm::dvec3& p : corners) p = pose.orientation * p + pose.position_m;
    return corners;
  }
  double way_m(const Pose& a, const Pose& b) const {
    return glm::length(b.position_m - a.position_m) +
           radius_m_ * glm::length(coupling::rotation_vector(b.orientation *
                                                             glm::conjugate(a.orientation)));
  }

  // The nearest positions on two segments: where both lines are nearest, moved into the segments.
  static std::array<glm::dvec3, 2> near_on_edges(const glm::dvec3& a, const glm::dvec3& b,
                                                 const glm::dvec3& c, const glm::dvec3& d) {
    const glm::dvec3 u = b - a, v = d - c, w = a - c;
    const double uu = glm::dot(u, u), vv = glm::dot(v, v), uv = glm::dot(u, v);
    const double uw = glm::dot(u, w), vw = glm::dot(v, w), area2 = uu * vv - uv * uv;
    double on_u = area2 > 0 ? std::clamp((uv * vw - vv * uw) / area2, 0.0, 1.0) : 0;
    const double on_v = vv > 0 ? std::clamp((uv * on_u + vw) / vv, 0.0, 1.0) : 0;
    on_u = uu > 0 ? std::clamp((uv * on_v - uw) / uu, 0.0, 1.0) : 0;
    return {a + on_u * u, c + on_v * v};
  }
  static glm::dvec3 near_on_triangle(const glm::dvec3& place, const Corners& t) {
    return glm_of(
        part::nearest_on_triangle(vec3_of(place), vec3_of(t[0]), vec3_of(t[1]), vec3_of(t[2])));
  }
  Gap gap_of(const Pair& pair, const Pose& pose) const {
    const Corners scene = scene_.at(pair.of_scene), part = in_part(pair.of_part, pose);
    std::array<glm::dvec3, 2> near{scene[0], part[0]};
    if (pair.of_scene[0] == pair.of_scene[1]) {
      near[1] = near_on_triangle(scene[0], part);
    } else if (pair.of_part[0] == pair.of_part[1]) {
      near[0] = near_on_triangle(part[0], scene);
    } else {
      near = near_on_edges(scene[0], scene[1], part[0], part[1]);
    }
    const glm::dvec3 away = near[1] - near[0];
    const double distance_m = glm::length(away);
    return {distance_m - standoff_m_, distance_m > 0 ? away / distance_m : glm::dvec3(0), near[1]};
  }

  // The pairs whose gap can be below the reach while the part is near this pose. Of what a corner,
  // or an edge of the part, faces, only the nearest count.
  void find_near(const Pose& pose) {
    const double within_m = standoff_m_ + reach_m_ + 2 * kSlackM;
    near_.clear();
    if (near_of_) gone_m_ += way_m(*near_of_, pose);
    auto far_m = far_m_.begin();
    const auto add = [&](const Surface& surface, const glm::dvec3& middle, double half_m,
                         const auto& pairs_of) {
      double& known_m = *far_m++;
      if (known_m - gone_m_ > within_m + half_m) return;
      const double search_m = within_m + half_m + kAheadM;
      const auto nearest = surface.tree.nearest(vec3_of(middle), search_m);
      const double distance_m = nearest.found ? std::sqrt(nearest.distance_squared) : search_m;
      known_m = distance_m + gone_m_;
      if (distance_m > within_m + half_m) return;
      const double most_m = std::min(within_m, distance_m + half_m + 2 * kSlackM);
      surface.tree.visit_near(vec3_of(middle), most_m + half_m, [&](std::uint32_t triangle) {
        pairs_of(surface.soup.triangles[triangle], [&](const Pair& pair) {
          if (gap_of(pair, pose).gap_m + standoff_m_ < most_m) near_.push_back(pair);
        });
      });
    };
    for (std::uint32_t v = 0; v < part_.soup.vertices.size(); ++v) {
      add(scene_, in_part({v, v, v}, pose)[0], 0, [&](const Feature& t, const auto& keep) {
        keep(Pair{t, {v, v, v}});
      });
    }
    for (std::uint32_t v = 0; v < scene_.soup.vertices.size(); ++v) {
      const glm::dvec3 place =
          glm::conjugate(pose.orientation) * (glm_of(scene_.soup.vertices[v]) - pose.position_m);
      if (glm::length(place) > radius_m_ + within_m) {
        ++far_m;
        continue;
      }
      add(part_, place, 0, [&](const Feature& t, const auto& keep) { keep(Pair{{v, v, v}, t}); });
    }
    for (const Feature& edge : part_.edges) {
      const Corners corners = in_part(edge, pose);
      add(scene_, (corners[0] + corners[1]) / 2.0, glm::distance(corners[0], corners[1]) / 2,
          [&](const Feature& t, const auto& keep) {
            for (std::size_t n = 0; n < 3; ++n) keep(Pair{edge_of(t, n), edge});
          });
    }
    std::sort(near_.begin(), near_.end());
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
    near_of_ = pose;
  }

  Surface scene_, part_;
  double standoff_m_, reach_m_, radius_m_ = 0;
  // For every corner, and edge of the part, in the order of find_near(): its least possible
  // distance from the other surface, plus the way gone_m_ that the part had gone when that was
  // found.
  std::vector<double> far_m_;
  double gone_m_ = 0;
  std::optional<Pose> near_of_;
  std::vector<Pair> near_;
};

}  // namespace forcelayer::test
