// The pose stream over a real loopback socket.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <thread>
#include <tuple>

#include "forcelayer/pose_receiver.h"
#include "forcelayer/run.h"
#include "runtime/stream/pose_sender.h"
#include "tests/support/both_models.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::test {
namespace {

std::unique_ptr<model::Simulation> simulation(Model model) {
  Voxmap voxmap = make_voxmap(
      offset_scene(0.01, {0, 0, 0}, {12, 12, 12}, 2, [](Voxel v) { return v[2] == 4; }));
  PointPart part = sphere_part(0.02, 50, 0.01);
  part.center_m = {0.5, 0, 0};
  Pshell shell = make_pshell(part);
  RunRequest request;
  request.model = model;
  auto run = open_run(std::move(voxmap), std::move(shell), request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  return run->release_simulation();
}

// Sends bytes to a local port.
void send_to(std::uint16_t port, const void* bytes, std::size_t size) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(sendto(descriptor, bytes, size, 0, reinterpret_cast<const sockaddr*>(&address),
                   sizeof address),
            static_cast<ssize_t>(size));
  close(descriptor);
}

PoseDatagram valid_datagram(std::uint64_t session, std::uint64_t sequence) {
  PoseDatagram d{};
  d.magic = kPoseMagic;
  d.version = kPoseVersion;
  d.bytes = sizeof d;
  d.session = session;
  d.sequence = sequence;
  d.world_from_part[3] = d.world_from_handle[3] = d.world_from_target[3] = 1;
  return d;
}

class PoseStreamOfARun : public BothModels {};
INSTANTIATE_TEST_SUITE_P(Models, PoseStreamOfARun, kBothModels, name_of_model);

TEST_P(PoseStreamOfARun, CarriesAFrame) {
  const auto sim = simulation(GetParam());
  auto receiver = PoseReceiver::open(0);
  ASSERT_TRUE(receiver);
  auto sender = stream::PoseSender::create(std::to_string(receiver->port()), *sim);
  ASSERT_TRUE(sender);
  Frame frame;
  frame.number = 77;
  frame.time_s = 0.077;
  frame.result.wrench.force_n = {1, 2, 3};
  frame.result.report.contacts = 5;
  frame.result.report.guard_cuts = 1;
  frame.result.report.world_from_center.position_m = {1, 1, 1};
  frame.result.report.clearance_kind = ClearanceKind::kProven;
  frame.result.report.clearance_m = 0.0125;
  frame.result.report.nearest_object = 3;
  frame.result.report.nearest_point_m = {4, 5, 6};
  frame.world_from_target.position_m = {2, 1, 1};
  frame.output = OutputState::kArmed;
  sender->offer(frame);
  ASSERT_TRUE(receiver->wait(2000));
  const auto received = receiver->newest();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->frame, 77u);
  EXPECT_EQ(received->sequence, 1u);
  EXPECT_EQ(received->world_from_part[0], 0.5);    // the mesh's origin, not the centroid
  EXPECT_EQ(received->world_from_target[0], 1.5);  // of the mesh's origin too
  EXPECT_EQ(received->force_n[2], 3);
  EXPECT_EQ(received->contacts, 5u);
  EXPECT_EQ(received->output, 1u);
  EXPECT_EQ(received->clearance_kind, 2u);
  EXPECT_EQ(received->clearance_m, 0.0125);
  EXPECT_EQ(received->nearest_object, 3u);
  EXPECT_EQ(received->nearest_point_m[2], 6);
  EXPECT_EQ(object_name_of(*received), "");  // a scene without names
  EXPECT_EQ(received->flags, std::uint32_t{kPoseGuardCut});
  EXPECT_FALSE(receiver->newest());
}

TEST_P(PoseStreamOfARun, SendsSixtyASecondHoweverManyFramesAreOffered) {
  const auto sim = simulation(GetParam());
  auto receiver = PoseReceiver::open(0);
  auto sender = stream::PoseSender::create("127.0.0.1:" + std::to_string(receiver->port()), *sim);
  ASSERT_TRUE(sender);
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(300);
  while (std::chrono::steady_clock::now() < end) {
    sender->offer({});
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const auto last = receiver->newest();
  ASSERT_TRUE(last);
  EXPECT_LE(last->sequence, 20u);  // 18 and the first
  EXPECT_GE(last->sequence, 5u);   // on a machine that is busy with other things
}

TEST_P(PoseStreamOfARun, SendsAsOftenAsItIsAsked) {
  const auto sim = simulation(GetParam());
  for (const auto& [rate_hz, smallest, largest] : {std::tuple{1e6, 10u, 10u}, {0.01, 1u, 1u}}) {
    auto receiver = PoseReceiver::open(0);
    auto sender = stream::PoseSender::create(std::to_string(receiver->port()), *sim, rate_hz);
    ASSERT_TRUE(sender);
    stream::PoseSender moved = std::move(*sender);
    for (int i = 0; i < 10; ++i) {
      moved.offer({});
      std::this_thread::sleep_for(std::chrono::microseconds(10));
    }
    const auto last = receiver->newest();
    ASSERT_TRUE(last);
    EXPECT_GE(last->sequence, smallest);
    EXPECT_LE(last->sequence, largest);
  }
}

TEST_P(PoseStreamOfARun, NobodyListeningIsNoError) {
  const auto sim = simulation(GetParam());
  auto sender = stream::PoseSender::create("127.0.0.1:9", *sim);
  ASSERT_TRUE(sender);
  for (int i = 0; i < 3; ++i) {
    sender->offer({});
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

TEST(PoseStream, NamesAreCutBetweenCharacters) {
  PoseDatagram d{};
  for (const std::string& name : {std::string(), std::string("beam"), std::string(64, 'x')}) {
    set_object_name(d, name);
    EXPECT_EQ(object_name_of(d), name);
  }
  set_object_name(d, std::string(200, 'y'));
  EXPECT_EQ(object_name_of(d), std::string(64, 'y'));
  set_object_name(d, std::string(63, 'z') + "\xc3\xa4");  // whose two bytes do not fit
  EXPECT_EQ(object_name_of(d), std::string(63, 'z'));
  set_object_name(d, std::string(62, 'z') + "\xc3\xa4" + "z");
  EXPECT_EQ(object_name_of(d), std::string(62, 'z') + "\xc3\xa4");
}

TEST(PoseStream, ReceiverTakesTheNewestAndCountsWhatIsMissing) {
  auto receiver = PoseReceiver::open(0);
  ASSERT_TRUE(receiver);
  for (const auto& [session, sequence] :
       {std::pair{5, 1}, {5, 4}, {5, 3}, {6, 1}, {5, 9}, {6, 2}, {6, 2}}) {
    const PoseDatagram d =
        valid_datagram(static_cast<std::uint64_t>(session), static_cast<std::uint64_t>(sequence));
    send_to(receiver->port(), &d, sizeof d);
  }
  ASSERT_TRUE(receiver->wait(2000));
  const auto newest = receiver->newest();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->session, 6u);
  EXPECT_EQ(newest->sequence, 2u);
  EXPECT_EQ(receiver->lost(), 2u);     // 5/2 and 5/3, which came too late
  EXPECT_EQ(receiver->ignored(), 3u);  // 5/3, 5/9, the second 6/2
}

TEST(PoseStream, MalformedDatagramsDoNothing) {
  auto receiver = PoseReceiver::open(0);
  ASSERT_TRUE(receiver);
  std::uint64_t sent = 0;
  const auto send = [&](const void* bytes, std::size_t size) {
    send_to(receiver->port(), bytes, size);
    ++sent;
  };
  const PoseDatagram good = valid_datagram(1, 1);
  for (std::size_t size = 0; size < sizeof good; size += 7) send(&good, size);
  const std::vector<std::byte> large(5000);
  send(large.data(), large.size());
  PoseDatagram bad = good;
  bad.magic ^= 1;
  send(&bad, sizeof bad);
  bad = good;
  bad.version = 1;
  send(&bad, sizeof bad);
  bad = good;
  bad.bytes = 300;
  send(&bad, sizeof bad);
  bad = good;
  bad.world_from_part[0] = std::nan("");
  send(&bad, sizeof bad);
  bad = good;
  bad.world_from_handle[3] = 0;
  send(&bad, sizeof bad);
  bad = good;
  bad.torque_nm[1] = 1 / 0.0;
  send(&bad, sizeof bad);
  bad = good;
  bad.output = 3;
  send(&bad, sizeof bad);
  bad = good;
  bad.clearance_kind = 3;
  send(&bad, sizeof bad);
  bad = good;
  bad.clearance_m = -1e-3;
  send(&bad, sizeof bad);
  bad = good;
  bad.nearest_point_m[2] = std::nan("");
  send(&bad, sizeof bad);
  EXPECT_FALSE(receiver->newest());
  EXPECT_EQ(receiver->ignored(), sent);
}

TEST_P(PoseStreamOfARun, WhatIsNoAddressIsAnError) {
  const auto sim = simulation(GetParam());
  for (const char* target : {"", ":", "host:", "127.0.0.1:port", "no such host:7000"}) {
    const auto sender = stream::PoseSender::create(target, *sim);
    ASSERT_FALSE(sender) << target;
    EXPECT_EQ(sender.error().code, ErrorCode::kUsage) << target;
  }
  EXPECT_FALSE(PoseReceiver::open(7000, "somewhere"));
  const auto elsewhere = PoseReceiver::open(0, "192.0.2.1");  // of documentation: no machine has it
  ASSERT_FALSE(elsewhere);
  EXPECT_NE(elsewhere.error().where.find("192.0.2.1"), std::string::npos);
  EXPECT_EQ(elsewhere.error().mend, "use an address of this machine");
  const auto first = PoseReceiver::open(0);
  ASSERT_TRUE(first);
  const auto second = PoseReceiver::open(first->port());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().mend, "choose another port");
}

}  // namespace
}  // namespace forcelayer::test
