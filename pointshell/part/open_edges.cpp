#include "pointshell/part/open_edges.h"

#include <algorithm>
#include <cstdlib>

namespace forcelayer::part {

std::map<Edge, int> open_edges_of(const std::vector<mesh::Triangle>& triangles) {
  std::map<Edge, int> balance;
  for (const mesh::Triangle& t : triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t from = t[n], to = t[(n + 1) % 3];
      if (from != to) balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  std::erase_if(balance, [](const auto& edge) { return edge.second == 0; });
  return balance;
}

Part caps_of(const Part& body, const std::map<Edge, int>& open) {
  std::map<std::uint32_t, std::uint32_t> leader;  // [vertex] another of the same group, or itself
  const auto group_of = [&](std::uint32_t vertex) {
    while (leader.at(vertex) != vertex) vertex = leader[vertex] = leader.at(leader.at(vertex));
    return vertex;
  };
  for (const auto& [edge, balance] : open) {
    leader.try_emplace(edge.first, edge.first);
    leader.try_emplace(edge.second, edge.second);
    leader[group_of(edge.first)] = group_of(edge.second);
  }
  Part caps;
  caps.vertices = body.vertices;
  struct Middle {
    Vec3 sum;
    std::uint32_t count = 0, number = 0;
  };
  std::map<std::uint32_t, Middle> middles;  // [group]
  for (const auto& [vertex, other] : leader) {
    Middle& middle = middles[group_of(vertex)];
    middle.sum += body.vertices[vertex];
    ++middle.count;
  }
  for (auto& [group, middle] : middles) {
    middle.number = static_cast<std::uint32_t>(caps.vertices.size());
    caps.vertices.push_back((1.0 / middle.count) * middle.sum);
  }
  for (const auto& [edge, balance] : open) {
    const std::uint32_t middle = middles.at(group_of(edge.first)).number;
    const auto [from, to] =
        balance > 0 ? std::pair(edge.second, edge.first) : std::pair(edge.first, edge.second);
    for (int n = 0; n < std::abs(balance); ++n) caps.triangles.push_back({from, to, middle});
  }
  return caps;
}

}  // namespace forcelayer::part
