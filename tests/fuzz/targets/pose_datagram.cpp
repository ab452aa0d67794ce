// A datagram that the pose receiver may get from anyone.
#include "forcelayer/pose_datagram.h"

#include <cmath>

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const auto datagram = parse_pose_datagram(fuzz::bytes_of(data, size));
  if (!datagram) return 0;
  const Pose pose = pose_from_numbers(datagram->world_from_part);
  fuzz::require(std::isfinite(pose.position_m.x), "a datagram that parses holds a pose");
  fuzz::require(std::abs(glm::length(pose.orientation) - 1) < 1e-3, "and a rotation");
  fuzz::require(datagram->clearance_m >= 0, "and a clearance");
  fuzz::require(object_name_of(*datagram).size() <= datagram->object_name.size(), "and a name");
  return 0;
}
