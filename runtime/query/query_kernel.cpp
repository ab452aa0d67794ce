#include "runtime/query/query_kernel.h"

#include "formats/voxmap_format.h"
#include "runtime/query/contact_query.h"
#include "runtime/query/vector_targets.h"

// Compiles what follows once per instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/query/query_kernel.cpp"
#include <hwy/foreach_target.h>
// Behind foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <hwy/cache_control.h>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::query {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// At most 16 lanes: kRowPoints.
using F = hn::CappedTag<float, 16>;
using I = hn::RebindToSigned<F>;
using U = hn::RebindToUnsigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;
using VU = hn::Vec<U>;
using Mask = hn::Mask<U>;

// first, first + 1, ... Highway's own Iota is written to memory number by number.
HWY_INLINE VU numbers_from(std::uint32_t first) {
  HWY_ALIGN static constexpr std::uint32_t kNumbers[16] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                           8, 9, 10, 11, 12, 13, 14, 15};
  return hn::Add(hn::Set(U(), first), hn::Load(U(), kNumbers));
}

// Moves the lanes of a mask together. Highway's own Compress copies its tables to the stack on
// every call where there is no instruction for it, which takes longer than all the rest of a query.
#if HWY_TARGET <= HWY_AVX3
class Packing {
 public:
  explicit HWY_INLINE Packing(hn::Mask<F> kept) : kept_(kept) {}
  template <class V>
  HWY_INLINE V operator()(V v) const {
    return hn::Compress(v, hn::RebindMask(hn::DFromV<V>(), kept_));
  }
  HWY_INLINE std::size_t count() const { return hn::CountTrue(F(), kept_); }

 private:
  hn::Mask<F> kept_;
};
#else
constexpr std::size_t kLaneCount = hn::MaxLanes(F());

// Per bit pattern of a mask the numbers of its set bits, then zeros.
constexpr auto kSetBits = [] {
  std::array<std::array<std::uint8_t, 8>, std::size_t{1} << kLaneCount> table{};
  for (std::size_t bits = 0; bits < table.size(); ++bits) {
    std::size_t count = 0;
    for (std::uint8_t bit = 0; bit < kLaneCount; ++bit) {
      if (bits >> bit & 1) table[bits][count++] = bit;
    }
  }
  return table;
}();

class Packing {
 public:
  explicit HWY_INLINE Packing(hn::Mask<F> kept) : count_(hn::CountTrue(F(), kept)) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(F(), kept, bits);
    const hn::Rebind<std::uint8_t, I> d8;
    from_ = hn::PromoteTo(I(), hn::LoadU(d8, kSetBits[bits[0]].data()));
  }
  template <class V>
  HWY_INLINE V operator()(V v) const {
    return hn::TableLookupLanes(v, hn::IndicesFromVec(hn::DFromV<V>(), from_));
  }
  HWY_INLINE std::size_t count() const { return count_; }

 private:
  VI from_;
  std::size_t count_;
};
#endif

struct Float3 {
  VF x, y, z;
};

struct Int3 {
  VI x, y, z;
};

HWY_INLINE VF dot(const std::array<float, 3>& row, const Float3& v) {
  const F f;
  return hn::Add(hn::Add(hn::Mul(hn::Set(f, row[0]), v.x), hn::Mul(hn::Set(f, row[1]), v.y)),
                 hn::Mul(hn::Set(f, row[2]), v.z));
}

HWY_INLINE Float3 multiply(const std::array<std::array<float, 3>, 3>& matrix, const Float3& v) {
  return {dot(matrix[0], v), dot(matrix[1], v), dot(matrix[2], v)};
}

// entries[index] where `mask` holds, else anything. There the index must be in range.
HWY_INLINE VU gather(const std::uint32_t* entries, VU index, Mask mask) {
  const I i;
  const U u;
  const VI safe = hn::BitCast(i, hn::IfThenElseZero(mask, index));
  return hn::BitCast(u, hn::GatherIndex(i, reinterpret_cast<const std::int32_t*>(entries), safe));
}

// Number of a voxel's entry in its node of 8^3 entries, each 2^kShift voxels wide.
template <int kShift>
HWY_INLINE VU slot(const Int3& voxel) {
  const U u;
  const VU seven = hn::Set(u, 7);
  const VU x = hn::And(hn::ShiftRight<kShift>(hn::BitCast(u, voxel.x)), seven);
  const VU y = hn::And(hn::ShiftRight<kShift>(hn::BitCast(u, voxel.y)), seven);
  const VU z = hn::And(hn::ShiftRight<kShift>(hn::BitCast(u, voxel.z)), seven);
  return hn::Or(hn::ShiftLeft<6>(x), hn::Or(hn::ShiftLeft<3>(y), z));
}

// Whether bit 31 is clear: the entry has a child.
HWY_INLINE Mask has_child(VU entry) {
  const I i;
  return hn::RebindMask(U(), hn::Gt(hn::BitCast(i, entry), hn::Set(i, -1)));
}

HWY_INLINE Mask in_directory(const KernelMap& map, const Int3& voxel) {
  const U u;
  const auto below = [&](VI v, std::int32_t cells) HWY_ATTR {
    return hn::Lt(hn::BitCast(u, v), hn::Set(u, static_cast<std::uint32_t>(cells) << 9));
  };
  return hn::And(below(voxel.x, map.dims[0]),
                 hn::And(below(voxel.y, map.dims[1]), below(voxel.z, map.dims[2])));
}

// The tree entry at which each voxel's path ends, and the width of its box in voxels: 512, 64 or 8
// for a uniform entry, 1 for an index into the bricks.
struct TreeEnd {
  VU entry;
  VI edge;
  Mask in_brick;
};

// The entry of the 64^3 voxels around one voxel, that of free voxels outside of the directory.
HWY_INLINE std::uint32_t upper_end(const KernelMap& map, std::int32_t x, std::int32_t y,
                                   std::int32_t z) {
  const auto cell = [](std::int32_t v) { return static_cast<std::uint32_t>(v) >> 9; };
  const std::array<std::uint32_t, 3> dims = {static_cast<std::uint32_t>(map.dims[0]),
                                             static_cast<std::uint32_t>(map.dims[1]),
                                             static_cast<std::uint32_t>(map.dims[2])};
  if (cell(x) >= dims[0] || cell(y) >= dims[1] || cell(z) >= dims[2]) return uniform_entry(0);
  const std::uint32_t entry =
      map.directory[(std::size_t{cell(x)} * dims[1] + cell(y)) * dims[2] + cell(z)];
  if (is_uniform(entry)) return entry;
  const auto slot =
      static_cast<std::uint32_t>((x >> 6 & 7) << 6 | (y >> 6 & 7) << 3 | (z >> 6 & 7));
  return map.upper_nodes[std::size_t{entry} * kNodeEntries + slot];
}

// Down to the entries of 64^3 voxels; `in_brick` marks those that have a child.
HWY_INLINE TreeEnd descend_to_lower_nodes(const KernelMap& map, const Int3& voxel, Mask valid) {
  const I i;
  const U u;
  TreeEnd end;
  const auto cell = [&](VI v) HWY_ATTR { return hn::ShiftRight<9>(v); };
  const VI cell_index =
      hn::Add(hn::Mul(hn::Add(hn::Mul(cell(voxel.x), hn::Set(i, map.dims[1])), cell(voxel.y)),
                      hn::Set(i, map.dims[2])),
              cell(voxel.z));
  end.entry = gather(map.directory, hn::BitCast(u, cell_index), valid);
  end.edge = hn::Set(i, 512);
  end.in_brick = hn::And(valid, has_child(end.entry));
  if (hn::AllFalse(u, end.in_brick)) return end;
  const Mask pending = end.in_brick;
  end.entry = hn::IfThenElse(
      pending,
      gather(map.upper_nodes, hn::Add(hn::ShiftLeft<9>(end.entry), slot<6>(voxel)), pending),
      end.entry);
  end.edge = hn::IfThenElse(hn::RebindMask(i, pending), hn::Set(i, 64), end.edge);
  end.in_brick = hn::And(pending, has_child(end.entry));
  return end;
}

// From there to the end.
HWY_INLINE TreeEnd descend_from_lower_nodes(const KernelMap& map, const Int3& voxel, TreeEnd end) {
  const I i;
  const U u;
  const Mask pending = end.in_brick;
  if (hn::AllFalse(u, pending)) return end;
  end.entry = hn::IfThenElse(
      pending,
      gather(map.lower_nodes, hn::Add(hn::ShiftLeft<9>(end.entry), slot<3>(voxel)), pending),
      end.entry);
  end.edge = hn::IfThenElse(hn::RebindMask(i, pending), hn::Set(i, 8), end.edge);
  end.in_brick = hn::And(pending, has_child(end.entry));
  end.edge = hn::IfThenElse(hn::RebindMask(i, end.in_brick), hn::Set(i, 1), end.edge);
  return end;
}

// VoxelValue of each voxel, by the entries at which their paths end.
HWY_INLINE VU value_at(const KernelMap& map, const Int3& voxel, VU entry, Mask in_brick) {
  const U u;
  const VU value = hn::And(entry, hn::Set(u, 0xff));
  if (hn::AllFalse(u, in_brick)) return value;
  const VU bit = hn::ShiftLeft<1>(slot<0>(voxel));
  const VU word =
      gather(map.bricks, hn::Add(hn::ShiftLeft<5>(entry), hn::ShiftRight<5>(bit)), in_brick);
  const VU stored = hn::And(hn::Shr(word, hn::And(bit, hn::Set(u, 31))), hn::Set(u, 3));
  return hn::IfThenElse(in_brick, stored, value);
}

// VoxelValue of voxel after voxel; free outside of the directory. Points are in order: most vectors
// lie in the same 64^3 voxels as the one before, which are found once. In Pass::kAppend no voxel is
// near the one before, and its value is known.
class Lookup {
 public:
  HWY_INLINE Lookup(const KernelMap& map, PointColumns& columns) : map_(map), columns_(columns) {
    const VI nowhere = hn::Set(I(), INT32_MIN);
    near_ = {nowhere, nowhere, nowhere};
  }
  HWY_INLINE VU operator()(const Int3& voxel) {
    const U u;
    if (HWY_UNLIKELY(!is_near(voxel))) {
      const I i;
      if (HWY_UNLIKELY(columns_.pass == Pass::kAppend)) return next_value();
      const std::int32_t x = hn::GetLane(voxel.x), y = hn::GetLane(voxel.y),
                         z = hn::GetLane(voxel.z);
      near_ = {hn::Set(i, x), hn::Set(i, y), hn::Set(i, z)};
      entry_ = upper_end(map_, x, y, z);
      if (!is_near(voxel)) return scattered(voxel);
    }
    if (is_uniform(entry_)) return hn::Set(u, entry_ & 0xff);
    const std::uint32_t* node = map_.lower_nodes + std::size_t{entry_} * kNodeEntries;
    const VU entry =
        hn::BitCast(u, hn::GatherIndex(I(), reinterpret_cast<const std::int32_t*>(node),
                                       hn::BitCast(I(), slot<3>(voxel))));
    return value_at(map_, voxel, entry, has_child(entry));
  }

 private:
  HWY_INLINE bool is_near(const Int3& voxel) const {
    const U u;
    const VU differs =
        hn::BitCast(u, hn::Or(hn::Xor(voxel.x, near_.x),
                              hn::Or(hn::Xor(voxel.y, near_.y), hn::Xor(voxel.z, near_.z))));
    return hn::AllTrue(u, hn::Eq(hn::ShiftRight<6>(differs), hn::Zero(u)));
  }
  HWY_INLINE VU next_value() {
    const hn::Rebind<std::uint8_t, U> bytes;
    const VU value = hn::PromoteTo(U(), hn::LoadU(bytes, columns_.values));
    columns_.values += hn::MaxLanes(bytes);
    return value;
  }
  HWY_INLINE VU scattered(const Int3& voxel) const {
    const Mask valid = in_directory(map_, voxel);
    const TreeEnd end =
        descend_from_lower_nodes(map_, voxel, descend_to_lower_nodes(map_, voxel, valid));
    return hn::IfThenElseZero(valid, value_at(map_, voxel, end.entry, end.in_brick));
  }

  const KernelMap& map_;
  PointColumns& columns_;
  Int3 near_;                               // a voxel of the 64^3
  std::uint32_t entry_ = uniform_entry(0);  // theirs
};

HWY_INLINE Mask outside_known(const KernelMap& map, const Int3& voxel) {
  const I i;
  const auto beyond = [&](VI v, int axis) HWY_ATTR {
    return hn::Or(hn::Lt(v, hn::Set(i, map.known_min[axis])),
                  hn::Gt(v, hn::Set(i, map.known_max[axis] - 1)));
  };
  return hn::RebindMask(U(),
                        hn::Or(beyond(voxel.x, 0), hn::Or(beyond(voxel.y, 1), beyond(voxel.z, 2))));
}

// A vector of points as ContactQuery::collect_point() places them before the look-up.
struct PlacedPoints {
  Float3 offset;    // voxels, from the center
  Float3 whole;     // voxel relative to the center's, as floats
  Float3 position;  // offset + fraction of the center
  Int3 voxel;       // relative to the directory
};

// A voxel, told from the center's by a whole number below 2^22, which such a sum has in its low
// bits. Highway's own conversion takes four instructions, to be right for all numbers.
HWY_INLINE VI voxel_at(VF whole, std::int32_t center) {
  constexpr std::uint32_t kSumBits = 0x4b400000;  // of kSum
  const VF sum = hn::Add(whole, hn::Set(F(), 0x1.8p23f));
  return hn::BitCast(I(), hn::Add(hn::BitCast(U(), sum),
                                  hn::Set(U(), static_cast<std::uint32_t>(center) - kSumBits)));
}

HWY_INLINE PlacedPoints place_points(const VoxelPose& pose, const Float3& point) {
  const F f;
  PlacedPoints p;
  p.offset = multiply(pose.turn, point);
  p.position = {hn::Add(p.offset.x, hn::Set(f, pose.fraction[0])),
                hn::Add(p.offset.y, hn::Set(f, pose.fraction[1])),
                hn::Add(p.offset.z, hn::Set(f, pose.fraction[2]))};
  p.whole = {hn::Floor(p.position.x), hn::Floor(p.position.y), hn::Floor(p.position.z)};
  p.voxel = {voxel_at(p.whole.x, pose.whole[0]), voxel_at(p.whole.y, pose.whole[1]),
             voxel_at(p.whole.z, pose.whole[2])};
  return p;
}

// Appends the points of `mask`. The columns have room for a whole vector behind their end.
HWY_INLINE void append(const KernelMap& map, const KernelShell& shell, const VoxelPose& pose,
                       std::uint32_t first, const PlacedPoints& p, VU value, Mask mask,
                       PointColumns& out) {
  const F f;
  const I i;
  const Packing pack(hn::RebindMask(f, mask));
  const auto put = [&pack](auto v, auto* to)
                       HWY_ATTR { hn::StoreU(pack(v), hn::DFromV<decltype(v)>(), to); };
  const std::uint32_t at = out.count;
  put(numbers_from(first), &out.index[at]);
  const hn::Rebind<std::uint8_t, U> bytes;
  hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(i, pack(value))), bytes, &out.value[at]);
  put(p.voxel.x, &out.vx[at]);
  put(p.voxel.y, &out.vy[at]);
  put(p.voxel.z, &out.vz[at]);
  const VF below_one = hn::Set(f, 0x1.fffffep-1f);
  put(hn::Min(hn::Sub(p.position.x, p.whole.x), below_one), &out.fx[at]);
  put(hn::Min(hn::Sub(p.position.y, p.whole.y), below_one), &out.fy[at]);
  put(hn::Min(hn::Sub(p.position.z, p.whole.z), below_one), &out.fz[at]);
  const VF s = hn::Set(f, map.voxel_size_m);
  put(hn::Mul(p.offset.x, s), &out.rx[at]);
  put(hn::Mul(p.offset.y, s), &out.ry[at]);
  put(hn::Mul(p.offset.z, s), &out.rz[at]);
  const Float3 normal =
      multiply(pose.rotation, {hn::LoadU(f, shell.nx + first), hn::LoadU(f, shell.ny + first),
                               hn::LoadU(f, shell.nz + first)});
  put(normal.x, &out.nx[at]);
  put(normal.y, &out.ny[at]);
  put(normal.z, &out.nz[at]);
  out.count += static_cast<std::uint32_t>(pack.count());
}

// Rows are far apart: the processor does not guess which one comes next.
constexpr std::uint32_t kAhead = 6;

HWY_INLINE void fetch(const KernelShell& shell, std::uint32_t point) {
  hwy::Prefetch(shell.x + point);
  hwy::Prefetch(shell.y + point);
  hwy::Prefetch(shell.z + point);
  hwy::Prefetch(shell.nx + point);
  hwy::Prefetch(shell.ny + point);
  hwy::Prefetch(shell.nz + point);
}

// The first pass writes values for the second.
HWY_INLINE void keep(VU value, PointColumns& out) {
  const hn::Rebind<std::uint8_t, U> bytes;
  hn::StoreU(hn::DemoteTo(bytes, hn::BitCast(I(), value)), bytes, out.values);
  out.values += hn::MaxLanes(bytes);
  if (out.pass != Pass::kLookUp) return;
  out.count += static_cast<std::uint32_t>(hn::CountTrue(U(), hn::Ne(value, hn::Zero(U()))));
}

void CollectRows(const KernelMap& map, const KernelShell& shell, const VoxelPose& pose,
                 const std::uint32_t* rows, std::uint32_t row_count, PointColumns& out) {
  const F f;
  const U u;
  constexpr std::uint32_t kLanes = static_cast<std::uint32_t>(hn::MaxLanes(f));
  const std::uint32_t count_before = out.count;
  // Rows that end behind this take more than to be appended: the last, and all in the first pass.
  const bool keeps = out.pass == Pass::kLookUp || out.pass == Pass::kLookUpAndAppend;
  const std::uint32_t usual_end = keeps ? 0 : shell.point_count;
  Lookup look_up(map, out);
  VU ones = hn::Zero(u), twos = hn::Zero(u);  // per lane, how many points lie in values 1 and 2
  const auto add = [u](VU sum, VU value, std::uint32_t wanted) HWY_ATTR {
    return hn::Sub(sum, hn::VecFromMask(u, hn::Eq(value, hn::Set(u, wanted))));
  };
  for (std::uint32_t row = 0; row < row_count; ++row) {
    const std::uint32_t begin = rows[row] * kRowPoints;
    const std::uint32_t end = begin + kRowPoints;
    if (row + kAhead < row_count) fetch(shell, rows[row + kAhead] * kRowPoints);
    for (std::uint32_t first = begin; first < end; first += kLanes) {
      const PlacedPoints p =
          place_points(pose, {hn::LoadU(f, shell.x + first), hn::LoadU(f, shell.y + first),
                              hn::LoadU(f, shell.z + first)});
      const auto are_real = [&]() HWY_ATTR {
        return hn::Lt(numbers_from(first), hn::Set(u, shell.point_count));
      };
      if (map.cropped) {
        out.outside_map |= !hn::AllFalse(u, hn::And(are_real(), outside_known(map, p.voxel)));
      }
      VU value = look_up(p.voxel);
      if (HWY_UNLIKELY(end > usual_end)) {
        value = hn::IfThenElseZero(are_real(), value);
        if (keeps) keep(value, out);
        if (out.pass == Pass::kLookUp) continue;
      }
      const Mask found = hn::Ne(value, hn::Zero(u));
      if (hn::AllFalse(u, found)) continue;
      append(map, shell, pose, first, p, value, found, out);
      ones = add(ones, value, 1);
      twos = add(twos, value, 2);
    }
  }
  if (out.pass == Pass::kLookUp) return;
  const std::uint32_t one = hn::GetLane(hn::SumOfLanes(u, ones)),
                      two = hn::GetLane(hn::SumOfLanes(u, twos));
  out.count_of_value[1] += one;
  out.count_of_value[2] += two;
  out.count_of_value[3] += out.count - count_before - one - two;
}

// How far [low, high] lies inside [from, to) on one axis. All are relative to the center's voxel.
HWY_INLINE VF inside_by(VF low, VF high, VF from, VF to) {
  return hn::Min(hn::Sub(low, from), hn::Sub(to, high));
}

// A voxel bound relative to the center's voxel, as a float rounded against the disc.
HWY_INLINE float bound_from(std::int32_t bound, std::int32_t center, float direction) {
  const float distance = static_cast<float>(static_cast<double>(bound) - center);
  const float rounding = (distance < 0 ? -distance : distance) * 0x1p-22f;
  return distance + direction * rounding;
}

// How far discs lie outside the box of the non-free voxels: the largest gap on any axis.
HWY_INLINE VF outside_tight_box(const KernelMap& map, const VoxelPose& pose, const Float3& low,
                                const Float3& high) {
  const F f;
  const auto gap = [&](VF axis_low, VF axis_high, int axis) HWY_ATTR {
    const VF min = hn::Set(f, bound_from(map.tight_min[axis], pose.whole[axis], -1));
    const VF max = hn::Set(f, bound_from(map.tight_max[axis], pose.whole[axis], 1));
    return hn::Max(hn::Sub(min, axis_high), hn::Sub(axis_low, max));
  };
  return hn::Max(gap(low.x, high.x, 0), hn::Max(gap(low.y, high.y, 1), gap(low.z, high.z, 2)));
}

// How far discs lie inside the box of the known voxels.
HWY_INLINE VF inside_known_box(const KernelMap& map, const VoxelPose& pose, const Float3& low,
                               const Float3& high) {
  const F f;
  const auto depth = [&](VF axis_low, VF axis_high, int axis) HWY_ATTR {
    return inside_by(axis_low, axis_high,
                     hn::Set(f, bound_from(map.known_min[axis], pose.whole[axis], 1)),
                     hn::Set(f, bound_from(map.known_max[axis], pose.whole[axis], -1)));
  };
  return hn::Min(depth(low.x, high.x, 0),
                 hn::Min(depth(low.y, high.y, 1), depth(low.z, high.z, 2)));
}

// How far discs lie inside the free surroundings of the entry that holds their center: the entry's
// box and clearance - 1 voxels around it. Negative where the entry is not uniformly free.
HWY_INLINE VF inside_clearance(const KernelMap& map, const VoxelPose& pose,
                               const PlacedPoints& center, const Float3& low, const Float3& high) {
  const F f;
  const I i;
  const U u;
  const Mask valid = in_directory(map, center.voxel);
  const TreeEnd end =
      descend_from_lower_nodes(map, center.voxel, descend_to_lower_nodes(map, center.voxel, valid));
  const VU value = hn::And(end.entry, hn::Set(u, 0xff));
  const Mask free = hn::AndNot(end.in_brick, hn::And(valid, hn::Eq(value, hn::Zero(u))));
  const VI one = hn::Set(i, 1);
  const VI clearance =
      hn::BitCast(i, hn::And(hn::ShiftRight<8>(end.entry), hn::Set(u, kMaxClearance)));
  const VI around = hn::Sub(hn::Max(clearance, one), one);
  const auto depth = [&](VF axis_low, VF axis_high, VI voxel, int axis) HWY_ATTR {
    const VI box = hn::And(voxel, hn::Neg(end.edge));  // edges are powers of two
    const VI center_voxel = hn::Set(i, pose.whole[axis]);
    const VI from = hn::Sub(hn::Sub(box, around), center_voxel);
    const VI to = hn::Sub(hn::Add(hn::Add(box, end.edge), around), center_voxel);
    return inside_by(axis_low, axis_high, hn::ConvertTo(f, from), hn::ConvertTo(f, to));
  };
  const VF slack = hn::Min(
      depth(low.x, high.x, center.voxel.x, 0),
      hn::Min(depth(low.y, high.y, center.voxel.y, 1), depth(low.z, high.z, center.voxel.z, 2)));
  return hn::IfThenElse(hn::RebindMask(f, free), slack, hn::Set(f, -1.0f));
}

// Half the extent of discs along one world axis, m. `along` is the component of the disc's axis on
// it; 2e-6 exceeds the rounding of its square.
HWY_INLINE VF half_extent(VF radius, VF half_height, VF along) {
  const F f;
  const VF across = hn::Sub(hn::Set(f, 1.0f + 2e-6f), hn::Mul(along, along));
  return hn::Add(hn::Mul(radius, hn::Sqrt(hn::Max(across, hn::Zero(f)))),
                 hn::Mul(half_height, hn::Abs(along)));
}

void SurveyDiscs(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
                 const KernelDiscs& discs, std::uint32_t begin, std::uint32_t end, float* slack) {
  const F f;
  constexpr std::uint32_t kLanes = static_cast<std::uint32_t>(hn::MaxLanes(f));
  HWY_ALIGN float tail[2][4 * kLanes] = {};
  HWY_ALIGN float result[kLanes];
  for (std::uint32_t first = begin; first < end; first += kLanes) {
    const std::uint32_t count = end - first < kLanes ? end - first : kLanes;
    const float* place_from = discs.place + std::size_t{4} * first;
    const float* shape_from = discs.shape + std::size_t{4} * first;
    if (count < kLanes) {
      for (std::uint32_t n = 0; n < 4 * count; ++n) {
        tail[0][n] = place_from[n];
        tail[1][n] = shape_from[n];
      }
      place_from = tail[0];
      shape_from = tail[1];
    }
    Float3 center, axis;
    VF radius, half_height;
    hn::LoadInterleaved4(f, place_from, center.x, center.y, center.z, radius);
    hn::LoadInterleaved4(f, shape_from, axis.x, axis.y, axis.z, half_height);
    const PlacedPoints p = place_points(pose, center);
    const Float3 along = multiply(pose.rotation, axis);
    const auto reach = [&](VF component) HWY_ATTR {
      return hn::Add(hn::Mul(half_extent(radius, half_height, component), hn::Set(f, margin.scale)),
                     hn::Set(f, margin.voxels));
    };
    const Float3 reaches = {reach(along.x), reach(along.y), reach(along.z)};
    const Float3 low = {hn::Sub(p.position.x, reaches.x), hn::Sub(p.position.y, reaches.y),
                        hn::Sub(p.position.z, reaches.z)};
    const Float3 high = {hn::Add(p.position.x, reaches.x), hn::Add(p.position.y, reaches.y),
                         hn::Add(p.position.z, reaches.z)};
    VF by =
        hn::Max(inside_clearance(map, pose, p, low, high), outside_tight_box(map, pose, low, high));
    if (map.cropped) by = hn::Min(by, inside_known_box(map, pose, low, high));
    if (count == kLanes) {
      hn::StoreU(by, f, slack + (first - begin));
    } else {
      hn::Store(by, f, result);
      for (std::uint32_t n = 0; n < count; ++n) slack[first - begin + n] = result[n];
    }
  }
}

const char* TargetName() { return hwy::TargetName(HWY_TARGET); }

}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::query
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::query {

HWY_EXPORT(CollectRows);
HWY_EXPORT(SurveyDiscs);
HWY_EXPORT(TargetName);

bool kernel_reaches(std::uint64_t upper_nodes, std::uint64_t lower_nodes, std::uint64_t bricks) {
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 31;  // signed indices
  return upper_nodes * kNodeEntries <= kLargest && lower_nodes * kNodeEntries <= kLargest &&
         bricks * 32 <= kLargest;
}

void collect_rows(const KernelMap& map, const KernelShell& shell, const VoxelPose& pose,
                  const std::uint32_t* rows, std::uint32_t row_count, PointColumns& out) noexcept {
  HWY_DYNAMIC_DISPATCH(CollectRows)(map, shell, pose, rows, row_count, out);
}

void survey_discs(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
                  const KernelDiscs& discs, std::uint32_t begin, std::uint32_t end,
                  float* slack_voxels) noexcept {
  HWY_DYNAMIC_DISPATCH(SurveyDiscs)(map, pose, margin, discs, begin, end, slack_voxels);
}

const char* kernel_target() { return HWY_DYNAMIC_DISPATCH(TargetName)(); }

}  // namespace forcelayer::query
#endif  // HWY_ONCE
