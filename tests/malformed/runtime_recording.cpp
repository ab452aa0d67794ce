// Recordings: there and back, bit for bit; and everything that a broken file can be.
#include "runtime/stream/recording.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "forcelayer/run.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop/loop.h"
#include "tests/support/address_limit.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;

std::unique_ptr<model::Simulation> simulation() {
  Voxmap voxmap =
      make_voxmap(offset_scene(kS, {0, 0, -2}, {32, 32, 8}, 2, [](Voxel v) { return v[2] <= 0; }));
  auto run = open_run(std::move(voxmap), make_pshell(sphere_part(0.02, 200, kS)), {});
  if (!run) throw std::runtime_error(to_line(run.error()));
  return run->release_simulation();
}

// A wild hand: jumps, turns, broken samples.
class WildInput final : public loop::InputSource {
 public:
  explicit WildInput(std::uint64_t seed) : random_(seed) {}
  bool next(double, double, StepInput& input) noexcept override {
    Pose& pose = input.world_from_handle;
    pose.position_m = {0.08, 0.08, uniform(random_, 0.02, 0.06)};
    pose.orientation = random_orientation(random_);
    input.handle_velocity = {random_direction(random_), random_direction(random_)};
    input.valid = random_() % 20 != 0;
    input.buttons = static_cast<std::uint32_t>(random_());
    if (random_() % 50 == 0) pose.position_m.x = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  void output(const Frame&) noexcept override {}
  void silence() noexcept override {}
  const DevicePlacement& placement() const override { return placement_; }

 private:
  Random random_;
  DevicePlacement placement_;
};

void record(const std::filesystem::path& path, std::uint64_t seed, int frames,
            std::uint64_t lost_frames = 0) {
  auto sim = simulation();
  WildInput input(seed);
  const Pose start{{0.08, 0.08, 0.05}, {1, 0, 0, 0}};
  const State state = sim->registered(start, start);
  auto writer = stream::RecordingWriter::create(path);
  ASSERT_TRUE(writer);
  writer->begin(stream::describe_run(*sim, state, {}));
  loop::Servo servo(*sim, input, state, {});
  Frame frame;
  for (int i = 0; i < frames; ++i) {
    servo.tick(frame);
    ASSERT_TRUE(writer->add(frame));
  }
  ASSERT_TRUE(writer->finish(lost_frames));
}

std::string read_bytes(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Result<stream::Recording> open_bytes(const std::string& bytes) {
  const ScratchFolder folder;
  std::ofstream(folder / "cut.flr", std::ios::binary) << bytes;
  return stream::Recording::open(folder / "cut.flr");
}

TEST(Recording, ReplaysBitForBit) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ScratchFolder folder;
    record(folder / "run.flr", seed, 4000);
    const auto recording = stream::Recording::open(folder / "run.flr");
    ASSERT_TRUE(recording);
    EXPECT_EQ(recording->frames().size(), 4000u);
    auto sim = simulation();
    ASSERT_TRUE(recording->check_files(sim->voxmap(), sim->shell()));
    stream::ReplayInput input(*recording);
    loop::Servo servo(*sim, input, recording->run().start, {});
    loop::LoopOptions options;
    options.as_fast_as_possible = true;
    const auto statistics = std::make_unique<loop::LoopStatistics>();
    loop::run_loop(servo, options, nullptr, *statistics);
    EXPECT_EQ(statistics->frames, 4000u);
    EXPECT_GT(statistics->faulty_frames, 100u);
    EXPECT_GT(statistics->force_layer_frames, 50u);
    EXPECT_EQ(input.differing_frames(), 0u) << "seed " << seed;
  }
}

// The comparison itself must see a difference of one bit.
TEST(Recording, AReplayThatDiffersIsSeen) {
  const ScratchFolder folder;
  record(folder / "run.flr", 7, 100);
  auto bytes = read_bytes(folder / "run.flr");
  const std::size_t frame_50 =
      bytes.size() - sizeof(stream::RecordingTrailer) - 50 * sizeof(stream::RecordedFrame);
  bytes[frame_50 + offsetof(stream::RecordedFrame, world_from_handle)] ^= 1;  // lowest bit of x
  const auto recording = open_bytes(bytes);
  ASSERT_TRUE(recording);
  auto sim = simulation();
  stream::ReplayInput input(*recording);
  loop::Servo servo(*sim, input, recording->run().start, {});
  Frame frame;
  while (servo.tick(frame)) {
  }
  EXPECT_GT(input.differing_frames(), 0u);
  EXPECT_GE(input.first_difference(), 50u);
}

TEST(Recording, EveryPrefixAndEveryTrailIsAnError) {
  const ScratchFolder folder;
  record(folder / "run.flr", 1, 3);
  const std::string bytes = read_bytes(folder / "run.flr");
  ASSERT_TRUE(open_bytes(bytes));
  for (std::size_t size = bytes.size(); size-- > 0;) {
    std::filesystem::resize_file(folder / "run.flr", size);
    const auto cut = stream::Recording::open(folder / "run.flr");
    ASSERT_FALSE(cut) << size;
    EXPECT_EQ(exit_status(cut.error().code), 4) << size;
  }
  EXPECT_FALSE(open_bytes(bytes + '\0'));
  EXPECT_FALSE(open_bytes(bytes + std::string(128, '\0')));
}

TEST(Recording, FieldsOutOfRangeAreNamed) {
  const ScratchFolder folder;
  record(folder / "run.flr", 1, 3);
  const std::string bytes = read_bytes(folder / "run.flr");
  const struct {
    std::size_t offset;
    char value;
    ErrorCode code;
  } cases[] = {
      {0, 'x', ErrorCode::kNotThisFormat},   {8, 0x01, ErrorCode::kWrongEndianness},
      {12, 1, ErrorCode::kUnknownVersion},   {16, 17, ErrorCode::kFieldInvalid},
      {21, 127, ErrorCode::kFieldInvalid},    // parameter_count beyond the limit
      {24, 64, ErrorCode::kFieldInvalid},     // frame_bytes
      {28, 99, ErrorCode::kFieldInvalid},     // model
      {32, 99, ErrorCode::kFieldInvalid},     // force
      {36, 2, ErrorCode::kFieldInvalid},      // braking
      {87, 0x7f, ErrorCode::kFieldInvalid},   // a quaternion that is not unit
      {231, -1, ErrorCode::kFieldInvalid},    // negative motion scale
      {231, 0x7f, ErrorCode::kFieldInvalid},  // and one of 1e300 and more
      {288, 3, ErrorCode::kFieldInvalid},     // seat
      {288, 2, ErrorCode::kFieldInvalid},     // a seat whose pose is invalid
      {300, 1, ErrorCode::kFieldInvalid},     // reserved
      {320, 'X', ErrorCode::kFieldInvalid},   // an unknown name where a needed one stood
  };
  for (const auto& c : cases) {
    std::string broken = bytes;
    broken[c.offset] = c.value;
    const auto opened = open_bytes(broken);
    ASSERT_FALSE(opened) << c.offset;
    EXPECT_EQ(opened.error().code, c.code) << c.offset;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const struct {
    const char* name;
    double value;
    const char* says;
  } numbers[] = {{"max_force_n", -15, "-15 is outside the range 0 to 1000"},
                 {"max_force_n", 1e300, "1e+300 is outside the range 0 to 1000"},
                 {"max_torque_nm", 101, "101 is outside the range 0 to 100"},
                 {"max_torque_nm", kInfinity, "inf is outside the range 0 to 100"},
                 {"coupling_n_per_m", -1, "-1 is outside the range 0 to 1e+30"},
                 {"coupling_n_per_m", kInfinity, "inf is outside the range 0 to 1e+30"},
                 {"coupling_torque_limit_nm", -kInfinity, "-inf is outside the range 0 to 1e+30"},
                 {"look_ups", -4, "-4 is outside the range 0 to 1e+30"},
                 {"rate_hz", 1e9, "1e+09 is outside the range 1 to 100000"},
                 {"rate_hz", 1e-3, "0.001 is outside the range 1 to 100000"}};
  for (const auto& c : numbers) {
    SCOPED_TRACE(testing::Message() << c.name << " " << c.value);
    std::string broken = bytes;
    // The number stands after a name of 56 bytes.
    std::memcpy(broken.data() + broken.find(c.name) + 56, &c.value, sizeof c.value);
    const auto opened = open_bytes(broken);
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().where, std::string("parameter ") + c.name);
    EXPECT_EQ(opened.error().what, c.says);
  }
  for (const char* limit : {"max_force_n", "max_torque_nm"}) {  // of a device without motors
    std::string unpowered = bytes;
    const double none = 0;
    std::memcpy(unpowered.data() + unpowered.find(limit) + 56, &none, sizeof none);
    EXPECT_TRUE(open_bytes(unpowered)) << limit;
  }
  std::string mixed = bytes;
  mixed[28] = 0;  // the paper's model
  mixed[32] = 1;  // the level field
  EXPECT_EQ(open_bytes(mixed).error().what, "has a force field that the paper's model cannot use");
  std::string newer = bytes;
  newer[14] = 9;  // a higher minor version is read
  EXPECT_TRUE(open_bytes(newer));
}

TEST(Recording, NoCountAsksForMemory) {
  const ScratchFolder folder;
  record(folder / "run.flr", 1, 3);
  const std::string bytes = read_bytes(folder / "run.flr");
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 4) {
    for (const std::uint64_t number : {0x7fffffff7fffffffull, 0xffffffffffffffffull}) {
      std::string broken = bytes;
      std::memcpy(broken.data() + at, &number, sizeof number);
      std::ofstream(folder / "broken.flr", std::ios::binary) << broken;
      const AddressLimit limit(std::uint64_t{16} << 20);
      const auto opened = stream::Recording::open(folder / "broken.flr");
      EXPECT_TRUE(opened || exit_status(opened.error().code) == 4) << at;
    }
  }
}

TEST(Recording, WhatItsReaderWouldRefuseIsNotWritten) {
  const ScratchFolder folder;
  std::ofstream(folder / "run.flr") << "old";
  auto sim = simulation();
  const Pose start{{0.08, 0.08, 0.05}, {1, 0, 0, 0}};
  auto run = stream::describe_run(*sim, sim->registered(start, start), {});
  run.parameters.mass_kg = -1;
  auto writer = stream::RecordingWriter::create(folder / "run.flr");
  ASSERT_TRUE(writer);
  writer->begin(run);
  const Status written = writer->finish(0);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kInternal);
  EXPECT_EQ(read_bytes(folder / "run.flr"), "old");
}

TEST(Recording, LostFramesMakeItUseless) {
  const ScratchFolder folder;
  record(folder / "run.flr", 1, 3, 2);
  const auto recording = stream::Recording::open(folder / "run.flr");
  ASSERT_FALSE(recording);
  EXPECT_NE(recording.error().what.find("2 frames were lost"), std::string::npos);
}

}  // namespace
}  // namespace forcelayer::test
