#include "runtime/model/outcome_hash.h"

#include <bit>
#include <initializer_list>

namespace forcelayer::model {
namespace {

// FNV-1a, a 64-bit word at a time.
struct Fnv {
  std::uint64_t hash = 0xcbf29ce484222325u;
  void add(double value) noexcept {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u;
    hash ^= hash >> 32;  // high bits of a word must reach the low ones
  }
  void add(const glm::dvec3& v) noexcept {
    for (const double value : {v.x, v.y, v.z}) add(value);
  }
};

}  // namespace

std::uint64_t outcome_hash(const StepResult& result, const State& after) noexcept {
  Fnv fnv;
  fnv.add(result.wrench.force_n);
  fnv.add(result.wrench.torque_nm);
  const Pose& part = after.world_from_center;
  fnv.add(part.position_m);
  for (const double value :
       {part.orientation.w, part.orientation.x, part.orientation.y, part.orientation.z}) {
    fnv.add(value);
  }
  fnv.add(after.velocity.linear_mps);
  fnv.add(after.velocity.angular_radps);
  return fnv.hash;
}

}  // namespace forcelayer::model
