// The datagram of the pose stream, byte by byte: pose_stream_format.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "forcelayer/pose.h"

namespace forcelayer {

inline constexpr std::uint32_t kPoseMagic = 0x53504C46;  // FLPS
inline constexpr std::uint16_t kPoseVersion = 1;

struct PoseDatagram {                       // offset
  std::uint32_t magic;                      //   0
  std::uint16_t version;                    //   4
  std::uint16_t bytes;                      //   6
  std::uint64_t session;                    //   8
  std::uint64_t sequence;                   //  16
  std::uint64_t frame;                      //  24
  double time_s;                            //  32
  std::array<double, 7> world_from_part;    //  40
  std::array<double, 7> world_from_handle;  //  96
  std::array<double, 3> force_n;            // 152
  std::array<double, 3> torque_nm;          // 176
  std::uint32_t points_proximity;           // 200
  std::uint32_t points_surface;             // 204
  std::uint32_t points_interior;            // 208
  std::uint32_t contacts;                   // 212
  std::uint32_t output;                     // 216  OutputState
  std::uint32_t flags;                      // 220  PoseFlag bits
  std::array<double, 7> world_from_target;  // 224
};
static_assert(sizeof(PoseDatagram) == 280);
static_assert(offsetof(PoseDatagram, world_from_part) == 40);
static_assert(offsetof(PoseDatagram, force_n) == 152);
static_assert(offsetof(PoseDatagram, flags) == 220);
static_assert(offsetof(PoseDatagram, world_from_target) == 224);

enum PoseFlag : std::uint32_t {
  kPoseGuardCut = 1,
  kPoseOutsideMap = 2,
  kPoseFaulty = 4,
  kPoseSaturated = 8,
};

// x y z qw qx qy qz, and back.
std::array<double, 7> pose_numbers(const Pose& pose);
Pose pose_from_numbers(const std::array<double, 7>& numbers);

// A received datagram, or nothing where the bytes are none (pose_stream_format.md, last paragraph).
std::optional<PoseDatagram> parse_pose_datagram(std::span<const std::byte> bytes);

}  // namespace forcelayer
