// The datagram of the pose stream: 384 bytes, little-endian (pose_stream_format.md in the source).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "forcelayer/pose.h"

namespace forcelayer {

inline constexpr std::uint32_t kPoseMagic = 0x53504C46;  // FLPS
inline constexpr std::uint16_t kPoseVersion = 2;

struct PoseDatagram {                       // offset
  std::uint32_t magic;                      //   0  kPoseMagic
  std::uint16_t version;                    //   4  kPoseVersion
  std::uint16_t bytes;                      //   6  384 or more
  std::uint64_t session;                    //   8  start of the run: microseconds since 1970
  std::uint64_t sequence;                   //  16  of the datagram in its session, from 1
  std::uint64_t frame;                      //  24  of the loop
  double time_s;                            //  32  of the loop
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
  double clearance_m;                       // 280  0 where nothing is proven
  std::uint32_t clearance_kind;             // 288  ClearanceKind
  std::uint32_t nearest_object;             // 292  its number in the scene's file; 0: not known
  std::array<double, 3> nearest_point_m;    // 296  of the part; kProven alone
  std::array<char, 64> object_name;         // 320  of the nearest object: UTF-8, zeros behind it
};
static_assert(sizeof(PoseDatagram) == 384);
static_assert(offsetof(PoseDatagram, world_from_part) == 40);
static_assert(offsetof(PoseDatagram, force_n) == 152);
static_assert(offsetof(PoseDatagram, flags) == 220);
static_assert(offsetof(PoseDatagram, world_from_target) == 224);
static_assert(offsetof(PoseDatagram, clearance_m) == 280);
static_assert(offsetof(PoseDatagram, nearest_point_m) == 296);
static_assert(offsetof(PoseDatagram, object_name) == 320);

enum PoseFlag : std::uint32_t {
  kPoseGuardCut = 1,
  kPoseOutsideMap = 2,
  kPoseFaulty = 4,
  kPoseSaturated = 8,
};

// x y z qw qx qy qz, and back.
std::array<double, 7> pose_numbers(const Pose& pose);
Pose pose_from_numbers(const std::array<double, 7>& numbers);

// A datagram's name as text, and a name put into it: cut where it is too long, between two
// characters.
std::string_view object_name_of(const PoseDatagram& datagram);
void set_object_name(PoseDatagram& datagram, std::string_view name);

// The datagram in `bytes`, or nothing where magic, version or size are others, a number is not
// finite, a quaternion is not of unit length to 1e-3, the output is no state, or the clearance is
// negative or of no kind.
std::optional<PoseDatagram> parse_pose_datagram(std::span<const std::byte> bytes);

}  // namespace forcelayer
