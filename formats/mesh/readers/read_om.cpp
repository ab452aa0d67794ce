// OpenMesh's own format (.om), decoded by OpenMesh. Its halfedge mesh drops faces that it cannot
// connect; an importer of our own takes every vertex and face as the file has them.
#include <OpenMesh/Core/IO/Options.hh>
#include <OpenMesh/Core/IO/importer/BaseImporter.hh>
#include <OpenMesh/Core/IO/reader/OMReader.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/mesh/readers/om_chunks.h"
#include "formats/mesh/readers/polygon_splitter.h"

namespace forcelayer::mesh {
namespace {

namespace om = OpenMesh;

// Keeps the vertices and faces that the reader reports: faces as lists of vertices (before version
// 2.0) or as rings of halfedges. Ignores everything else.
class Collector : public om::IO::BaseImporter {
 public:
  struct Halfedge {
    int to_vertex = -1;
    int next = -1;
    int face = -1;
  };

  std::vector<Vec3d> vertices;
  std::vector<std::vector<int>> polygons;  // vertices
  std::vector<Halfedge> halfedges;
  std::vector<int> face_halfedges;

  om::VertexHandle add_vertex(const om::Vec3f& point) override {
    return add_vertex(om::Vec3d(point));
  }
  om::VertexHandle add_vertex(const om::Vec3d& point) override {
    vertices.push_back({point[0], point[1], point[2]});
    return om::VertexHandle(static_cast<int>(vertices.size() - 1));
  }
  om::VertexHandle add_vertex() override { return add_vertex(om::Vec3d(0, 0, 0)); }
  om::FaceHandle add_face(const VHandles& corners) override {
    std::vector<int>& polygon = polygons.emplace_back();
    for (const om::VertexHandle corner : corners) polygon.push_back(corner.idx());
    return om::FaceHandle(static_cast<int>(polygons.size() - 1));
  }
  om::FaceHandle add_face(om::HalfedgeHandle halfedge) override {
    face_halfedges.push_back(halfedge.idx());
    return om::FaceHandle(static_cast<int>(face_halfedges.size() - 1));
  }
  om::HalfedgeHandle add_edge(om::VertexHandle from, om::VertexHandle to) override {
    halfedges.push_back({to.idx()});
    halfedges.push_back({from.idx()});
    return om::HalfedgeHandle(static_cast<int>(halfedges.size() - 2));
  }
  void set_next(om::HalfedgeHandle halfedge, om::HalfedgeHandle next) override {
    halfedges.at(static_cast<std::size_t>(halfedge.idx())).next = next.idx();
  }
  void set_face(om::HalfedgeHandle halfedge, om::FaceHandle face) override {
    halfedges.at(static_cast<std::size_t>(halfedge.idx())).face = face.idx();
  }
  om::BaseKernel* kernel() override { return &kernel_; }
  size_t n_vertices() const override { return vertices.size(); }
  size_t n_faces() const override { return polygons.size() + face_halfedges.size(); }
  size_t n_edges() const override { return halfedges.size() / 2; }

  void add_face_texcoords(om::FaceHandle, om::VertexHandle,
                          const std::vector<om::Vec2f>&) override {}
  void add_face_texcoords(om::FaceHandle, om::VertexHandle,
                          const std::vector<om::Vec3f>&) override {}
  void set_face_texindex(om::FaceHandle, int) override {}
  void set_point(om::VertexHandle, const om::Vec3f&) override {}
  void set_halfedge(om::VertexHandle, om::HalfedgeHandle) override {}
  void set_normal(om::VertexHandle, const om::Vec3f&) override {}
  void set_normal(om::VertexHandle, const om::Vec3d&) override {}
  void set_color(om::VertexHandle, const om::Vec3uc&) override {}
  void set_color(om::VertexHandle, const om::Vec4uc&) override {}
  void set_color(om::VertexHandle, const om::Vec3f&) override {}
  void set_color(om::VertexHandle, const om::Vec4f&) override {}
  void set_texcoord(om::VertexHandle, const om::Vec2f&) override {}
  void set_texcoord(om::VertexHandle, const om::Vec3f&) override {}
  void set_status(om::VertexHandle, const om::Attributes::StatusInfo&) override {}
  void request_face_texcoords2D() override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec2f&) override {}
  void set_texcoord(om::HalfedgeHandle, const om::Vec3f&) override {}
  void set_status(om::HalfedgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_color(om::EdgeHandle, const om::Vec3uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec4uc&) override {}
  void set_color(om::EdgeHandle, const om::Vec3f&) override {}
  void set_color(om::EdgeHandle, const om::Vec4f&) override {}
  void set_status(om::EdgeHandle, const om::Attributes::StatusInfo&) override {}
  void set_normal(om::FaceHandle, const om::Vec3f&) override {}
  void set_normal(om::FaceHandle, const om::Vec3d&) override {}
  void set_color(om::FaceHandle, const om::Vec3uc&) override {}
  void set_color(om::FaceHandle, const om::Vec4uc&) override {}
  void set_color(om::FaceHandle, const om::Vec3f&) override {}
  void set_color(om::FaceHandle, const om::Vec4f&) override {}
  void set_status(om::FaceHandle, const om::Attributes::StatusInfo&) override {}
  void add_texture_information(int, std::string) override {}

 private:
  om::BaseKernel kernel_;  // the reader asks for one before it reads; nothing is stored in it
};

void decode(const SourceFile& file, const OmContent& content, Collector& collector) {
  static std::mutex mutex;  // OpenMesh has one reader object, which keeps its state in itself
  const std::lock_guard lock(mutex);
  ::omerr().disable();  // what goes wrong is reported below
  std::istringstream stream(content.stripped);
  om::IO::Options options;
  bool done = false;
  try {
    done = om::IO::OMReader().read(stream, collector, options);
  } catch (const std::logic_error& what) {  // handles of a width that it has no type for
    fail_read(file, ErrorCode::kMeshUnsupported, "",
              std::string("OpenMesh reports: ") + what.what(), "write the mesh again");
  }
  if (!done || collector.n_vertices() != content.vertices || collector.n_faces() != content.faces) {
    fail_read(file, ErrorCode::kMeshIncomplete, "",
              "OpenMesh reads only " + std::to_string(collector.n_faces()) + " of " +
                  counted(content.faces, "face") + " and " +
                  std::to_string(collector.n_vertices()) + " of " +
                  std::to_string(content.vertices) + " vertices",
              "write the mesh again");
  }
}

// The rings of halfedges as polygons. Every halfedge of a face belongs to its ring, once.
void collect_rings(const SourceFile& file, Collector& collector) {
  const auto& halfedges = collector.halfedges;
  for (std::size_t face = 0; face < collector.face_halfedges.size(); ++face) {
    std::vector<int>& polygon = collector.polygons.emplace_back();
    int halfedge = collector.face_halfedges[face];
    do {
      const bool in_face =
          halfedge >= 0 && halfedge < static_cast<int>(halfedges.size()) &&
          halfedges[static_cast<std::size_t>(halfedge)].face == static_cast<int>(face);
      if (!in_face || polygon.size() == halfedges.size()) {
        fail_read(file, ErrorCode::kMeshUnreadable, "face " + std::to_string(face),
                  "the halfedges of this face do not form a ring", "write the mesh again");
      }
      polygon.push_back(halfedges[static_cast<std::size_t>(halfedge)].to_vertex);
      halfedge = halfedges[static_cast<std::size_t>(halfedge)].next;
    } while (halfedge != collector.face_halfedges[face]);
  }
}

void split_polygons(const SourceFile& file, const Collector& collector, Mesh& mesh,
                    PolygonSplitter& splitter) {
  std::vector<std::uint32_t> corners;
  for (std::size_t face = 0; face < collector.polygons.size(); ++face) {
    corners.clear();
    for (const int corner : collector.polygons[face]) {
      if (corner < 0 || static_cast<std::size_t>(corner) >= mesh.vertices.size()) {
        fail_read(file, ErrorCode::kMeshUnreadable, "face " + std::to_string(face),
                  "uses vertex " + std::to_string(corner) + ", but there are only " +
                      std::to_string(mesh.vertices.size()) + " vertices, counted from 0",
                  "write the mesh again");
      }
      corners.push_back(static_cast<std::uint32_t>(corner));
    }
    if (corners.size() < 3) {
      fail_read(file, ErrorCode::kMeshUnreadable, "face " + std::to_string(face),
                counted(corners.size(), "corner") + " do not make a face", "write the mesh again");
    }
    splitter.split(corners, mesh);
  }
}

}  // namespace

Assembly read_om(const SourceFile& file) {
  const OmContent content = read_om_chunks(file);
  Collector collector;
  decode(file, content, collector);
  collect_rings(file, collector);
  Mesh mesh{std::move(collector.vertices), {}, content.single_precision};
  check_finite(file, mesh);
  PolygonSplitter splitter;
  split_polygons(file, collector, mesh, splitter);
  Assembly assembly = assembly_of(file, std::move(mesh));
  splitter.add_warnings(assembly.warnings);
  return assembly;
}

}  // namespace forcelayer::mesh
