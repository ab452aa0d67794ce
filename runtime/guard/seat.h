// The seat of a part that starts installed: the objects that it touches there, and how near to each
// of them it may come while its seat is open.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace forcelayer::guard {

// An object of the seat. Distances are interpolated stored distances from its surface, negative
// inside.
struct SeatObject {
  std::uint32_t object = 0;  // its number in the file; 0 where the file names none
  // Where the force begins: 0.15 voxels before the surface, or as near or as deep as the part lies
  // in the seat, and half a step of the stored distances deeper.
  float contact_m = 0;
  float installed_m = 0;     // how deep the part lies in the seat: of its deepest point, 0 or less
  float floor_m = 0;         // the guard bars shell points below this
  float corner_floor_m = 0;  // and those that touch it in a corner, there, below this
  // The same of what lies between two shell points, where that is felt.
  float between_m = 0, between_floor_m = 0;
  bool feels_between = true;
  bool runs_through = false;  // as a sheet or plate through the part, from one side to the other
  std::uint32_t points = 0;   // how many shell points touch it in the seat
  double overlap_m = 0;       // depth of the deepest shell point in the seat, 0 or more
};

// How many shell points touch an object of a seat.
inline std::uint64_t points_in_seat(std::span<const SeatObject> objects) {
  std::uint64_t points = 0;
  for (const SeatObject& object : objects) points += object.points;
  return points;
}

// Which depth decides whether a part may start installed: that of the stored distances, or that of
// the meshes, whatever the bake filled.
enum class SeatDepth { kStored, kOfMeshes };

class Seat {
 public:
  bool empty() const { return objects_.empty(); }
  std::span<const SeatObject> objects() const { return objects_; }  // ascending by number

  // The object's entry; null where it is not of the seat.
  const SeatObject* find(std::uint32_t object) const noexcept {
    const auto at = std::lower_bound(
        objects_.begin(), objects_.end(), object,
        [](const SeatObject& of_seat, std::uint32_t number) { return of_seat.object < number; });
    return at != objects_.end() && at->object == object ? &*at : nullptr;
  }

  // The object's entry, added where there is none. Set-up only.
  SeatObject& at(std::uint32_t object) {
    const auto place = std::lower_bound(
        objects_.begin(), objects_.end(), object,
        [](const SeatObject& of_seat, std::uint32_t number) { return of_seat.object < number; });
    if (place != objects_.end() && place->object == object) return *place;
    SeatObject entry;
    entry.object = object;
    return *objects_.insert(place, entry);
  }
  std::span<SeatObject> entries() { return objects_; }

 private:
  std::vector<SeatObject> objects_;
};

}  // namespace forcelayer::guard
