// A recording of a run, byte by byte: all that a replay needs to repeat it bit for bit. All numbers
// are little-endian. recording_format.md explains the values.
//
//   header | parameter_count parameters | frames | trailer
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace forcelayer::stream {

inline constexpr std::array<std::uint8_t, 8> kRecordingMagic = {0x89, 'F',  'L',  'R',
                                                                '\r', '\n', 0x1a, '\n'};
inline constexpr std::array<std::uint8_t, 8> kRecordingEndMagic = {0x89, 'F',  'L',  'E',
                                                                   '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kRecordingEndianTag = 0x01020304;
inline constexpr std::uint16_t kRecordingMajor = 2;
inline constexpr std::uint16_t kRecordingMinor = 1;
inline constexpr std::uint32_t kMaxRecordedParameters = 256;

struct RecordingHeader {                     // offset
  std::array<std::uint8_t, 8> magic;         //   0
  std::uint32_t endian_tag;                  //   8
  std::uint16_t major;                       //  12
  std::uint16_t minor;                       //  14
  std::uint32_t header_bytes;                //  16  320
  std::uint32_t parameter_count;             //  20
  std::uint32_t frame_bytes;                 //  24  128
  std::uint32_t model;                       //  28  Model
  std::uint32_t force;                       //  32  ForceKind
  std::uint32_t braking;                     //  36  0 or 1
  std::uint64_t voxmap_checksum;             //  40  FileHeader::header_checksum of the .vox
  std::uint64_t shell_checksum;              //  48  the same of the .pshell
  std::array<double, 7> world_from_center;   //  56  at the start: x y z (m), qw qx qy qz
  std::array<double, 7> handle_from_center;  // 112  the grip, in the same way
  std::array<double, 7> world_from_device;   // 168  placement, in the same way
  double motion_scale;                       // 224
  std::array<double, 7> world_from_seat;     // 232  of the part's centroid frame where it is seated
  std::uint32_t seat;                        // 288  SeatUse at the start
  std::array<std::uint8_t, 28> reserved;     // 292  zero
};
static_assert(sizeof(RecordingHeader) == 320);
static_assert(offsetof(RecordingHeader, seat) == 288);
static_assert(offsetof(RecordingHeader, world_from_center) == 56);
static_assert(offsetof(RecordingHeader, motion_scale) == 224);

struct RecordedParameter {    // offset
  std::array<char, 56> name;  //  0  zero-padded, at least one zero
  double value;               // 56
};
static_assert(sizeof(RecordedParameter) == 64);

struct RecordedFrame {                      // offset
  std::array<double, 7> world_from_handle;  //   0  x y z (m), qw qx qy qz
  std::array<double, 6> handle_velocity;    //  56  linear (m/s), angular (rad/s)
  std::uint32_t buttons;                    // 104
  std::uint32_t valid;                      // 108  InputUse
  std::uint64_t outcome_hash;               // 112  of the wrench and the state after the step
  float age_fraction;                       // 120  InputHealth::age_fraction
  std::uint32_t health;                     // 124  InputTrouble, RecordedHealth bits, output_fall
};
static_assert(sizeof(RecordedFrame) == 128);

enum RecordedHealth : std::uint32_t {
  kRecordedTroubleMask = 0xff,
  kRecordedClutch = 0x100,
  kRecordedOutputHeld = 0x200,
  kRecordedLoopLate = 0x400,
  kRecordedSwapping = 0x800,
};
inline constexpr std::uint32_t kRecordedFallShift = 16;  // above: InputHealth::output_fall, in
                                                         // kFallSteps

struct RecordingTrailer {             // offset
  std::array<std::uint8_t, 8> magic;  //  0
  std::uint64_t frame_count;          //  8
  std::uint64_t lost_frames;          // 16  that are missing: then no replay
  std::uint64_t reserved;             // 24  zero
};
static_assert(sizeof(RecordingTrailer) == 32);

}  // namespace forcelayer::stream
