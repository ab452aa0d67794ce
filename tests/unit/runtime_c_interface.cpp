// The C header: where the part begins, what is refused, and the swap of scene and part from another
// thread while the servo thread goes on.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <limits>
#include <thread>
#include <utility>

#include "forcelayer/forcelayer.h"
#include "formats/digest/file_digest.h"
#include "runtime/coupling/coupling.h"
#include "runtime/machine/real_time.h"
#include "tests/support/both_models.h"
#include "tests/support/distance_scene.h"
#include "tests/support/file_surgery.h"
#include "tests/support/places.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

using Numbers = std::array<double, 7>;

Numbers numbers(const Pose& pose) {
  const glm::dvec3& p = pose.position_m;
  const glm::dquat& q = pose.orientation;
  return {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
}

Pose pose(const double* n) { return {{n[0], n[1], n[2]}, glm::dquat(n[3], n[4], n[5], n[6])}; }

double distance_m(const Pose& a, const Pose& b) { return glm::length(a.position_m - b.position_m); }
double angle_rad(const Pose& a, const Pose& b) {
  return glm::length(coupling::rotation_vector(a.orientation * glm::conjugate(b.orientation)));
}

forcelayer_reading reading_at(const Pose& device_from_handle) {
  forcelayer_reading reading{};
  const Numbers n = numbers(device_from_handle);
  std::copy(n.begin(), n.end(), reading.device_from_handle);
  reading.fresh = reading.present = reading.calibrated = 1;
  return reading;
}

// A ball up to z = 20 mm that its layers surround in the box, with distances.
VoxelScene ball_scene() {
  const glm::dvec3 center_m(0.12, 0.12, 0.005);
  return distance_scene(
      0.005, {0, 0, -8}, {48, 48, 40},
      [&](const glm::dvec3& p) { return glm::length(p - center_m) - 0.015; }, 2,
      DistanceDefinition(2));
}

// A slab whose force layer is z in [10, 15) mm, a ball of 20 mm and one of 30 mm.
struct CInterface : BothModels {
  CInterface() {
    const auto slab = [](Voxel v) { return v[2] <= 0; };
    save_voxmap(folder / "floor.vox",
                closed(offset_scene(0.005, {0, 0, -2}, {48, 40, 8}, 2, slab)));
    save_pshell(folder / "ball.pshell", sphere_part(0.02, 400, 0.005));
    save_pshell(folder / "large.pshell", sphere_part(0.03, 900, 0.005));
    forcelayer_default_options(&options);
    EXPECT_EQ(options.model, FORCELAYER_MODEL_DEFAULT);
    options.model =
        GetParam() == Model::kDefault ? FORCELAYER_MODEL_DEFAULT : FORCELAYER_MODEL_PAPER;
    options.stale_s = 1000;  // nothing here is about the clock
  }
  ~CInterface() override { forcelayer_close(runtime); }

  std::string file(const char* name) const { return (folder / name).string(); }
  void open(const char* scene = "floor.vox") {
    forcelayer_close(runtime);
    runtime = forcelayer_open(file(scene).c_str(), file("ball.pshell").c_str(), &options, error,
                              sizeof error);
    ASSERT_NE(runtime, nullptr) << error;
  }
  int start(const Pose* world_from_part, const Pose* handle_from_part,
            const forcelayer_reading& first) {
    Numbers part{}, grip{};
    if (world_from_part != nullptr) part = numbers(*world_from_part);
    if (handle_from_part != nullptr) grip = numbers(*handle_from_part);
    return forcelayer_start(runtime, world_from_part ? part.data() : nullptr,
                            handle_from_part ? grip.data() : nullptr, &first, error, sizeof error);
  }
  forcelayer_state state() const {
    forcelayer_state last;
    std::memset(&last, 0xff, sizeof last);
    forcelayer_last_state(runtime, &last, sizeof last);
    return last;
  }
  double guaranteed_m() const {
    double tested_m = -1, swept_m = -1;
    forcelayer_guarantee(runtime, &tested_m, &swept_m);
    EXPECT_GE(tested_m, swept_m);
    return tested_m;
  }
  int swap(const char* scene, const char* part, const Pose& world_from_part,
           double timeout_s = 60) {
    error[0] = 0;
    return forcelayer_swap(runtime, file(scene).c_str(), file(part).c_str(),
                           numbers(world_from_part).data(), nullptr, timeout_s, error,
                           sizeof error);
  }

  ScratchFolder folder;
  forcelayer_options options{};
  forcelayer_runtime* runtime = nullptr;
  char error[512] = "";
};

INSTANTIATE_TEST_SUITE_P(Models, CInterface, kBothModels, name_of_model);

// A quaternion of few bits is as long as its rounding makes it: held by the rotation alone, the
// part stays where it was put.
TEST_P(CInterface, AQuaternionOfFewBitsDoesNotMoveThePart) {
  open();
  const Pose place{{0.2, 0.1, 0.9}, {1, 0, 0, 0}};
  for (const double length : {0.9995, 1.0005}) {
    forcelayer_reading reading = reading_at({{0.1, 0.1, 0.8}, glm::dquat(0.6, 0, 0.8, 0)});
    for (int i = 3; i < 7; ++i) reading.device_from_handle[i] *= length;
    ASSERT_EQ(start(&place, nullptr, reading), 0) << error;
    forcelayer_result result;
    for (int i = 0; i < 300; ++i) ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
    EXPECT_LT(distance_m(pose(result.world_from_part), place), 1e-12) << length;
  }
}

// Against the definition, written out: world_from_device * (scaled reading) is the handle; the part
// begins at its place, else where the grip has it; the hand then pulls it to where the grip has it.
TEST_P(CInterface, PlacesDeviceGripAndPart) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const Pose world_from_device{random_direction(random), random_orientation(random)};
    const Numbers placed = numbers(world_from_device);
    std::copy(placed.begin(), placed.end(), options.world_from_device);
    options.motion_scale = uniform(random, 0.3, 3);
    open();
    // Far above the slab: nothing touches.
    const Pose world_from_handle{glm::dvec3(0.1, 0.1, 0.8) + 0.2 * random_direction(random),
                                 random_orientation(random)};
    Pose device_from_handle = inverse(world_from_device) * world_from_handle;
    device_from_handle.position_m /= options.motion_scale;
    const Pose grip{0.05 * random_direction(random), random_orientation(random)};
    const Pose place{
        world_from_handle.position_m + 0.01 * random_direction(random),
        world_from_handle.orientation * coupling::rotation_by(0.2 * random_direction(random))};
    const forcelayer_reading reading = reading_at(device_from_handle);
    const struct {
      const Pose *place, *grip;
      Pose first, last;
    } cases[] = {
        {nullptr, nullptr, world_from_handle, world_from_handle},
        {&place, nullptr, place, place},
        {nullptr, &grip, world_from_handle * grip, world_from_handle * grip},
        {&place, &grip, place, world_from_handle * grip},
    };
    for (const auto& c : cases) {
      SCOPED_TRACE(std::string(c.place ? "a place " : "") + (c.grip ? "a grip" : ""));
      ASSERT_EQ(start(c.place, c.grip, reading), 0) << error;
      forcelayer_result result;
      ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
      // In its first frame a part that is pulled turns by less than a third of its way, at every
      // scale, and its grip moves by less than 2 mm of the device's: mass and force are scaled with
      // the scene.
      const bool pulled = c.place != nullptr && c.grip != nullptr;
      const double turned_rad = angle_rad(pose(result.world_from_part), c.first);
      EXPECT_LT(turned_rad, pulled ? angle_rad(c.first, c.last) / 3 : 1e-12);
      EXPECT_LT(
          distance_m(pose(result.world_from_part), c.first),
          pulled ? 2e-3 * options.motion_scale + glm::length(grip.position_m) * turned_rad : 1e-12);
      EXPECT_EQ(result.output, unsigned{FORCELAYER_ARMED});
      for (int i = 0; i < 1500; ++i) forcelayer_step(runtime, &reading, &result);
      // A part that is not pulled stays; one that is comes near (1e-5: the coupling creeps).
      EXPECT_LT(distance_m(pose(result.world_from_part), c.last), pulled ? 1e-5 : 1e-12);
      EXPECT_LT(angle_rad(pose(result.world_from_part), c.last), pulled ? 1e-3 : 1e-12);
    }
  }
}

// A ball over a floor: measured near it, "at least" far away, and nothing by the paper's model.
TEST_P(CInterface, TellsTheClearance) {
  save_voxmap(folder / "distances.vox", ball_scene());
  open("distances.vox");
  const bool tells = GetParam() == Model::kDefault;
  for (const double gap_m : {0.015, 0.05}) {  // beyond the force, which begins at 14.3 mm
    const Pose place{{0.12, 0.12, 0.02 + 0.02 + gap_m}, {1, 0, 0, 0}};
    const forcelayer_reading reading = reading_at(place);
    ASSERT_EQ(start(nullptr, nullptr, reading), 0) << error;
    forcelayer_result result;
    ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
    const unsigned near =
        gap_m < 0.02 ? FORCELAYER_CLEARANCE_PROVEN : FORCELAYER_CLEARANCE_AT_LEAST;
    EXPECT_EQ(result.clearance, tells ? near : unsigned{FORCELAYER_CLEARANCE_NONE});
    EXPECT_LE(result.clearance_m, gap_m);
    EXPECT_EQ(result.clearance_m > 0.005, tells);
    EXPECT_EQ(result.nearest_object, 0u);  // the scene names none
    EXPECT_STREQ(forcelayer_object_name(runtime, result.nearest_object), "");
  }
}

TEST_P(CInterface, NamesTheObjectsOfTheScene) {
  const auto scene = Voxmap::open(test::source_path("tests/golden/baked_objects.vox"));
  ASSERT_TRUE(scene);
  const double s = scene->voxel_size_m();
  save_pshell(folder / "small.pshell", sphere_part(4 * s, 400, s));
  options.without_guarantee = 1;
  runtime = forcelayer_open(test::source_path("tests/golden/baked_objects.vox").c_str(),
                            (folder / "small.pshell").c_str(), &options, error, sizeof error);
  ASSERT_NE(runtime, nullptr) << error;
  EXPECT_STREQ(forcelayer_object_name(runtime, 1), "wedge");
  EXPECT_STREQ(forcelayer_object_name(runtime, 2), "sheet");
  EXPECT_STREQ(forcelayer_object_name(runtime, 3), "");
}

TEST_P(CInterface, RefusesWhatIsNoPoseAndNoReading) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  options.world_from_device[3] = 0;
  EXPECT_EQ(forcelayer_open(file("floor.vox").c_str(), file("ball.pshell").c_str(), &options, error,
                            sizeof error),
            nullptr);
  EXPECT_NE(std::string(error).find("world_from_device"), std::string::npos) << error;
  options.world_from_device[3] = 1;
  const int model = std::exchange(options.model, 2);
  EXPECT_EQ(forcelayer_open(file("floor.vox").c_str(), file("ball.pshell").c_str(), &options, error,
                            sizeof error),
            nullptr);
  options.model = model;
  options.workspace_radius_m = 0.2;
  open();
  forcelayer_result result;
  const Pose high{{0, 0, 0.1}, {1, 0, 0, 0}}, bad{{0, nan, 0}, {1, 0, 0, 0}};
  const Pose none{{0, 0, 0}, {0, 0, 0, 0}};
  const forcelayer_reading sound = reading_at(high);
  EXPECT_NE(forcelayer_step(runtime, &sound, &result), 0);  // not started
  EXPECT_EQ(result.force_n[2], 0);
  forcelayer_reading absent = sound, raw = sound;
  absent.present = 0;
  raw.calibrated = 0;
  const struct {
    const Pose *place, *grip;
    forcelayer_reading first;
    const char* says;
  } cases[] = {
      {&bad, nullptr, sound, "world_from_part"},
      {nullptr, &none, sound, "handle_from_part"},
      {nullptr, nullptr, reading_at(bad), "device_from_handle"},
      {nullptr, nullptr, reading_at({{0, 0, 100}, {1, 0, 0, 0}}), "millimeters"},
      {nullptr, nullptr, absent, "does not answer"},
      {nullptr, nullptr, raw, "not calibrated"},
  };
  for (const auto& c : cases) {
    EXPECT_NE(start(c.place, c.grip, c.first), 0) << c.says;
    EXPECT_NE(std::string(error).find(c.says), std::string::npos) << c.says << ": " << error;
    EXPECT_NE(forcelayer_step(runtime, &sound, &result), 0) << c.says;
  }
  EXPECT_EQ(start(&high, nullptr, sound), 0) << error;
  EXPECT_EQ(forcelayer_step(runtime, &sound, &result), 0);
}

// A program must see each frame in which the guarantee does not hold: no point in the interior is
// not enough.
TEST_P(CInterface, TellsWhetherTheGuaranteeHolds) {
  options.max_force_n = options.max_torque_nm = 0;
  open();
  EXPECT_EQ(forcelayer_warning(runtime, 0), nullptr);
  const double tested_m = guaranteed_m();
  EXPECT_GT(tested_m, 0);
  EXPECT_EQ(state().guaranteed_m, 0);  // no step yet
  const Pose high{{0.1, 0.1, 0.08}, {1, 0, 0, 0}};
  forcelayer_reading reading = reading_at(high);
  ASSERT_EQ(start(&high, nullptr, reading), 0) << error;
  EXPECT_EQ(state().guaranteed_m, 0);
  forcelayer_result result;
  const auto step = [&](int steps) {
    for (int i = 0; i < steps; ++i) ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
  };
  const auto expect_held = [&](double shown_m, std::uint32_t faults) {
    EXPECT_EQ(state().tested, 0u);
    EXPECT_EQ(state().faults, faults);
    EXPECT_EQ(state().guaranteed_m, shown_m);
  };
  step(5);
  EXPECT_EQ(state().tested, 1u);
  EXPECT_EQ(state().guaranteed_m, tested_m);
  EXPECT_EQ(state().faults + state().outside_map + state().barred + state().seat_open, 0u);

  // A program of an earlier header, and one of a later.
  forcelayer_state short_one;
  std::memset(&short_one, 0xff, sizeof short_one);
  forcelayer_last_state(runtime, &short_one, sizeof short_one.guaranteed_m);
  EXPECT_EQ(short_one.guaranteed_m, tested_m);
  EXPECT_EQ(short_one.outside_map, ~0u);
  std::array<forcelayer_state, 2> long_one;
  std::memset(&long_one, 0xff, sizeof long_one);
  forcelayer_last_state(runtime, long_one.data(), sizeof long_one);
  EXPECT_EQ(long_one[0].guaranteed_m, tested_m);
  EXPECT_EQ(long_one[1].guaranteed_m, 0);
  EXPECT_EQ(long_one[1].tested, 0u);

  // Held where it was tested: by the clutch, and by invalid readings.
  forcelayer_set_clutch(runtime, 1);
  step(100);
  expect_held(tested_m, 0);
  forcelayer_set_clutch(runtime, 0);
  step(100);
  EXPECT_EQ(state().tested, 1u);
  reading.device_from_handle[0] = std::numeric_limits<double>::quiet_NaN();
  step(20);
  expect_held(tested_m, FORCELAYER_FAULT_INVALID_INPUT);
  // Another place, where nothing has been tested.
  const Pose higher{{0.1, 0.1, 0.2}, {1, 0, 0, 0}};
  ASSERT_EQ(start(&higher, nullptr, reading_at(high)), 0) << error;
  step(1);
  expect_held(0, FORCELAYER_FAULT_INVALID_INPUT);
}

TEST_P(CInterface, TellsWhyTheGuaranteeDoesNotHold) {
  forcelayer_result result;
  const auto step_at = [&](const Pose& place) {
    const forcelayer_reading reading = reading_at(place);
    ASSERT_EQ(start(nullptr, nullptr, reading), 0) << error;
    ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
  };
  // Beyond a cropped side, 8 mm below the slab's upper face: nothing is felt there.
  const auto slab = [](Voxel v) { return v[2] <= 0; };
  VoxelScene cropped = closed(offset_scene(0.005, {0, 0, -2}, {48, 40, 8}, 2, slab));
  cropped.tells_clearances = false;  // none reaches across a cropped side
  save_voxmap(folder / "cropped.vox", cropped, 63);
  open("cropped.vox");
  const double tested_m = guaranteed_m();
  EXPECT_GT(tested_m, 0);
  step_at({{0.1, 0.1, 0.08}, {1, 0, 0, 0}});
  EXPECT_EQ(state().outside_map, 1u);  // the box ends at 30 mm, too
  EXPECT_EQ(state().guaranteed_m, 0);
  EXPECT_EQ(result.interior + result.contacts + result.clearance, 0u);

  // Installed where it touches: 3 mm above a ball.
  if (GetParam() == Model::kDefault) {
    save_voxmap(folder / "distances.vox", ball_scene());
    open("distances.vox");
    EXPECT_GT(guaranteed_m(), 0);
    step_at({{0.12, 0.12, 0.043}, {1, 0, 0, 0}});
    EXPECT_EQ(result.interior, 0u);
    EXPECT_EQ(state().seat_open, 1u);
    EXPECT_GT(state().seated, 0u);
    EXPECT_EQ(state().guaranteed_m, 0);
    step_at({{0.12, 0.12, 0.1}, {1, 0, 0, 0}});
    EXPECT_EQ(state().seat_open, 0u);
    EXPECT_EQ(state().guaranteed_m, guaranteed_m());
  }

  // Inside.
  options.without_guarantee = 1;
  open();
  step_at({{0.1, 0.1, 0.08}, {1, 0, 0, 0}});
  EXPECT_EQ(state().guaranteed_m, guaranteed_m());
  if (GetParam() == Model::kPaper) {
    step_at({{0.1, 0.1, 0.02}, {1, 0, 0, 0}});
    EXPECT_GT(result.interior, 0u);
    EXPECT_EQ(state().guaranteed_m, 0);
  }
}

// The guarantee of each pair of files goes with the frames of these, while another thread swaps.
TEST_P(CInterface, TheGuaranteeIsThatOfTheFilesInUse) {
  save_pshell(folder / "finer.pshell", sphere_part(0.03, 900, 0.003));
  open();
  const double before_m = guaranteed_m();
  const Pose high{{0.1, 0.1, 0.08}, {1, 0, 0, 0}};
  const forcelayer_reading reading = reading_at(high);
  ASSERT_EQ(start(&high, nullptr, reading), 0) << error;
  forcelayer_result result;
  ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
  std::vector<double> seen_m{state().guaranteed_m};
  std::atomic<bool> swapped{false};
  int failed = -1;
  std::thread other([&] {
    failed = swap("floor.vox", "finer.pshell", high);
    swapped = true;
  });
  for (int after = 0; after < 100; after += swapped ? 1 : 0) {
    if (!swapped) machine::sleep_until_ns(machine::monotonic_ns() + 50'000);
    if (forcelayer_step(runtime, &reading, &result) != 0) break;
    if (seen_m.back() != state().guaranteed_m) seen_m.push_back(state().guaranteed_m);
  }
  other.join();
  ASSERT_EQ(failed, 0) << error;
  EXPECT_GT(guaranteed_m(), before_m + 0.001);
  EXPECT_EQ(seen_m, (std::vector<double>{before_m, 0, guaranteed_m()}));
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_P(CInterface, RefusesDamagedFilesAndThoseWithoutAGuarantee) {
  const auto refusal = [&](const char* scene, const char* part) -> std::string {
    runtime =
        forcelayer_open(file(scene).c_str(), file(part).c_str(), &options, error, sizeof error);
    const std::string said = runtime == nullptr ? error : "";
    forcelayer_close(runtime);
    runtime = nullptr;
    return said;
  };
  EXPECT_EQ(refusal("floor.vox", "ball.pshell"), "");
  for (const char* name : {"floor.vox", "ball.pshell"}) {
    const std::string whole = bytes_of(file(name));
    for (const double fraction : {0.55, 0.75, 0.95}) {
      std::string rotten = whole;
      rotten[static_cast<std::size_t>(fraction * static_cast<double>(whole.size()))] ^= 1;
      std::ofstream(file(name), std::ios::binary) << rotten;
      EXPECT_NE(refusal("floor.vox", "ball.pshell").find("damaged"), std::string::npos)
          << name << " at " << fraction << ": " << error;
    }
    std::ofstream(file(name), std::ios::binary) << whole;
  }
  PointPart coarse = sphere_part(0.02, 400, 0.005);
  coarse.covering_radius_m = 0.01;
  save_pshell(folder / "coarse.pshell", coarse);
  EXPECT_NE(refusal("floor.vox", "coarse.pshell").find("coarse.pshell: no separation"),
            std::string::npos)
      << error;
  EXPECT_NE(std::string(error).find("without_guarantee"), std::string::npos) << error;
  options.without_guarantee = 1;
  EXPECT_EQ(refusal("floor.vox", "coarse.pshell"), "");
}

// One false number under right checksums would let the part through the floor.
TEST_P(CInterface, RefusesFilesWhoseFactsAreUntrue) {
  const std::string whole = bytes_of(file("floor.vox"));
  testing::AlignedBytes bytes(std::as_bytes(std::span(whole)));
  const auto nodes = static_cast<std::uint32_t>(VoxmapSection::kLowerNodes);
  std::size_t at = testing::section_offset(bytes.bytes(), nodes);
  const auto entry = [&] { return testing::read_at<std::uint32_t>(bytes.bytes(), at); };
  while (!is_uniform(entry()) || uniform_value(entry()) != 0) at += 4;
  testing::write_at(bytes.bytes(), at, uniform_entry(0, 200));
  testing::resign(bytes.bytes());
  std::ofstream(file("floor.vox"), std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.bytes().data()),
             static_cast<std::streamsize>(bytes.bytes().size()));
  EXPECT_TRUE(Voxmap::open(file("floor.vox"), Verify::kStructureAndChecksums));
  runtime = forcelayer_open(file("floor.vox").c_str(), file("ball.pshell").c_str(), &options, error,
                            sizeof error);
  EXPECT_EQ(runtime, nullptr);
  EXPECT_NE(std::string(error).find("is wrong: a voxel that is not free is within that distance"),
            std::string::npos)
      << error;
}

// Scene and part must both be among the digests that are expected; a swap keeps to them.
TEST_P(CInterface, OpensOnlyFilesThatAreExpected) {
  const auto digest = [&](const char* name) { return *digest::sha256_of_file(file(name)); };
  const std::string scene = digest("floor.vox"), part = digest("ball.pshell");
  const std::string both = scene + "," + part, one = scene, none = "", nonsense = scene + ",12";
  const auto open_expecting = [&](const std::string& expected) {
    options.expected_sha256 = expected.c_str();
    runtime = forcelayer_open(file("floor.vox").c_str(), file("ball.pshell").c_str(), &options,
                              error, sizeof error);
    return runtime != nullptr;
  };
  EXPECT_FALSE(open_expecting(one));
  EXPECT_NE(std::string(error).find(part), std::string::npos) << error;
  EXPECT_FALSE(open_expecting(none));
  EXPECT_FALSE(open_expecting(nonsense));
  EXPECT_NE(std::string(error).find("64 hexadecimal digits"), std::string::npos) << error;
  ASSERT_TRUE(open_expecting(both)) << error;
}

// A file that is written to in place, or cut, changes nothing in a run that has it open.
TEST_P(CInterface, FilesThatAreWrittenToChangeNothing) {
  open();
  const Pose high{{0.1, 0.1, 0.05}, {1, 0, 0, 0}};
  ASSERT_EQ(start(&high, nullptr, reading_at(high)), 0) << error;
  forcelayer_result result;
  int frame = 0;
  const auto press_until = [&](int end) {  // at 0.1 m/s
    for (; frame < end; ++frame) {
      const forcelayer_reading reading =
          reading_at({{0.1, 0.1, 0.05 - 1e-4 * frame}, {1, 0, 0, 0}});
      ASSERT_EQ(forcelayer_step(runtime, &reading, &result), 0);
    }
  };
  press_until(100);
  std::fstream(file("floor.vox"), std::ios::in | std::ios::out | std::ios::binary)
      << std::string(std::filesystem::file_size(file("floor.vox")), '\x7f');
  std::filesystem::resize_file(file("ball.pshell"), 0);
  press_until(200);
  EXPECT_EQ(result.output, unsigned{FORCELAYER_ARMED});
  EXPECT_GT(result.contacts, 0u);
  EXPECT_EQ(state().faults, 0u);
  EXPECT_GT(state().guaranteed_m, 0);
}

// A servo thread that brings the hand to a height at 0.1 m/s, and looks at what the motors get.
class ServoThread {
 public:
  ServoThread(forcelayer_runtime* runtime, double z_m)
      : runtime_(runtime), z_m_(z_m), goal_m_(z_m) {}
  ~ServoThread() { stop(); }

  void run() {
    stop_ = false;
    thread_ = std::thread([this] {
      while (!stop_) {
        tick();
        machine::sleep_until_ns(machine::monotonic_ns() + 50'000);
      }
    });
  }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void go_to(double z_m) { goal_m_ = z_m; }

  // Waits for a minute at most.
  template <typename Done>
  bool soon(Done done) const {
    const long long until_ns = machine::monotonic_ns() + 60'000'000'000;
    while (!done()) {
      if (machine::monotonic_ns() > until_ns) return false;
      machine::sleep_until_ns(machine::monotonic_ns() + 1'000'000);
    }
    return true;
  }

  std::atomic<double> force_n{0}, part_z_m{0}, jumped_to_m{0};
  std::atomic<std::uint32_t> output{0};
  std::atomic<int> jumps{0}, blows{0};  // of the part; of the force at and after such a jump

 private:
  void tick() {
    z_m_ += std::clamp(goal_m_.load() - z_m_, -1e-4, 1e-4);
    const forcelayer_reading reading = reading_at({{0.1, 0.1, z_m_}, {1, 0, 0, 0}});
    forcelayer_result result;
    ASSERT_EQ(forcelayer_step(runtime_, &reading, &result), 0);
    const glm::dvec3 force(result.force_n[0], result.force_n[1], result.force_n[2]);
    const double now_n = glm::length(force), z_m = result.world_from_part[2];
    ++since_jump_;
    if (part_z_m != 0 && std::abs(z_m - part_z_m) > 0.01) {
      jumped_to_m = z_m;
      ++jumps;
      since_jump_ = 0;
    }
    // A ramp over 200 ms from zero, whatever is felt: at most its fraction of 15 N.
    if (since_jump_ < 100 && now_n > 15 * since_jump_ / 200.0 + 1e-9) ++blows;
    force_n = now_n;
    part_z_m = z_m;
    output = result.output;
  }

  forcelayer_runtime* runtime_;
  double z_m_;
  int since_jump_ = 1000;
  std::atomic<double> goal_m_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST_P(CInterface, SceneAndPartAreSwappedByAnotherThreadWhileTheLoopRuns) {
  open();
  const Pose low{{0.1, 0.1, 0.05}, {1, 0, 0, 0}}, above{{0.1, 0.1, 0.08}, {1, 0, 0, 0}},
      higher{{0.1, 0.1, 0.1}, {1, 0, 0, 0}};
  ASSERT_EQ(start(&low, nullptr, reading_at(low)), 0) << error;
  ServoThread servo(runtime, 0.05);
  servo.run();
  servo.go_to(0.03);
  ASSERT_TRUE(servo.soon([&] { return servo.force_n > 1; }));

  // The larger ball, from the air; then felt: it touches where the small one did not.
  ASSERT_EQ(swap("floor.vox", "large.pshell", above), 0) << error;
  ASSERT_TRUE(servo.soon([&] { return servo.jumps == 1; }));
  EXPECT_NEAR(servo.jumped_to_m, 0.08, 1e-9);  // in that frame: the coupling takes over from there
  servo.go_to(-0.012);  // the part would be at 38 mm: the large ball's lower end at 8 mm
  ASSERT_TRUE(servo.soon([&] { return servo.force_n > 1; }));

  // A file that cannot be opened changes nothing.
  EXPECT_NE(swap("none.vox", "ball.pshell", above), 0);
  EXPECT_NE(std::string(error).find("none.vox"), std::string::npos) << error;
  EXPECT_GT(servo.force_n, 1);

  // Nobody calls the loop: the swap is still waiting, and another cannot begin.
  for (int round = 0; round < 2; ++round) {
    servo.stop();
    EXPECT_NE(swap("floor.vox", "ball.pshell", higher, 0.01), 0);
    EXPECT_NE(std::string(error).find("not taken"), std::string::npos) << error;
    EXPECT_NE(swap("floor.vox", "ball.pshell", higher), 0);
    EXPECT_NE(std::string(error).find("not in use yet"), std::string::npos) << error;
    const int jumps = servo.jumps;
    servo.run();
    ASSERT_TRUE(servo.soon([&] { return servo.jumps > jumps; }));
    // The one that came late is the one in use from now on, whatever fails after it.
    EXPECT_NE(swap("none.vox", "ball.pshell", above), 0);
    EXPECT_NE(swap("none.vox", "ball.pshell", above), 0);
    servo.go_to(-0.012 - 0.07 * (round + 1));
    ASSERT_TRUE(servo.soon([&] { return servo.force_n > 1; }));
    ASSERT_EQ(swap("floor.vox", "large.pshell", above), 0) << error;
    ASSERT_TRUE(servo.soon([&] { return servo.output == FORCELAYER_ARMED; }));
  }
  servo.stop();
  EXPECT_EQ(servo.blows, 0);
  EXPECT_STREQ(forcelayer_last_trip(runtime), "none");
}

// Begun anew after a swap that nobody took, the loop runs with what that brings, and the next swap
// finds nothing of the old in use.
TEST_P(CInterface, BeginsAnewAfterASwapThatWasNotTaken) {
  open();
  const Pose low{{0.1, 0.1, 0.05}, {1, 0, 0, 0}}, above{{0.1, 0.1, 0.08}, {1, 0, 0, 0}};
  for (int round = 0; round < 2; ++round) {
    ASSERT_EQ(start(&low, nullptr, reading_at(low)), 0) << error;
    EXPECT_NE(swap("floor.vox", "large.pshell", above, 0.01), 0);
    EXPECT_NE(std::string(error).find("not taken"), std::string::npos) << error;
    ASSERT_EQ(start(&above, nullptr, reading_at(above)), 0) << error;
    ServoThread servo(runtime, 0.08);
    servo.run();
    ASSERT_EQ(swap("floor.vox", "ball.pshell", low), 0) << error;
    ASSERT_TRUE(servo.soon([&] { return servo.output == FORCELAYER_ARMED; }));
    servo.stop();
    EXPECT_EQ(servo.blows, 0);
  }
}

}  // namespace
}  // namespace forcelayer::test
