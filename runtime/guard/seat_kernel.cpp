#include "runtime/guard/seat_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

// Compiles what follows once per instruction set.
#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/guard/seat_kernel.cpp"
#include <hwy/foreach_target.h>
// Behind foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

// Once, whatever the number of targets.
#ifndef FORCELAYER_SEAT_KERNEL_CONSTANTS
#define FORCELAYER_SEAT_KERNEL_CONSTANTS
namespace forcelayer::guard {
namespace {

// Cosine between gradient and slope of the field, from which on both face the same side: they
// differ by some degrees before a face and up to 30 at an edge, and by up to 180 beside a sheet.
constexpr float kSameSide = 0.7f;

// Columns of the points that the probe queried last. By address: the compiler must assume that a
// store of floats can change the address inside a std::vector.
struct Points {
  explicit Points(const field::FieldProbe& probe)
      : count(probe.count()),
        index(reinterpret_cast<const std::int32_t*>(probe.points().index.data())),
        normal{probe.points().nx.data(), probe.points().ny.data(), probe.points().nz.data()},
        slope{probe.samples().gx.data(), probe.samples().gy.data(), probe.samples().gz.data()},
        gradient{probe.samples().ex.data(), probe.samples().ey.data(), probe.samples().ez.data()},
        from_zero_force_m(probe.samples().from_zero_force_m.data()),
        zero_force_m(probe.zero_force_m()) {}

  std::size_t count;
  const std::int32_t* index;  // of the shell point
  const float *normal[3], *slope[3], *gradient[3];
  const float* from_zero_force_m;
  float zero_force_m;
};

// By how much press_points() changes the counts of a set.
struct PressCounts {
  std::size_t seated = 0, freed = 0, were_barred = 0, barred = 0;
};

// Arguments of find_turned().
struct TurnedSearch {
  const Points& p;
  const field::ContactSet &earlier, &later;
  float sheet_m, clear_slope;
  bool all_near;  // whatever their slope
};

}  // namespace
}  // namespace forcelayer::guard
#endif

HWY_BEFORE_NAMESPACE();
namespace forcelayer::guard {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;
using Ints = hn::RebindToSigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
using MF = hn::Mask<Floats>;
using MI = hn::Mask<Ints>;
constexpr Floats kF;
constexpr Ints kI;
constexpr std::size_t kLanes = HWY_MIN(HWY_LANES(float), 16);
static_assert(field::ContactSet::kPadding >= kLanes);

HWY_INLINE VF dot(const VF (&a)[3], const VF (&b)[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

HWY_INLINE void load(const float* const (&columns)[3], std::size_t i, VF (&v)[3]) {
  for (int axis = 0; axis < 3; ++axis) v[axis] = hn::LoadU(kF, columns[axis] + i);
}

HWY_INLINE VF distance_m(const Points& p, std::size_t i) {
  return hn::Add(hn::Set(kF, p.zero_force_m), hn::LoadU(kF, p.from_zero_force_m + i));
}

HWY_INLINE MF is_zero(const VF (&v)[3]) {
  const VF zero = hn::Zero(kF);
  return hn::And(hn::And(hn::Eq(v[0], zero), hn::Eq(v[1], zero)), hn::Eq(v[2], zero));
}

// Bytes as numbers, and back.
HWY_INLINE VI load_bytes(const std::uint8_t* from) {
  return hn::PromoteTo(kI, hn::LoadU(hn::Rebind<std::uint8_t, Ints>(), from));
}
HWY_INLINE void store_bytes(VI v, std::uint8_t* to) {
  const hn::Rebind<std::uint8_t, Ints> bytes;
  hn::StoreU(hn::DemoteTo(bytes, v), bytes, to);
}

HWY_INLINE MI ints(MF mask) { return hn::RebindMask(kI, mask); }
HWY_INLINE MF floats(MI mask) { return hn::RebindMask(kF, mask); }

// The lanes of a mask as bits.
HWY_INLINE std::uint32_t bits_of(MF mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(kF, mask, bytes);
  return std::uint32_t{bytes[0]} | std::uint32_t{bytes[1]} << 8;
}

template <class Take>
HWY_INLINE void for_each_bit(std::uint32_t bits, const Take& take) {
  for (; bits != 0; bits &= bits - 1) take(static_cast<std::size_t>(std::countr_zero(bits)));
}

// Shell points of a vector of collected points, of which the first `count` are real: mostly they
// follow each other, and their values are loaded at once.
struct ShellPoints {
  HWY_INLINE ShellPoints(const std::int32_t* index, std::size_t count)
      : first(index[0]),
        in_row(count >= kLanes && index[kLanes - 1] == first + static_cast<int>(kLanes) - 1),
        at(hn::IfThenElseZero(hn::FirstN(kI, count), hn::LoadU(kI, index))) {}

  HWY_INLINE VI of(const std::int32_t* column) const {
    return in_row ? hn::LoadU(kI, column + first) : hn::GatherIndex(kI, column, at);
  }
  HWY_INLINE VF of(const float* column) const {
    return in_row ? hn::LoadU(kF, column + first) : hn::GatherIndex(kF, column, at);
  }

  std::int32_t first;
  bool in_row;
  VI at;
};

// NearestObjects::find(): writes what is remembered, and the places of the points that are in other
// voxels; returns their number.
std::size_t recall_on_target(const query::CollectedPoints& points, const std::int32_t* const* known,
                             const std::int32_t* object, std::int32_t* found,
                             std::uint32_t* moved) {
  const auto* index = reinterpret_cast<const std::int32_t*>(points.index.data());
  const std::int32_t* const voxel[3] = {points.vx.data(), points.vy.data(), points.vz.data()};
  std::size_t count = 0;
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    const MI real = hn::FirstN(kI, points.count - i);
    const ShellPoints shell(index + i, points.count - i);
    MI same = real;
    for (int axis = 0; axis < 3; ++axis) {
      const VI there = shell.of(known[axis]);
      same = hn::And(same, hn::Eq(there, hn::LoadU(kI, voxel[axis] + i)));
    }
    hn::StoreU(shell.of(object), kI, found + i);
    for_each_bit(bits_of(floats(hn::AndNot(same, real))),
                 [&](std::size_t lane) { moved[count++] = static_cast<std::uint32_t>(i + lane); });
  }
  return count;
}

// Whether points touch in a corner, there and in the seat: `there` is their steepness in the seat.
HWY_INLINE MF lie_in_corner(VF there, VF distance, VF steepness, float corner_m) {
  return hn::And(hn::And(hn::Lt(there, hn::Set(kF, 1.0f)), hn::Lt(distance, hn::Set(kF, corner_m))),
                 hn::Le(steepness, hn::Set(kF, kFaceSlope)));
}

void count_in_corners_on_target(const Points& p, const float* in_seat_steepness, float corner_m,
                                std::size_t& count) {
  for (std::size_t i = 0; i < p.count; i += kLanes) {
    const MI real = hn::FirstN(kI, p.count - i);
    const ShellPoints shell(p.index + i, p.count - i);
    VF slope[3];
    load(p.slope, i, slope);
    const MF in_corner = lie_in_corner(shell.of(in_seat_steepness), distance_m(p, i),
                                       hn::Sqrt(dot(slope, slope)), corner_m);
    count += hn::CountTrue(kF, hn::And(in_corner, floats(real)));
  }
}

// Where the force begins, of points that touch in a corner in the seat: in the seat itself as deep
// as there, before a face as other points.
VF contact_in_corner(const SeatPress& press, MF of_corner, VF contact, VF there, VF steepness,
                     const std::int32_t* index) {
  HWY_ALIGN float contact_m[kLanes], in_seat[kLanes], now[kLanes];
  hn::Store(contact, kF, contact_m);
  hn::Store(there, kF, in_seat);
  hn::Store(steepness, kF, now);
  for_each_bit(bits_of(of_corner), [&](std::size_t lane) {
    const float fraction = press.in_corners ? (1 - now[lane]) / (1 - in_seat[lane]) : 0;
    contact_m[lane] =
        std::lerp(contact_m[lane], std::min(contact_m[lane], press.in_seat_m[index[lane]]),
                  std::clamp(fraction, 0.0f, 1.0f));
  });
  return hn::Load(kF, contact_m);
}

void press_on_target(const Points& p, const SeatPress& press, field::ContactSet& out,
                     PressCounts& counts) {
  const VF zero = hn::Zero(kF);
  const VI none = hn::Zero(kI), one = hn::Set(kI, 1);
  for (std::size_t i = 0; i < p.count; i += kLanes) {
    const MI real = hn::FirstN(kI, p.count - i);
    const VI number = hn::IfThenElseZero(real, hn::LoadU(kI, press.object + i));
    const VI place = hn::GatherIndex(kI, press.tables.of_number.data(), number);
    const MI of_seat = hn::AndNot(hn::Lt(place, none), real);
    store_bytes(hn::IfThenElseZero(of_seat, one), &out.of_seat[i]);
    if (hn::AllFalse(kI, of_seat)) continue;
    const MF touched = floats(of_seat);
    const VI object = hn::IfThenElseZero(of_seat, place);
    VF slope[3], normal[3], gradient[3], direction[3], push[3], side[3];
    load(p.slope, i, slope), load(p.normal, i, normal), load(p.gradient, i, gradient);
    const VF steepness = hn::Sqrt(dot(slope, slope)), distance = distance_m(p, i);
    VF floor = hn::GatherIndex(kF, press.tables.floor_m.data(), object);
    VF contact = hn::GatherIndex(kF, press.tables.contact_m.data(), object);
    if (press.in_seat_steepness != nullptr) {
      const VF there = ShellPoints(p.index + i, p.count - i).of(press.in_seat_steepness);
      const MF of_corner = hn::And(touched, hn::Lt(there, hn::Set(kF, 1.0f)));
      if (!hn::AllFalse(kF, of_corner)) {
        if (press.in_corners) {
          const VF lower = hn::GatherIndex(kF, press.tables.corner_floor_m.data(), object);
          floor = hn::IfThenElse(lie_in_corner(there, distance, steepness, press.corner_m), lower,
                                 floor);
        }
        contact = contact_in_corner(press, of_corner, contact, there, steepness, p.index + i);
      }
    }
    const MI barred = hn::And(of_seat, ints(hn::Lt(distance, floor)));
    const VI barred_before = load_bytes(&out.is_barred[i]);
    const MI was_barred = hn::And(of_seat, hn::Gt(barred_before, none));
    const VF depth_before = hn::LoadU(kF, &out.depth_m[i]);
    const MI was_deep = hn::And(of_seat, ints(hn::Gt(depth_before, zero)));
    const MI interior =
        press.by_value
            ? hn::And(of_seat, hn::Eq(load_bytes(&out.value[i]),
                                      hn::Set(kI, static_cast<int>(VoxelValue::kInterior))))
            : was_barred;
    counts.seated += hn::CountTrue(kI, hn::Or(was_barred, was_deep));
    counts.freed += hn::CountTrue(kI, hn::AndNot(barred, interior));
    counts.were_barred += hn::CountTrue(kI, was_barred);
    counts.barred += hn::CountTrue(kI, barred);
    store_bytes(hn::IfThenElse(of_seat, hn::IfThenElseZero(barred, one), barred_before),
                &out.is_barred[i]);
    const MF flat = hn::Lt(steepness, hn::Set(kF, field::kMinSlope));
    for (int axis = 0; axis < 3; ++axis) {
      direction[axis] = hn::IfThenElse(flat, normal[axis], hn::Div(slope[axis], steepness));
    }
    // Along the gradient, where it has the same side, the push is that of a potential: a closed
    // path gives nothing. The slope is some degrees aside of it.
    const VF fall = hn::Sqrt(dot(gradient, gradient));
    const MF same_side = hn::Gt(dot(gradient, direction), hn::Mul(hn::Set(kF, kSameSide), fall));
    VF depth = hn::Sub(contact, distance);
    depth = hn::IfThenElse(hn::And(is_zero(direction), hn::Gt(depth, zero)), zero, depth);
    // Short slopes are of positions near the middle of a sheet, where they have no side. A point
    // that touches it has the part, and so its inward normal, on its own side. One without an
    // inside has no side there.
    const VF sure =
        hn::IfThenElse(is_zero(normal), hn::Set(kF, field::kSideSlope), hn::Set(kF, kSureSlope));
    const MF unsure = hn::Lt(steepness, sure);
    float* const push_to[3] = {&out.ux[i], &out.uy[i], &out.uz[i]};
    float* const side_to[3] = {&out.sx[i], &out.sy[i], &out.sz[i]};
    float* const slope_to[3] = {&out.gx[i], &out.gy[i], &out.gz[i]};
    for (int axis = 0; axis < 3; ++axis) {
      push[axis] = hn::IfThenElse(same_side, hn::Div(gradient[axis], fall), direction[axis]);
      side[axis] = hn::IfThenElse(unsure, normal[axis], direction[axis]);
      hn::BlendedStore(push[axis], touched, kF, push_to[axis]);
      hn::BlendedStore(side[axis], touched, kF, side_to[axis]);
      hn::BlendedStore(slope[axis], touched, kF, slope_to[axis]);
    }
    hn::BlendedStore(depth, touched, kF, &out.depth_m[i]);
    hn::BlendedStore(distance, touched, kF, &out.from_surface_m[i]);
  }
}

// Whether a point may have gone through a surface, by its places.
HWY_INLINE bool may_have_turned(const TurnedSearch& s, std::size_t at, std::size_t i) {
  if (s.later.of_seat[i] == 0 || s.earlier.of_seat[at] == 0) return false;
  if (!(s.p.zero_force_m + s.p.from_zero_force_m[i] < s.sheet_m)) return false;
  if (s.all_near) return true;
  const float x = s.p.slope[0][i], y = s.p.slope[1][i], z = s.p.slope[2][i];
  const auto along = [&](float a, float b, float c) { return x * a + y * b + z * c; };
  return along(s.earlier.sx[at], s.earlier.sy[at], s.earlier.sz[at]) < 0 ||
         along(s.p.normal[0][i], s.p.normal[1][i], s.p.normal[2][i]) < s.clear_slope;
}

std::size_t find_turned_on_target(const TurnedSearch& s, PointPair* pairs) {
  const field::ContactSet &earlier = s.earlier, &later = s.later;
  const VI none = hn::Zero(kI);
  std::size_t count = 0, at = 0, i = 0;
  const auto take = [&](std::size_t before, std::size_t after) {
    pairs[count++] = {static_cast<std::uint32_t>(before), static_cast<std::uint32_t>(after)};
  };
  const auto* later_point = reinterpret_cast<const std::int32_t*>(later.point.data());
  const auto* earlier_point = reinterpret_cast<const std::int32_t*>(earlier.point.data());
  while (i < later.count) {
    while (at < earlier.count && earlier.point[at] < later.point[i]) ++at;
    if (at == earlier.count) break;
    // Mostly the same points follow in both sets.
    const bool whole = i + kLanes <= later.count && at + kLanes <= earlier.count;
    if (!whole || !hn::AllTrue(kI, hn::Eq(hn::LoadU(kI, later_point + i),
                                          hn::LoadU(kI, earlier_point + at)))) {
      if (earlier.point[at] == later.point[i] && may_have_turned(s, at, i)) take(at, i);
      ++i;
      continue;
    }
    const MI of_seat = hn::And(hn::Gt(load_bytes(&later.of_seat[i]), none),
                               hn::Gt(load_bytes(&earlier.of_seat[at]), none));
    MF candidates = hn::And(floats(of_seat), hn::Lt(distance_m(s.p, i), hn::Set(kF, s.sheet_m)));
    if (!s.all_near && !hn::AllFalse(kF, candidates)) {
      VF slope[3], normal[3];
      load(s.p.slope, i, slope), load(s.p.normal, i, normal);
      const VF side[3] = {hn::LoadU(kF, &earlier.sx[at]), hn::LoadU(kF, &earlier.sy[at]),
                          hn::LoadU(kF, &earlier.sz[at])};
      const MF against = hn::Lt(dot(slope, side), hn::Zero(kF));
      const MF faces = hn::Lt(dot(slope, normal), hn::Set(kF, s.clear_slope));
      candidates = hn::And(candidates, hn::Or(against, faces));
    }
    for_each_bit(bits_of(candidates), [&](std::size_t lane) { take(at + lane, i + lane); });
    i += kLanes, at += kLanes;
  }
  return count;
}

void find_tilted_on_target(const Points& p, const TiltedSearch& s, std::uint32_t* steep,
                           std::uint32_t* gentle, TiltedPoints& found) {
  found = {};
  for (std::size_t i = 0; i < p.count; i += kLanes) {
    const VF distance = distance_m(p, i);
    const MF near = hn::And(hn::Lt(distance, hn::Set(kF, s.near_m)), hn::FirstN(kF, p.count - i));
    if (hn::AllFalse(kF, near)) continue;
    VF slope[3], normal[3];
    load(p.slope, i, slope), load(p.normal, i, normal);
    const VF squared = dot(slope, slope), out = dot(slope, normal);
    const VF tilt = hn::Sub(squared, hn::Mul(out, out));
    const MF is_steep = hn::Gt(tilt, hn::Set(kF, s.flat2));
    const MF tilted = hn::Or(is_steep, hn::And(hn::Gt(tilt, hn::Set(kF, s.gentle2)),
                                               hn::Lt(distance, hn::Set(kF, s.gentle_m))));
    // The distance falls no faster than by the slope: from some points it cannot fall so far.
    const VF above = hn::Sub(distance, hn::Set(kF, s.highest_m));
    const MF too_far =
        hn::And(hn::Gt(above, hn::Zero(kF)),
                hn::Gt(hn::Mul(above, above), hn::Mul(hn::Set(kF, s.reach2_m2), squared)));
    const MF kept = hn::AndNot(too_far, hn::And(near, tilted));
    const auto add = [&](MF mask, std::uint32_t* to, std::size_t& count) HWY_ATTR {
      for_each_bit(bits_of(mask),
                   [&](std::size_t lane) { to[count++] = static_cast<std::uint32_t>(i + lane); });
    };
    add(hn::And(kept, is_steep), steep, found.steep);
    add(hn::AndNot(is_steep, kept), gentle, found.gentle);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::guard
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::guard {

HWY_EXPORT(recall_on_target);
HWY_EXPORT(count_in_corners_on_target);
HWY_EXPORT(press_on_target);
HWY_EXPORT(find_turned_on_target);
HWY_EXPORT(find_tilted_on_target);

void NearestObjects::reserve(std::size_t points) {
  for (auto& axis : voxel_) axis.assign(points, std::numeric_limits<std::int32_t>::min());
  object_.assign(points, 0);
  found_.assign(points + field::ContactSet::kPadding, 0);
  moved_.assign(points, 0);
}

const std::int32_t* NearestObjects::find() noexcept {
  if (probe_.voxmap().objects() == nullptr) return found_.data();
  const std::int32_t* const known[3] = {voxel_[0].data(), voxel_[1].data(), voxel_[2].data()};
  const std::size_t count = HWY_DYNAMIC_DISPATCH(recall_on_target)(
      probe_.points(), known, object_.data(), found_.data(), moved_.data());
  for (std::size_t n = 0; n < count; ++n) {
    const std::uint32_t i = moved_[n], point = probe_.point(i);
    const glm::ivec3 voxel = probe_.voxel(i);
    for (int axis = 0; axis < 3; ++axis)
      voxel_[static_cast<std::size_t>(axis)][point] = voxel[axis];
    found_[i] = object_[point] = static_cast<std::int32_t>(probe_.object_of(i));
  }
  return found_.data();
}

SeatTables::SeatTables(const Seat& seat) : of_number(kNumbers, -1) {
  for (const SeatObject& object : seat.objects()) {
    of_number[object.object] = static_cast<std::int32_t>(contact_m.size());
    contact_m.push_back(object.contact_m);
    floor_m.push_back(object.floor_m);
    corner_floor_m.push_back(object.corner_floor_m);
  }
}

void press_points(const field::FieldProbe& probe, const SeatPress& press,
                  field::ContactSet& out) noexcept {
  PressCounts counts;
  HWY_DYNAMIC_DISPATCH(press_on_target)(Points(probe), press, out, counts);
  const auto less = [](std::uint32_t& count, std::size_t by) {
    count -= static_cast<std::uint32_t>(by);
  };
  out.seated += static_cast<std::uint32_t>(counts.seated);
  out.surface += static_cast<std::uint32_t>(counts.freed);
  out.barred += static_cast<std::uint32_t>(counts.barred);
  less(out.interior, counts.freed);
  less(out.barred, counts.were_barred);
}

std::uint32_t count_in_corners(const field::FieldProbe& probe, const float* in_seat_steepness,
                               float corner_m) noexcept {
  std::size_t count = 0;
  HWY_DYNAMIC_DISPATCH(count_in_corners_on_target)
  (Points(probe), in_seat_steepness, corner_m, count);
  return static_cast<std::uint32_t>(count);
}

std::size_t find_turned(const field::FieldProbe& probe, const field::ContactSet& earlier,
                        const field::ContactSet& later, float sheet_m, float clear_slope,
                        PointPair* pairs) noexcept {
  const Points points(probe);
  const bool all_near = probe.query().shell().view().two_sided != nullptr;
  const TurnedSearch search{points, earlier, later, sheet_m, clear_slope, all_near};
  return HWY_DYNAMIC_DISPATCH(find_turned_on_target)(search, pairs);
}

TiltedPoints find_tilted(const field::FieldProbe& probe, const TiltedSearch& search,
                         std::uint32_t* steep, std::uint32_t* gentle) noexcept {
  TiltedPoints found{};
  HWY_DYNAMIC_DISPATCH(find_tilted_on_target)(Points(probe), search, steep, gentle, found);
  return found;
}

}  // namespace forcelayer::guard
#endif
