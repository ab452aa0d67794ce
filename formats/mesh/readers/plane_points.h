// Points in a plane that go one by one, and whether a triangle holds one of them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace forcelayer::mesh {

// A k-d tree over the places of the points; points with equal coordinates share a place.
class PlanePoints {
 public:
  struct Point {
    double x, y;
    friend auto operator<=>(const Point&, const Point&) = default;
  };
  static constexpr std::size_t kNone = ~std::size_t{0};

  void assign(std::span<const Point> points);
  std::size_t places() const { return places_.size(); }
  std::size_t place_of(std::size_t point) const { return place_of_[point]; }
  // True where no point is left at its place.
  bool remove(std::size_t point);
  // A place in the triangle or on its edges, but not at a corner; kNone where there is none. The
  // corners are points, counter-clockwise.
  std::size_t find_in(std::size_t a, std::size_t b, std::size_t c) const;

  // Twice the signed area of p, q, r: positive for a turn to the left.
  static double turn(const Point& p, const Point& q, const Point& r) {
    return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  }

 private:
  struct Place {
    Point at;
    std::size_t points;  // that are left there
    std::size_t leaf;
  };
  struct Node {
    Point low, high;  // box of its places
    std::size_t first, last;
    std::size_t parent, left, right;  // no children: kNone
    std::size_t places;               // with points left
  };

  std::size_t build(std::size_t first, std::size_t last, std::size_t parent);

  std::vector<Place> places_;
  std::vector<std::size_t> place_of_;  // [points]
  std::vector<Node> nodes_;            // the root is the first
};

}  // namespace forcelayer::mesh
