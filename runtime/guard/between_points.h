// Edges of the scene that dig into the part's surface between two shell points.
//
// Where the stored distance falls from both points toward each other along the part's surface,
// something stands between them. Along the surface from point a to point b, at the fraction t of
// the path, the distances
//   D_a - f_a t   and   D_b - f_b (1 - t)
// are those of the two planes that face the points. They meet at the edge, so the distance there is
//   D = D_a - f_a t,   t = (D_a - D_b + f_b) / (f_a + f_b),   where 0 < t < 1.
// A convex edge between two plane faces has exactly that distance; one that is round lies a little
// deeper in the scene. The slopes that D has with the part's pose are those of the two points with
// the weights f_b and f_a over their sum, and so are its position and its push.
//
// One of the two faces may be tilted little: a pin that leans in its bore meets the rim of the bore
// with its side. Where neither is tilted by more than some 12 degrees, nothing is felt.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "runtime/field/field_probe.h"
#include "runtime/guard/seat.h"
#include "runtime/query/shell_neighbors.h"

namespace forcelayer::guard {

// All functions read the points that the probe queried last.
class BetweenPoints {
 public:
  explicit BetweenPoints(const field::FieldProbe& probe) : probe_(probe) {}

  // Finds how deep each object of a seat lies between points, SeatObject::between_m, and whether it
  // runs through the part. Set-up only.
  void find(const Pose& world_from_center, Seat& seat);
  // Presses and bars the points beside an edge that is deeper than in the seat.
  void press(const Seat& seat, field::ContactSet& out) noexcept;
  // Whether press() bars a point, objects with a mark in `left_out` apart.
  bool bars_any(const Seat& seat, std::span<const std::uint8_t> left_out) noexcept;

 private:
  struct Edge {
    float distance_m = 0;
    float weight = 0;  // of the first point; the second has the rest
    std::uint32_t object = 0;
  };

  std::optional<Edge> edge_between(std::uint32_t a, std::uint32_t b) const noexcept;
  bool runs_through(const Pose& world_from_center, std::uint32_t a, std::uint32_t b,
                    const Edge& edge) const;
  template <typename Take>
  void for_each_edge(float highest_m, float gentle_m, const Take& take) noexcept;
  float gentle_reach_m(float onset_m) const noexcept;
  void press_pair(std::uint32_t a, std::uint32_t b, const Edge& edge, const Seat& seat,
                  field::ContactSet& out) const noexcept;

  const field::FieldProbe& probe_;
  // Which points are neighbors; made with the first seat.
  std::optional<query::ShellNeighbors> neighbors_;
  float neighbor_m_ = 0;  // so near two of them are
  // The position of each shell point among the collected points, where it is one of steep_ or, with
  // kGentle added, of gentle_.
  static constexpr std::uint32_t kGentle = 1u << 31;
  std::vector<std::uint32_t> position_, steep_, gentle_;
};

}  // namespace forcelayer::guard
