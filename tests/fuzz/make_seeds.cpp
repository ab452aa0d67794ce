// make_seeds CORPUS: writes the first inputs of every fuzz target as CORPUS/TARGET/NAME: one small
// valid file of each kind that a reader tells apart.
#include <filesystem>
#include <iostream>

#include "forcelayer/pose_datagram.h"
#include "formats/file/file_bytes.h"
#include "runtime/devices/hid/firmware/haptic_firmware.h"
#include "runtime/devices/hid/hid_haptic_report.h"
#include "tests/support/draco_files.h"
#include "tests/support/hid_descriptors.h"
#include "tests/support/mesh_files.h"
#include "tests/support/om_files.h"
#include "tests/support/places.h"

namespace {

using namespace forcelayer;
using namespace forcelayer::test;

std::filesystem::path corpus;

void seed(const std::string& target, const std::string& name, std::string_view bytes) {
  std::filesystem::create_directories(corpus / target);
  write_file(corpus / target / name, bytes);
}

void mesh_seeds() {
  const mesh::Mesh mesh = cube();
  seed("stl", "binary", as_stl_binary(mesh));
  seed("stl", "ascii", as_stl_ascii(mesh));
  seed("obj", "cube", as_obj(mesh));
  seed("obj", "features",
       "mtllib a.mtl\no box\ng side\nv 0 0 0\nv 1 0 0 1\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
       "f 1/1/1 2/1/1 3/1/1 4/1/1\nf -4//-1 -3//-1 -2//-1\ns off\n# end\n");
  seed("off", "cube", as_off(mesh));
  seed("ply", "ascii", as_ply_ascii(mesh));
  seed("ply", "little", as_ply_binary(mesh, std::endian::little));
  seed("ply", "big", as_ply_binary(mesh, std::endian::big));
  seed("glb", "cube", as_glb(mesh));
  seed("gltf", "json_alone", gltf_json(mesh));
  FloatMesh om_mesh;
  add_square_cube(om_mesh);
  seed("om", "cube", as_om(om_mesh));
  seed("om", "version_1_2", as_om_1_2(mesh));
  seed("drc", "sequential", as_drc(mesh));
  seed("drc", "quantized", as_drc(mesh, {.position_bits = 10}));
  seed("drc", "edgebreaker", as_drc(mesh, {.position_bits = 10, .edgebreaker = true}));
}

// Baked files of every kind that were committed once.
void baked_seeds() {
  for (const char* name : {"v2.vox", "v2_distances.vox", "baked_chebyshev.vox", "baked_lean.vox",
                           "baked_full.vox", "baked_covered.vox", "baked_objects.vox"}) {
    const auto file = FileBytes::read(test::source_path(std::string("tests/golden/") + name));
    if (!file) throw std::runtime_error(to_line(file.error()));
    seed("voxmap", name,
         {reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size()});
  }
}

void manifest_seeds() {
  seed("manifest", "whole",
       R"({"voxel_size": "5mm", "layers": 2, "roi": [0, 0, 0, "1m", "1m", "1m"],
 "free_seeds": [["0.5m", "0.5m", "0.5m"]], "without": ["Cover", "Bolt*"],
 "parts": [
  {"mesh": "a.obj", "units": "mm", "translation": ["1mm", 0, "3MM"], "rotation": [0, 0, 0, 1], "scale": 2},
  {"mesh": "b.stl", "units": "m", "matrix": [[1,0,0,0],[0,1,0,"5mm"],[0,0,1,0],[0,0,0,1]]}]})");
  seed("manifest", "least", R"({"parts": [{"mesh": "a.obj", "units": "mm"}]})");
}

void runtime_seeds() {
  seed("motion", "two_rows",
       "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n1.5,0.1,-2e-3,0,0.7,0,0.7,0\n");
  seed("motion", "one_row", "t_s,x_m,y_m,z_m,qw,qx,qy,qz\r\n0,1,2,3,0,0,0,1\r\n");
  PoseDatagram datagram{};
  datagram.magic = kPoseMagic;
  datagram.version = kPoseVersion;
  datagram.bytes = sizeof datagram;
  datagram.world_from_part = datagram.world_from_handle =
      datagram.world_from_target = {1, 2, 3, 1, 0, 0, 0};
  datagram.clearance_m = 0.004;
  datagram.clearance_kind = datagram.nearest_object = 2;
  set_object_name(datagram, "beam");
  seed("pose_datagram", "whole", {reinterpret_cast<const char*>(&datagram), sizeof datagram});
}

void hid_seeds() {
  const auto text = [](const test::Descriptor& bytes) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  seed("hid_descriptor", "separate", text(separate_spacemouse()));
  seed("hid_descriptor", "combined", text(combined_spacemouse()));

  const auto report = [](const char* name, const std::uint8_t* bytes) {
    seed("hid_report", name, {reinterpret_cast<const char*>(bytes), devices::kHapticReportBytes});
  };
  HapticFirmware device;
  HapticDeviceRatings ratings{};
  ratings.max_force_un = 5000000;
  ratings.watchdog_us = 20000;
  haptic_init(&device, &ratings);
  HapticReading reading{};
  reading.position_10nm[0] = 100;
  reading.orientation_q30[0] = 1 << 30;
  std::uint8_t answer[HAPTIC_REPORT_BYTES];
  haptic_next_report(&device, &reading, 1, answer);
  report("state", answer);
  const devices::HapticReport hello = devices::encode_hello(1, 2);
  report("hello", hello.data());
  haptic_receive(&device, hello.data(), hello.size(), 3);
  haptic_next_report(&device, &reading, 4, answer);
  report("capabilities", answer);
  devices::HapticCommand command;
  command.motors_on = true;
  command.wrench.force_n = {1, 2, 3};
  report("command", devices::encode_command(command).data());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_seeds CORPUS\n";
    return 2;
  }
  corpus = argv[1];
  mesh_seeds();
  baked_seeds();
  manifest_seeds();
  runtime_seeds();
  hid_seeds();
  return 0;
}
