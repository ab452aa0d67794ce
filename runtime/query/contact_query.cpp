#include "runtime/query/contact_query.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <limits>

namespace forcelayer::query {
namespace {

constexpr std::size_t kLanePadding = 128;  // elements behind the last that a vector store may write
constexpr std::size_t kChunksPerThread = 8;  // so that a slow thread holds up little
constexpr float kBelowOne = 0x1.fffffep-1f;

// Voxels are looked up only within reach of the directory (VoxelPose::within_reach), so clamping
// changes no answer.
std::int32_t to_int32(std::int64_t index) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(
      index, std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max()));
}

// A map that is free everywhere may have an empty directory, from which no kernel may gather.
bool directory_is_empty(const Voxmap& voxmap) {
  const auto& dims = voxmap.header().directory_dims;
  return dims[0] == 0 || dims[1] == 0 || dims[2] == 0;
}

KernelMap kernel_map(const Voxmap& voxmap) {
  const VoxmapHeader& header = voxmap.header();
  const VoxmapView& view = voxmap.view();
  KernelMap map;
  map.directory = view.directory;
  map.upper_nodes = view.upper_nodes;
  map.lower_nodes = view.lower_nodes;
  map.bricks = view.bricks;
  map.dims = view.directory_dims;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const std::int64_t low = header.origin_voxel[axis] - header.directory_origin[axis];
    map.tight_min[axis] = to_int32(low);
    map.tight_max[axis] = to_int32(low + static_cast<std::int64_t>(header.dims_voxels[axis]));
  }
  map.cropped = header.cropped_sides != 0;
  map.voxel_size_m = static_cast<float>(voxmap.voxel_size_m());
  return map;
}

KernelShell kernel_shell(const Pshell& shell) {
  const PshellView& v = shell.view();
  return {v.x, v.y, v.z, v.nx, v.ny, v.nz, static_cast<std::uint32_t>(v.point_count)};
}

// Discs are surveyed by the vector kernel alone.
SkipOptions skip_options(const QueryOptions& options, bool use_kernel) {
  SkipOptions skip = options.skip;
  skip.clearance = skip.clearance && use_kernel;
  return skip;
}

// The columns of `out` from element `at` on.
PointColumns columns(auto& out, std::size_t at) {
  PointColumns c;
  c.index = &out.index[at];
  c.value = &out.value[at];
  c.vx = &out.vx[at], c.vy = &out.vy[at], c.vz = &out.vz[at];
  c.fx = &out.fx[at], c.fy = &out.fy[at], c.fz = &out.fz[at];
  c.rx = &out.rx[at], c.ry = &out.ry[at], c.rz = &out.rz[at];
  c.nx = &out.nx[at], c.ny = &out.ny[at], c.nz = &out.nz[at];
  return c;
}

// Adds the counts of `c`, whose points already stand in their place in `out`.
void take_counts(const PointColumns& c, CollectedPoints& out) {
  out.count += c.count;
  out.interior_count += c.count_of_value[1];
  out.surface_count += c.count_of_value[2];
  out.proximity_count += c.count_of_value[3];
  out.outside_map = out.outside_map || c.outside_map;
}

// Room for the last points of a chunk: fewer than two rows, and a vector behind them.
struct LastPoints {
  static constexpr std::size_t kRoom = 3 * kRowPoints;
  std::array<std::uint32_t, kRoom> index;
  std::array<std::uint8_t, kRoom> value;
  std::array<std::int32_t, kRoom> vx, vy, vz;
  std::array<float, kRoom> fx, fy, fz, rx, ry, rz, nx, ny, nz;
};

// Copies the points of `c` behind those of `to`.
void append_points(const PointColumns& c, PointColumns& to) {
  const auto put = [&](const auto* from, auto* column) {
    std::copy_n(from, c.count, column + to.count);
  };
  put(c.index, to.index);
  put(c.value, to.value);
  put(c.vx, to.vx), put(c.vy, to.vy), put(c.vz, to.vz);
  put(c.fx, to.fx), put(c.fy, to.fy), put(c.fz, to.fz);
  put(c.rx, to.rx), put(c.ry, to.ry), put(c.rz, to.rz);
  put(c.nx, to.nx), put(c.ny, to.ny), put(c.nz, to.nz);
  to.count += c.count;
  for (std::size_t value = 1; value <= 3; ++value) {
    to.count_of_value[value] += c.count_of_value[value];
  }
}

float dot(const std::array<float, 3>& row, float x, float y, float z) {
  return row[0] * x + row[1] * y + row[2] * z;
}

}  // namespace

void CollectedPoints::reserve(std::uint64_t points) {
  const std::size_t room = points + kLanePadding;
  index.resize(room);
  value.resize(room);
  for (auto* values : {&vx, &vy, &vz}) values->resize(room);
  for (auto* values : {&fx, &fy, &fz, &rx, &ry, &rz, &nx, &ny, &nz}) values->resize(room);
}

void CollectedPoints::clear() noexcept {
  count = interior_count = surface_count = proximity_count = 0;
  outside_map = false;
}

Status ContactQuery::check_size(const Voxmap& voxmap, const Pshell& shell) {
  if (shell.header().bounding_radius_m / voxmap.voxel_size_m() < kMaxRadiusVoxels) return {};
  return Error{ErrorCode::kFilesDoNotMatch, "", "bounding radius",
               "the part's radius is a million voxels or more",
               "check the units that scene and part were baked with"};
}

ContactQuery::ContactQuery(const Voxmap& voxmap, const Pshell& shell, const QueryOptions& options)
    : voxmap_(voxmap),
      shell_(shell),
      radius_voxels_(shell.header().bounding_radius_m / voxmap.voxel_size_m()),
      voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())),
      kernel_map_(kernel_map(voxmap)),
      kernel_shell_(kernel_shell(shell)),
      use_kernel_(options.vector && !directory_is_empty(voxmap) &&
                  kernel_reaches(voxmap.upper_node_count(), voxmap.lower_node_count(),
                                 voxmap.brick_count())),
      all_free_(voxmap.header().dims_voxels[0] == 0),
      skipper_(voxmap, shell, skip_options(options, use_kernel_)),
      points_worth_sharing_(options.points_worth_sharing) {
  known_ = known_box(voxmap.header(), voxmap.header().directory_origin);
  for (unsigned axis = 0; axis < 3; ++axis) {
    kernel_map_.known_min[axis] = to_int32(known_.low[axis]);
    kernel_map_.known_max[axis] = to_int32(known_.high[axis]);
  }
  if (options.threads > 1) {
    workers_ = std::make_unique<QueryWorkers>(options.threads - 1);
    chunks_.resize(kChunksPerThread * options.threads);
    values_.resize((shell.view().point_count + kRowPoints - 1) / kRowPoints * kRowPoints);
  }
}

VoxelPose ContactQuery::voxel_pose(const Pose& world_from_center) const noexcept {
  VoxelPose pose{};
  const glm::dmat3 rotation = glm::mat3_cast(world_from_center.orientation);  // column-major
  const double s = voxmap_.voxel_size_m();
  const VoxmapView& map = voxmap_.view();
  const double reach = radius_voxels_ + 2;
  pose.within_reach = true;
  for (int axis = 0; axis < 3; ++axis) {
    for (int column = 0; column < 3; ++column) {
      pose.rotation[axis][column] = static_cast<float>(rotation[column][axis]);
      pose.turn[axis][column] = static_cast<float>(rotation[column][axis] / s);
    }
    const double position = world_from_center.position_m[axis] / s;
    const double whole = std::floor(position);
    const double relative = whole - static_cast<double>(map.directory_origin[axis]);
    const double extent = 512.0 * map.directory_dims[axis];
    if (!(relative > -reach && relative < extent + reach)) {  // NaN too
      pose.within_reach = false;
      continue;
    }
    pose.fraction[axis] = static_cast<float>(position - whole);
    pose.whole[axis] = static_cast<std::int32_t>(relative);
  }
  return pose;
}

// Per axis, with u = 2^-24 and the radius R: rounding the matrix, three products and two sums costs
// at most 4 u R (Cauchy-Schwarz on the row), rounding the fraction u, adding it u (R + 1). Doubled
// for terms of higher order.
double ContactQuery::rounding_voxels() const {
  return std::ldexp(2 * (5 * radius_voxels_ + 2), -24);
}

double ContactQuery::rounding_bound_m() const {
  // The center itself is double: 2^-52 of the largest index at reach.
  const VoxmapView& map = voxmap_.view();
  double error2 = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double origin = static_cast<double>(map.directory_origin[axis]);
    const double far =
        std::max(std::abs(origin), std::abs(origin + 512.0 * map.directory_dims[axis]));
    const double error = rounding_voxels() + std::ldexp(far + radius_voxels_ + 2, -52);
    error2 += error * error;
  }
  return std::sqrt(error2) * voxmap_.voxel_size_m();
}

bool ContactQuery::beyond_cropped_side(std::int32_t x, std::int32_t y,
                                       std::int32_t z) const noexcept {
  return x < known_.low[0] || x >= known_.high[0] || y < known_.low[1] || y >= known_.high[1] ||
         z < known_.low[2] || z >= known_.high[2];
}

bool ContactQuery::sphere_beyond_cropped_side(const glm::dvec3& center_m) const noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    const double relative = center_m[axis] / voxmap_.voxel_size_m() -
                            static_cast<double>(voxmap_.view().directory_origin[axis]);
    const double low = relative - radius_voxels_ - 1, high = relative + radius_voxels_ + 1;
    if (low < static_cast<double>(known_.low[axis])) return true;
    if (high >= static_cast<double>(known_.high[axis])) return true;
  }
  return false;
}

void ContactQuery::collect_point(const VoxelPose& pose, std::uint32_t point,
                                 PointColumns& out) const noexcept {
  const PshellView& shell = shell_.view();
  std::array<float, 3> offset{}, fraction{};  // voxels, from the center; in the point's voxel
  std::array<std::int32_t, 3> voxel{};
  for (int axis = 0; axis < 3; ++axis) {
    offset[axis] = dot(pose.turn[axis], shell.x[point], shell.y[point], shell.z[point]);
    const float position = offset[axis] + pose.fraction[axis];
    const float whole = std::floor(position);
    voxel[axis] = pose.whole[axis] + static_cast<std::int32_t>(whole);
    fraction[axis] = std::min(position - whole, kBelowOne);
  }
  if (beyond_cropped_side(voxel[0], voxel[1], voxel[2])) out.outside_map = true;
  const VoxmapView& map = voxmap_.view();
  std::uint8_t value = 0;
  if (out.pass == Pass::kAppend) {
    value = *out.values++;
  } else if (map.contains(voxel[0], voxel[1], voxel[2])) {
    value = static_cast<std::uint8_t>(map.lookup(voxel[0], voxel[1], voxel[2]).code);
  }
  if (out.pass == Pass::kLookUp || out.pass == Pass::kLookUpAndAppend) *out.values++ = value;
  if (out.pass == Pass::kLookUp) {
    out.count += value != 0;
    return;
  }
  if (value == 0) return;

  const std::uint32_t at = out.count++;
  out.index[at] = point;
  out.value[at] = value;
  out.vx[at] = voxel[0], out.vy[at] = voxel[1], out.vz[at] = voxel[2];
  out.fx[at] = fraction[0], out.fy[at] = fraction[1], out.fz[at] = fraction[2];
  out.rx[at] = offset[0] * voxel_size_m_;
  out.ry[at] = offset[1] * voxel_size_m_;
  out.rz[at] = offset[2] * voxel_size_m_;
  out.nx[at] = dot(pose.rotation[0], shell.nx[point], shell.ny[point], shell.nz[point]);
  out.ny[at] = dot(pose.rotation[1], shell.nx[point], shell.ny[point], shell.nz[point]);
  out.nz[at] = dot(pose.rotation[2], shell.nx[point], shell.ny[point], shell.nz[point]);
  ++out.count_of_value[value];
}

void ContactQuery::collect(const VoxelPose& pose, std::span<const std::uint32_t> rows,
                           PointColumns& out) const noexcept {
  if (use_kernel_) {
    collect_rows(kernel_map_, kernel_shell_, pose, rows.data(),
                 static_cast<std::uint32_t>(rows.size()), out);
    return;
  }
  for (const std::uint32_t row : rows) {
    const std::uint32_t begin = row * kRowPoints;
    const std::uint32_t end = std::min(begin + kRowPoints, kernel_shell_.point_count);
    for (std::uint32_t point = begin; point < end; ++point) collect_point(pose, point, out);
  }
}

// The first pass of a chunk.
void ContactQuery::look_up(const VoxelPose& pose, std::uint32_t super_blocks, std::size_t chunk,
                           CollectedPoints& out) noexcept {
  const std::size_t begin = super_blocks * chunk / chunk_count_,
                    end = super_blocks * (chunk + 1) / chunk_count_;
  Chunk found;
  found.rows =
      skipper_.candidates(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
  found.first = std::size_t{skipper_.first_row(begin)} * kRowPoints;
  found.points = columns(out, found.first);
  found.points.pass = found_all_ ? Pass::kLookUpAndAppend : Pass::kLookUp;
  found.points.values = &values_[found.first];
  collect(pose, found.rows, found.points);
  chunks_[chunk] = found;
}

// The second pass. Vectors are stored whole, beyond the last point too, where those of the next
// chunk may be; so a chunk's last points go by way of a room of their own.
void ContactQuery::append(const VoxelPose& pose, Chunk& chunk) noexcept {
  std::size_t last = chunk.rows.size();
  for (std::ptrdiff_t count = 0; last > 0 && count < kRowPoints;) {
    const std::uint8_t* const row = &values_[chunk.first + --last * kRowPoints];
    count += kRowPoints - std::count(row, row + kRowPoints, 0);
  }
  PointColumns points = chunk.points;
  points.pass = Pass::kAppend;
  points.values = &values_[chunk.first];
  collect(pose, chunk.rows.first(last), points);
  LastPoints room;
  PointColumns behind = columns(room, 0);
  behind.pass = Pass::kAppend;
  behind.values = points.values;
  collect(pose, chunk.rows.subspan(last), behind);
  append_points(behind, points);
  chunk.points = points;
}

// Each thread takes the next chunk of super-blocks, finds their rows, and looks these up. Once the
// points of all chunks are counted, each chunk's have their place, and threads put them there. So
// the result does not depend on which thread did which chunk.
void ContactQuery::collect_shared(const VoxelPose& pose, std::uint32_t super_blocks,
                                  CollectedPoints& out) noexcept {
  struct SharedRun {
    ContactQuery& query;
    const VoxelPose& pose;
    std::uint32_t super_blocks;
    CollectedPoints& out;
  };
  SharedRun run{*this, pose, super_blocks, out};
  const auto largest = static_cast<std::uint32_t>(chunks_.size());
  chunk_count_ = std::min(super_blocks, largest);
  const std::span<Chunk> chunks(chunks_.data(), chunk_count_);
  workers_->run(
      [](void* context, std::uint32_t chunk) noexcept {
        const SharedRun& r = *static_cast<const SharedRun*>(context);
        r.query.look_up(r.pose, r.super_blocks, chunk, r.out);
      },
      &run, chunk_count_);
  std::uint32_t at = 0;
  for (Chunk& chunk : chunks) {
    points_looked_at_ += chunk.rows.size() * kRowPoints;
    out.outside_map = out.outside_map || chunk.points.outside_map;
    chunk.end = at + chunk.points.count;
    chunk.in_place = found_all_ && at == chunk.first;
    if (!chunk.in_place) chunk.points = columns(out, at);
    at = chunk.end;
  }
  workers_->run(
      [](void* context, std::uint32_t chunk) noexcept {
        const SharedRun& r = *static_cast<const SharedRun*>(context);
        Chunk& c = r.query.chunks_[chunk];
        if (!c.in_place) r.query.append(r.pose, c);
      },
      &run, chunk_count_);
  for (const Chunk& chunk : chunks) take_counts(chunk.points, out);
}

void ContactQuery::wake() noexcept {
  if (workers_) workers_->wake();
}

void ContactQuery::rest() noexcept {
  if (workers_) workers_->rest();
}

std::vector<std::string> ContactQuery::give_helpers_real_time_priority() {
  return workers_ ? workers_->take_real_time_priority() : std::vector<std::string>();
}

void ContactQuery::run(const Pose& world_from_center, CollectedPoints& out) noexcept {
  out.clear();
  const bool worth_sharing = points_looked_at_ >= points_worth_sharing_;
  points_looked_at_ = 0;
  const VoxelPose pose = voxel_pose(world_from_center);
  if (!pose.within_reach) {
    out.outside_map = sphere_beyond_cropped_side(world_from_center.position_m);
    return;
  }
  if (all_free_ && !kernel_map_.cropped) return;
  const std::uint32_t super_blocks =
      skipper_.start(kernel_map_, world_from_center, pose, rounding_voxels());
  if (worth_sharing && workers_ && workers_->awake() && super_blocks > 1) {
    collect_shared(pose, super_blocks, out);
  } else {
    const auto rows = skipper_.candidates(0, super_blocks);
    points_looked_at_ = rows.size() * kRowPoints;
    PointColumns all = columns(out, 0);
    collect(pose, rows, all);
    take_counts(all, out);
  }
  points_looked_at_ = std::min<std::uint64_t>(points_looked_at_, kernel_shell_.point_count);
  found_all_ = out.count == kernel_shell_.point_count;
}

}  // namespace forcelayer::query
