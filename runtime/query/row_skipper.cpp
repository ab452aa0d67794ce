#include "runtime/query/row_skipper.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "runtime/query/contact_query.h"

namespace forcelayer::query {
namespace {

constexpr double kDiscRounding = 1 + 1e-6;  // of extents along an axis that is not quite unit
constexpr float kAxes = 1.7320509f;         // a bound per axis is this much along any direction
constexpr float kAxisRounding = 1e-4f;      // voxels: of a disc's height along an axis of floats
// Leeway is sought for a number of runs like the last one, within bounds in voxels. More lasts
// longer, and takes more bricks to find. Beside a wall a part slides and turns farther than it
// presses.
constexpr float kMaxRuns = 60, kMinLeeway = 0.5f;
constexpr Leeway kMaxBlockLeeway = {3, 8}, kMaxRowLeeway = {2, 6};
// Runs that leeway must last, else looking up is cheaper than trying again.
constexpr float kMinRuns = 2;
// A piece that is not free most likely has points in contact, now and in the next runs; trying a
// row costs about as much as looking it up. So after a try in vain it is let be for 16 to 31 looks,
// by its number, and after each further one for twice as many, up to eight times: pieces that were
// all tried in one run are not all tried again in one, which would take several times as long.
constexpr std::uint8_t kMaxDoublings = 3;

std::uint8_t looks_until_tried(std::uint32_t piece, std::uint8_t doublings) {
  return static_cast<std::uint8_t>((16 + (piece * 2654435761u >> 28)) << doublings);
}

std::array<float, 3> middle_of(const PshellView& shell, std::uint64_t begin, std::uint64_t end) {
  std::array<float, 3> middle{};
  for (int axis = 0; const float* column : {shell.x, shell.y, shell.z}) {
    const auto [low, high] = std::minmax_element(column + begin, column + end);
    middle[axis++] = (*low + *high) / 2;
  }
  return middle;
}

}  // namespace

PartDisc disc_of(const PshellView& shell, std::uint64_t begin, std::uint64_t end,
                 const std::array<float, 3>& center) {
  glm::dvec3 sum(0);
  for (std::uint64_t i = begin; i < end; ++i) {
    sum += glm::dvec3(shell.nx[i], shell.ny[i], shell.nz[i]);
  }
  const double length = glm::length(sum);
  const glm::vec3 axis = length > 1e-6 ? glm::vec3(sum / length) : glm::vec3(0, 0, 1);
  const glm::dvec3 unit = glm::normalize(glm::dvec3(axis));
  double radius2_m2 = 0, half_height_m = 0;
  for (std::uint64_t i = begin; i < end; ++i) {
    const glm::dvec3 from_center(double{shell.x[i]} - center[0], double{shell.y[i]} - center[1],
                                 double{shell.z[i]} - center[2]);
    const double along = glm::dot(from_center, unit);
    const glm::dvec3 across = from_center - along * unit;
    half_height_m = std::max(half_height_m, std::abs(along));
    radius2_m2 = std::max(radius2_m2, glm::dot(across, across));
  }
  const auto radius = static_cast<float>(std::sqrt(radius2_m2) * kDiscRounding),
             half_height = static_cast<float>(half_height_m * kDiscRounding);
  return {Four{center[0], center[1], center[2], radius}, Four{axis.x, axis.y, axis.z, half_height}};
}

RowSkipper::Pieces RowSkipper::cut(const PshellView& shell, std::uint64_t piece_points) {
  Pieces pieces;
  for (std::uint64_t begin = 0; begin < shell.point_count; begin += piece_points) {
    const std::uint64_t end = std::min(begin + piece_points, shell.point_count);
    pieces.discs.push_back(disc_of(shell, begin, end, middle_of(shell, begin, end)));
  }
  pieces.found = std::vector<FoundFree>(pieces.discs.size());
  pieces.free_until.assign(pieces.discs.size(), kNever);
  pieces.let_be.assign(pieces.discs.size(), 0);
  pieces.doublings.assign(pieces.discs.size(), 0);
  return pieces;
}

RowSkipper::RowSkipper(const Voxmap& voxmap, const Pshell& shell, bool coherence)
    : coherence_(coherence),
      bounds_(voxmap),
      block_rows_(shell.view().block_points / kRowPoints),
      blocks_(cut(shell.view(), shell.view().block_points)),
      rows_(cut(shell.view(), kRowPoints)) {
  row_count_ = static_cast<std::uint32_t>(rows_.discs.size());
}

void RowSkipper::forget() noexcept {
  for (Pieces* pieces : {&blocks_, &rows_}) {
    std::fill(pieces->free_until.begin(), pieces->free_until.end(), kNever);
    for (FoundFree& found : pieces->found) found.leeway = {};
  }
  has_base_ = false;
}

void RowSkipper::start(const KernelMap& map, const VoxelPose& pose, const DiscMargin& margin,
                       const LastMotion& last) noexcept {
  if (!has_base_) base_ = pose.whole;
  has_base_ = true;
  map_ = &map;
  whole_ = pose.whole;
  scale_ = margin.scale;
  margin_ = kAxes * margin.voxels + kAxisRounding;
  last_ = last;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t column = 0; column < 3; ++column) {
      turn_[column][axis] = pose.turn[axis][column];
      rotation_[column][axis] = pose.rotation[axis][column];
    }
    fraction_[axis] = pose.fraction[axis];
    from_base_[axis] = static_cast<float>(whole_[axis] - base_[axis]);
  }
}

RowSkipper::Placed RowSkipper::place(const PartDisc& disc) const noexcept {
  const auto sum = [](const std::array<Four, 3>& columns, Four v) {
    return columns[0] * v[0] + columns[1] * v[1] + columns[2] * v[2];
  };
  return {sum(turn_, disc.place) + fraction_, sum(rotation_, disc.shape)};
}

// By how much the last run's motion moved a disc's points along and across its axis, about.
Leeway RowSkipper::last_motion(const Placed& disc, float radius) const noexcept {
  const Four arm = disc.center - fraction_;
  const glm::vec3 moved =
      last_.travel_voxels + glm::cross(last_.turn_rad, glm::vec3(arm[0], arm[1], arm[2]));
  const glm::vec3 axis(disc.axis[0], disc.axis[1], disc.axis[2]);
  const float tilt = glm::length(last_.turn_rad) * radius;
  return {std::abs(glm::dot(axis, moved)) + tilt, glm::length(moved) + tilt};
}

// How far, in voxels, each point of a disc may move from where it is now, since it was found free.
// A disc that tilted is compared with itself tilted back about its center, which moves no point of
// it by more than the change of its unit axis times its reach. At most 0 where it has left.
float RowSkipper::leeway_left(const FoundFree& found, const Placed& now,
                              const PartDisc& disc) const noexcept {
  const Four moved = now.center + from_base_ - found.at.center;
  const Four tilted = now.axis - found.at.axis;
  const float reach = (disc.place[3] + disc.shape[3]) * scale_;
  return std::min(found.leeway.along - std::abs(dot3(moved, found.at.axis)),
                  found.leeway.across - std::sqrt(dot3(moved, moved))) -
         (std::sqrt(dot3(tilted, tilted)) * reach + 2 * margin_ + kMotionRounding);
}

// Whether a disc that is not known to be free is.
bool RowSkipper::look_around(Pieces& pieces, std::uint32_t i, const Leeway& largest, float spent,
                             std::uint32_t& tries) noexcept {
  FoundFree& found = pieces.found[i];
  const PartDisc& disc = pieces.discs[i];
  const Placed now = place(disc);
  if (coherence_ && found.leeway.along > 0) {
    const float left = leeway_left(found, now, disc);
    if (left > 0) {
      pieces.free_until[i] = spent + left;
      return true;
    }
    found.leeway = {};
    pieces.free_until[i] = kNever;
    if (tries == 0) return false;
  }
  const PlacedDisc placed = {{now.center[0], now.center[1], now.center[2]},
                             whole_,
                             {now.axis[0], now.axis[1], now.axis[2]},
                             disc.place[3] * scale_,
                             disc.shape[3] * scale_,
                             margin_};
  const Leeway last = last_motion(now, placed.radius);
  const Leeway wanted = {std::clamp(kMaxRuns * last.along, kMinLeeway, largest.along),
                         std::clamp(kMaxRuns * last.across, kMinLeeway, largest.across)};
  const float fraction = bounds_.fraction(*map_, placed, wanted);
  const Leeway leeway = {fraction * wanted.along, fraction * wanted.across};
  const float left = std::min(leeway.along, leeway.across) - kMotionRounding;
  if (left > 0 && leeway.along > kMotionRounding + kMinRuns * last.along &&
      leeway.across > kMotionRounding + kMinRuns * last.across) {
    found = {{now.center + from_base_, now.axis}, leeway};
    pieces.free_until[i] = spent + left;
    pieces.doublings[i] = 0;
    return true;
  }
  found.leeway = {};
  pieces.free_until[i] = kNever;
  if (coherence_) {
    --tries;
    pieces.let_be[i] = looks_until_tried(i, pieces.doublings[i]);
    if (pieces.doublings[i] < kMaxDoublings) ++pieces.doublings[i];
  }
  return false;
}

inline bool RowSkipper::is_free(Pieces& pieces, std::uint32_t i, const Leeway& largest, float spent,
                                std::uint32_t& tries) noexcept {
  if (coherence_) {
    if (spent < pieces.free_until[i]) return true;
    if (pieces.let_be[i] > 0) {
      --pieces.let_be[i];
      return false;
    }
    if (tries == 0 && pieces.free_until[i] == kNever) return false;
  }
  return look_around(pieces, i, largest, spent, tries);
}

float RowSkipper::known_free_until(std::uint32_t block, float spent) noexcept {
  if (!coherence_ || blocks_.free_until[block] == kNever) return kNever;
  const PartDisc& disc = blocks_.discs[block];
  const float left = leeway_left(blocks_.found[block], place(disc), disc);
  if (!(left > 0)) return kNever;
  return blocks_.free_until[block] = spent + left;
}

float RowSkipper::take_near(std::uint32_t block, float spent, std::uint32_t& tries,
                            std::uint32_t* rows, std::uint32_t& count) noexcept {
  if (is_free(blocks_, block, kMaxBlockLeeway, spent, tries)) return blocks_.free_until[block];
  const std::uint32_t before = count, begin = block * block_rows_;
  const std::uint32_t end = std::min(begin + block_rows_, row_count_);
  float until = std::numeric_limits<float>::max();
  for (std::uint32_t row = begin; row < end; ++row) {
    if (!is_free(rows_, row, kMaxRowLeeway, spent, tries)) rows[count++] = row;
    until = std::min(until, rows_.free_until[row]);
  }
  return count == before ? until : kNever;
}

}  // namespace forcelayer::query
