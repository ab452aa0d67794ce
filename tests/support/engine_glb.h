// An assembly as GLB: a tree of named nodes under all kinds of placings, which share a few meshes.
#pragma once

#include <string>
#include <vector>

#include "tests/support/models.h"
#include "tests/support/odd_meshes.h"

namespace forcelayer::test {

// The JSON and the binary chunk of several meshes, each one primitive; `nodes` as given, the first
// being the root.
inline std::string as_glb(const std::vector<mesh::Mesh>& meshes, const std::string& nodes) {
  std::string binary, mesh_list, accessors, views;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const std::string comma = i == 0 ? "" : ",", first = std::to_string(2 * i),
                      second = std::to_string(2 * i + 1);
    const std::size_t vertices = meshes[i].vertices.size(),
                      corners = 3 * meshes[i].triangles.size();
    const auto view = [&](std::size_t offset, std::size_t bytes) {
      return R"({"buffer":0,"byteOffset":)" + std::to_string(offset) + R"(,"byteLength":)" +
             std::to_string(bytes) + "}";
    };
    mesh_list += comma + R"({"primitives":[{"attributes":{"POSITION":)" + first +
                 R"(},"indices":)" + second + "}]}";
    accessors += comma + R"({"componentType":5126,"type":"VEC3","bufferView":)" + first +
                 R"(,"count":)" + std::to_string(vertices) +
                 R"(},{"componentType":5125,"type":"SCALAR","bufferView":)" + second +
                 R"(,"count":)" + std::to_string(corners) + "}";
    views += comma + view(binary.size(), 12 * vertices) + "," +
             view(binary.size() + 12 * vertices, 4 * corners);
    binary += gltf_binary(meshes[i]);
  }
  return as_glb(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" +
                    nodes + R"(],"meshes":[)" + mesh_list + R"(],"accessors":[)" + accessors +
                    R"(],"bufferViews":[)" + views + R"(],"buffers":[{"byteLength":)" +
                    std::to_string(binary.size()) + "}]}",
                binary);
}

// The four meshes of which engine_glb() holds 34 instances.
inline std::vector<mesh::Mesh> engine_meshes() {
  std::vector<mesh::Mesh> meshes = {cube(), odd::torus(80, 24)};
  for (const char* file : {"plate_holes.stl", "sensor.drc"}) {
    meshes.push_back(std::move(mesh::read_assembly(model_path(file)).value().meshes[0]));
  }
  return meshes;
}
constexpr std::uint64_t kEngineTriangles = 16 * 12 + 14 * 3840 + 2 * 1252 + 2 * 7436;

// A quarter turn under the root, then two cylinders, the second mirrored by its matrix. Each has a
// base plate, seven fins, eight bolts turned against each other, and a sensor.
inline std::string engine_glb() {
  std::string nodes =
      R"({"name":"engine","children":[1,20],"rotation":[0.70710677,0,0,0.70710677]})";
  for (int cylinder = 0; cylinder < 2; ++cylinder) {
    const int first = 1 + 19 * cylinder;
    std::string children, below;
    for (int i = 1; i < 19; ++i) {
      children += (i == 1 ? "" : ",") + std::to_string(first + i);
      const std::string n = std::to_string(i);
      if (i <= 7) {
        below += R"(,{"name":"fin_)" + n + R"(","mesh":1,"translation":[0,0,)" +
                 std::to_string(12 * i) + R"(],"scale":[9,8,3]})";
      } else if (i <= 15) {
        const double turn = std::numbers::pi / 4 * i;
        below += R"(,{"name":"bolt_)" + n + R"(","mesh":0,"translation":[)" +
                 number(40 * std::cos(turn)) + "," + number(40 * std::sin(turn)) +
                 R"(,2],"rotation":[0,0,)" + number(std::sin(turn / 2)) + "," +
                 number(std::cos(turn / 2)) + R"(],"scale":[4,4,30]})";
      } else if (i == 16) {
        below += R"(,{"name":"base","mesh":2,"scale":[0.5,0.5,0.5]})";
      } else if (i == 17) {
        below += R"(,{"name":"sensor_mount","children":[)" + std::to_string(first + 18) +
                 R"(],"translation":[0,0,100]})";
      } else {
        below += R"(,{"name":"sensor","mesh":3,"rotation":[0,0.6,0,0.8]})";
      }
    }
    children = children.substr(0, children.rfind(','));  // the sensor hangs on its mount
    const char* placing = cylinder == 0 ? R"("translation":[-60,0,10])"
                                        : R"("matrix":[-1,0,0,0, 0,1,0,0, 0,0.1,1,0, 60,0,10,1])";
    nodes += R"(,{"name":"cylinder_)" + std::to_string(cylinder + 1) + R"(","children":[)" +
             children + "]," + placing + "}" + below;
  }
  return as_glb(engine_meshes(), nodes);
}

}  // namespace forcelayer::test
