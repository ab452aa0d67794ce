// The seat's look-ups for as many points at a time as the machine's vectors hold: the nearest
// objects, the rule for a point, and the searches for the few points that need more. Every width of
// vectors gives the bits that the same arithmetic gives for one point after the other.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/field/contact_set.h"
#include "runtime/field/field_probe.h"
#include "runtime/guard/seat.h"

namespace forcelayer::guard {

// A point whose interpolated distance has at least this slope lies in front of one face.
inline constexpr float kFaceSlope = 0.9f;
// Within a cell through which a thin wall leads, the slope is short, and of one direction on both
// sides. One that is at least this steep tells a point's side.
inline constexpr float kSureSlope = 0.5f;

// The number of the object nearest to each point. A point mostly stays in its voxel from one
// look-up to the next, and so does its object: the last voxel and object of each shell point are
// remembered. No answer depends on what is remembered.
class NearestObjects {
 public:
  // The probe must outlive this.
  explicit NearestObjects(const field::FieldProbe& probe) : probe_(probe) {}

  // Makes room for the points of a shell. Set-up only.
  void reserve(std::size_t points);

  // The numbers for the points that the probe queried last, in their order; 0 where the map names
  // none. Valid until the next call. As FieldProbe::object_of().
  const std::int32_t* find() noexcept;

 private:
  const field::FieldProbe& probe_;
  std::array<std::vector<std::int32_t>, 3> voxel_;  // by shell point, x, y and z
  std::vector<std::int32_t> object_;                // by shell point
  std::vector<std::int32_t> found_;
  std::vector<std::uint32_t> moved_;  // places of points in another voxel than last
};

// A seat in columns.
struct SeatTables {
  static constexpr std::size_t kNumbers = 1 << 16;  // a map names at most so many objects

  explicit SeatTables(const Seat& seat);

  std::vector<std::int32_t> of_number;  // place of an object in the columns; -1: not of the seat
  std::vector<float> contact_m, floor_m, corner_floor_m;  // as in SeatObject
};

// Arguments of press_points() beside the probe.
struct SeatPress {
  const std::int32_t* object;  // of NearestObjects
  const SeatTables& tables;
  // By shell point, as in SeatRule. `in_seat_steepness` is null where the part touches in no
  // corner.
  const float *in_seat_m, *in_seat_steepness;
  bool in_corners;  // whether the part lies in the corners of its seat
  float corner_m;   // points nearer than this touch in a corner
  bool by_value;    // PointRule::goes_by_value()
};

// The rule of the seat for each point that is near an object of it: SeatRule::apply() but for what
// lies between two points. Sets the counts and columns of `out`.
void press_points(const field::FieldProbe& probe, const SeatPress& press,
                  field::ContactSet& out) noexcept;

// How many points of the last query touch in a corner of the scene, among those with a value below
// 1 in `in_seat_steepness`.
std::uint32_t count_in_corners(const field::FieldProbe& probe, const float* in_seat_steepness,
                               float corner_m) noexcept;

// A point of two sets: its places in them.
struct PointPair {
  std::uint32_t earlier, later;
};

// Both sets have their points in ascending order. Writes the points of the seat in both that may
// have gone through a surface: those nearer than `sheet_m` in `later`, the set of the last query,
// whose slope there is against their side in `earlier` or less than `clear_slope` along their
// normal; or all that near, where the shell has points without an inside. `pairs` has room for all
// points. Returns their number.
std::size_t find_turned(const field::FieldProbe& probe, const field::ContactSet& earlier,
                        const field::ContactSet& later, float sheet_m, float clear_slope,
                        PointPair* pairs) noexcept;

// Which points an edge may stand beside: BetweenPoints::for_each_edge().
struct TiltedSearch {
  float near_m;                // farther points are left out
  float gentle_m;              // gently tilted points that are farther are left out
  float gentle2, flat2;        // squared sines of the least tilt, and of that which is not gentle
  float highest_m, reach2_m2;  // edges are sought below this, no farther than the root of that
};

// Writes the points of the last query that are tilted, by their places, ascending. Both columns
// have room for all points. Returns the numbers of both.
struct TiltedPoints {
  std::size_t steep, gentle;
};
TiltedPoints find_tilted(const field::FieldProbe& probe, const TiltedSearch& search,
                         std::uint32_t* steep, std::uint32_t* gentle) noexcept;

}  // namespace forcelayer::guard
