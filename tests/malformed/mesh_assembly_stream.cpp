// An assembly from a sandboxed reader arrives whole. The bytes of a broken reader are refused, in
// time and without the memory that they announce.
#include <gtest/gtest.h>
#include <unistd.h>

#include <limits>
#include <random>
#include <thread>

#include "formats/mesh/sandbox/assembly_stream.h"
#include "formats/mesh/sandbox/sandbox.h"
#include "tests/support/address_limit.h"
#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;
using namespace std::chrono_literals;

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30;

auto soon() { return std::chrono::steady_clock::now() + 10s; }

struct Pipe {
  int ends[2];
  Pipe() {
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  }
  ~Pipe() {
    close(ends[0]);
    close_writing();
  }
  void close_writing() {
    if (ends[1] >= 0) close(ends[1]);
    ends[1] = -1;
  }
};

mesh::ReceivedAssembly sent(const Result<mesh::Assembly>& assembly,
                            std::uint64_t max_bytes = kPlenty) {
  Pipe pipe;
  std::thread sender([&] {
    mesh::send_assembly(pipe.ends[1], assembly);
    pipe.close_writing();
  });
  auto received = mesh::receive_assembly(pipe.ends[0], max_bytes, soon());
  char rest[4096];
  while (read(pipe.ends[0], rest, sizeof rest) > 0) {
  }
  sender.join();
  return received;
}

mesh::ReceivedAssembly sent_bytes(const std::string& bytes) {
  Pipe pipe;
  if (write(pipe.ends[1], bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size())) {
    throw std::runtime_error("a short pipe");
  }
  pipe.close_writing();
  return mesh::receive_assembly(pipe.ends[0], kPlenty, soon());
}

std::string stream_of(const Result<mesh::Assembly>& assembly) {
  Pipe pipe;  // holds 64 KiB
  mesh::send_assembly(pipe.ends[1], assembly);
  pipe.close_writing();
  std::string bytes(1 << 16, '\0');
  bytes.resize(static_cast<std::size_t>(read(pipe.ends[0], bytes.data(), bytes.size())));
  return bytes;
}

mesh::Assembly two_cubes() {
  mesh::Assembly assembly;
  assembly.meshes = {cube(), cube()};
  assembly.meshes[1].single_precision = false;
  assembly.instances = {{0, "a/b", {}}, {1, "", {{2, 0, 0, 0, 3, 0, 0, 0, 4}, {5, 6, 7}}}};
  assembly.meters_per_unit = 0.001;
  assembly.up = mesh::Up::kY;
  assembly.instances[1].deviation_units = 0.25;
  assembly.warnings = {"odd", "odder"};
  assembly.nodes = {{"a", "a", 0, 0, 2}, {"b", "a/b", 1, 0, 1}, {"", "a/", 1, 1, 1}};
  return assembly;
}

TEST(AssemblyStream, BringsEverything) {
  const mesh::Assembly assembly = two_cubes();
  const auto received = sent(assembly);
  ASSERT_TRUE(received.assembly && *received.assembly);
  const mesh::Assembly& got = **received.assembly;
  ASSERT_EQ(got.meshes.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(got.meshes[i].vertices, assembly.meshes[i].vertices);
    EXPECT_EQ(got.meshes[i].triangles, assembly.meshes[i].triangles);
    EXPECT_EQ(got.meshes[i].single_precision, assembly.meshes[i].single_precision);
    EXPECT_EQ(got.instances[i].name, assembly.instances[i].name);
    EXPECT_EQ(got.instances[i].mesh, i);
    EXPECT_EQ(got.instances[i].assembly_from_mesh.linear,
              assembly.instances[i].assembly_from_mesh.linear);
    EXPECT_EQ(got.instances[i].assembly_from_mesh.translation,
              assembly.instances[i].assembly_from_mesh.translation);
  }
  EXPECT_EQ(got.meters_per_unit, 0.001);
  EXPECT_EQ(got.up, mesh::Up::kY);
  EXPECT_EQ(got.instances[0].deviation_units, 0);
  EXPECT_EQ(got.instances[1].deviation_units, 0.25);
  EXPECT_EQ(got.warnings, assembly.warnings);
  ASSERT_EQ(got.nodes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(got.nodes[i].label, assembly.nodes[i].label);
    EXPECT_EQ(got.nodes[i].path, assembly.nodes[i].path);
    EXPECT_EQ(got.nodes[i].depth, assembly.nodes[i].depth);
    EXPECT_EQ(got.nodes[i].first_instance, assembly.nodes[i].first_instance);
    EXPECT_EQ(got.nodes[i].instance_count, assembly.nodes[i].instance_count);
  }
  EXPECT_EQ(got.instances[1].box.low,
            mesh::box_of(assembly.meshes[1], assembly.instances[1].assembly_from_mesh).low);
  EXPECT_EQ(corners_of(got), corners_of(assembly));
}

TEST(AssemblyStream, RefusesNodesOfInstancesThatAreNotThere) {
  for (const mesh::AssemblyNode& wrong :
       {mesh::AssemblyNode{"x", "x", 0, 3, 0}, mesh::AssemblyNode{"x", "x", 0, 1, 2},
        mesh::AssemblyNode{"x", "x", 0, 0xffffffff, 0xffffffff},
        mesh::AssemblyNode{"x", "x", 3, 0, 1}}) {
    mesh::Assembly assembly = two_cubes();
    assembly.nodes.push_back(wrong);
    EXPECT_EQ(sent(assembly).broken, mesh::BrokenStream::kNonsense);
  }
}

TEST(AssemblyStream, BringsLargeMeshes) {
  std::mt19937_64 random(1);
  mesh::Assembly assembly = two_cubes();
  mesh::Mesh& mesh = assembly.meshes[0];
  for (int i = 0; i < 1'000'000; ++i) {  // beyond the receiver's first piece
    mesh.vertices.push_back({double(random() % 1000), double(i), 0});
  }
  const auto received = sent(assembly);
  ASSERT_TRUE(received.assembly && *received.assembly);
  EXPECT_EQ((*received.assembly)->meshes[0].vertices, mesh.vertices);
  const auto refused = sent(assembly, 1'000'000);
  EXPECT_FALSE(refused.assembly);
  EXPECT_EQ(refused.broken, mesh::BrokenStream::kTooLong);
}

TEST(AssemblyStream, BringsErrors) {
  const auto received =
      sent(Error{ErrorCode::kMeshIncomplete, "a.stl", "byte 84", "too short", "copy it again"});
  ASSERT_TRUE(received.assembly && !*received.assembly);
  EXPECT_EQ(to_line(received.assembly->error()), "a.stl: byte 84: too short; copy it again");
  EXPECT_EQ(received.assembly->error().code, ErrorCode::kMeshIncomplete);
  for (const ErrorCode code : {ErrorCode::kUsage, ErrorCode::kDeviceFailed, ErrorCode(7)}) {
    EXPECT_EQ(sent(Error{code, "", "", "", ""}).broken, mesh::BrokenStream::kNonsense);
  }
}

TEST(AssemblyStream, KeepsThePromisesOfMeshes) {
  const auto refused = [](const auto& spoil) {
    mesh::Assembly assembly = two_cubes();
    spoil(assembly);
    const auto received = sent(assembly);
    return !received.assembly && received.broken == mesh::BrokenStream::kNonsense;
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused([](mesh::Assembly& a) { a.meshes[0].triangles[3][1] = 8; }));
  EXPECT_TRUE(refused([](mesh::Assembly& a) { a.meshes[1].vertices[7][2] = kNan; }));
  EXPECT_TRUE(refused([](mesh::Assembly& a) { a.instances[1].mesh = 2; }));
  EXPECT_TRUE(
      refused([](mesh::Assembly& a) { a.instances[0].assembly_from_mesh.linear[4] = kInfinity; }));
  EXPECT_TRUE(
      refused([](mesh::Assembly& a) { a.instances[0].assembly_from_mesh.translation[0] = kNan; }));
  EXPECT_TRUE(refused([](mesh::Assembly& a) { a.meters_per_unit = -1; }));
  EXPECT_TRUE(refused([](mesh::Assembly& a) { a.instances[0].deviation_units = kNan; }));
}

TEST(AssemblyStream, CutOrDamagedIsRefusedOrSound) {
  const std::string whole = stream_of(two_cubes());
  ASSERT_TRUE(sent_bytes(whole).assembly);
  for (std::size_t size = 0; size < whole.size(); size += 1 + size % 7) {
    const auto received = sent_bytes(whole.substr(0, size));
    EXPECT_FALSE(received.assembly) << size;
    EXPECT_EQ(received.broken, mesh::BrokenStream::kEnded) << size;
  }
  const AddressLimit limit(std::uint64_t{128} << 20);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(~bytes[at]);
    const auto received = sent_bytes(bytes);
    if (!received.assembly || !*received.assembly) continue;
    for (const mesh::Mesh& mesh : (*received.assembly)->meshes) {
      for (const mesh::Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) ASSERT_LT(corner, mesh.vertices.size());
      }
    }
  }
}

TEST(AssemblyStream, IsNotWaitedForForEver) {
  const Pipe pipe;
  const auto begin = std::chrono::steady_clock::now();
  const auto received = mesh::receive_assembly(pipe.ends[0], kPlenty, begin + 50ms);
  EXPECT_FALSE(received.assembly);
  EXPECT_EQ(received.broken, mesh::BrokenStream::kTooLate);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, 50ms);
}

// A program that would run itself anew instead of a reader starts nothing.
TEST(Sandbox, NeedsAMainThatKnowsIt) {
  const auto read = mesh::read_in_sandbox("a.stl", {}, {});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kInternal);
}

}  // namespace
}  // namespace forcelayer
