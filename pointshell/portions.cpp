#include "pointshell/portions.h"

#include <algorithm>

#include "pointshell/sample/stored_position.h"

namespace forcelayer::pointshell {
namespace {

Portion portion_of(const part::Part& part, std::span<const std::uint32_t> bodies,
                   std::span<const std::vector<std::uint32_t>> of_body) {
  Portion portion;
  portion.own_part = std::make_unique<part::Part>(part::part_of_bodies(part, bodies, of_body));
  portion.own_tree = std::make_unique<part::TriangleTree>(*portion.own_part);
  portion.part = portion.own_part.get();
  portion.tree = portion.own_tree.get();
  return portion;
}

}  // namespace

std::vector<Portion> portions_of(const part::TriangleTree& tree, double radius,
                                 const part::Vec3& center,
                                 std::span<const part::CopiedGroup> groups) {
  const part::Part& part = tree.part();
  std::vector<Portion> portions;
  if (groups.empty()) {
    Portion& whole = portions.emplace_back();
    whole.part = &part;
    whole.tree = &tree;
    whole.radius = radius;
    return portions;
  }
  const auto of_body = part::triangles_by_body(part);
  std::vector<bool> is_in_group(of_body.size());
  for (const part::CopiedGroup& group : groups) {
    Portion portion = portion_of(part, group.bodies, of_body);
    portion.slack = group.slack_m;
    portion.radius = radius - group.slack_m;
    for (const std::uint32_t body : group.bodies) is_in_group[body] = true;
    for (const part::Copy& copy : group.copies) {
      portion.copies.push_back(part::relative_to(copy.from_original, center));
      for (const std::uint32_t body : copy.bodies) is_in_group[body] = true;
    }
    portions.push_back(std::move(portion));
  }
  std::vector<std::uint32_t> others;
  for (std::uint32_t body = 0; body < of_body.size(); ++body) {
    if (!is_in_group[body] && !of_body[body].empty()) others.push_back(body);
  }
  if (!others.empty()) {
    portions.push_back(portion_of(part, others, of_body));
    portions.back().radius = radius;
  }
  return portions;
}

std::vector<part::Vec3> all_points(std::span<const Portion> portions) {
  std::vector<part::Vec3> points;
  for (const Portion& portion : portions) {
    points.insert(points.end(), portion.points.begin(), portion.points.end());
    for (const part::Motion& motion : portion.copies) {
      for (const part::Vec3& p : portion.points) {
        points.push_back(sample::as_stored(motion.moved(p)));
      }
    }
  }
  return points;
}

void unite(certificate::SurfaceLosses& all, const certificate::SurfaceLosses& own) {
  all.pieces += own.pieces;
  all.convex_radius = std::max(all.convex_radius, own.convex_radius);
  all.convex_gap = std::max(all.convex_gap, own.convex_gap);
  if (all.losses.empty()) all.losses = own.losses;
  for (std::size_t n = 0; n < own.losses.size(); ++n) {
    all.losses[n].loss_m = std::max(all.losses[n].loss_m, own.losses[n].loss_m);
  }
}

}  // namespace forcelayer::pointshell
