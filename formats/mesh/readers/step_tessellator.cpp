#include "formats/mesh/readers/step_tessellator.h"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>

namespace forcelayer::mesh {
namespace {

constexpr double kAngularDeflectionRad = 0.35;  // 20 degrees: what small rounds need to stay round

}  // namespace

Mesh StepTessellator::tessellate(const TopoDS_Shape& shape, const std::string& name) {
  BRepMesh_IncrementalMesh(shape, deflection_mm_, false, kAngularDeflectionRad, false);
  Mesh mesh;
  mesh.single_precision = false;
  std::uint64_t faces = 0, lost = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    ++faces;
    if (!add(TopoDS::Face(face.Current()), mesh)) ++lost;
  }
  if (lost > 0) {
    fail_read(file_, ErrorCode::kMeshIncomplete, name,
              "OpenCASCADE could not tessellate " + std::to_string(lost) + " of " +
                  counted(faces, "face"),
              "mend these faces where the part was drawn");
  }
  check_finite(file_, mesh, name);
  return mesh;
}

bool StepTessellator::add(const TopoDS_Face& face, Mesh& mesh) {
  TopLoc_Location location;
  const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
  if (triangulation.IsNull() || triangulation->NbTriangles() == 0) return false;
  largest_deflection_mm_ = std::max(largest_deflection_mm_, triangulation->Deflection());
  check_count(file_, mesh.vertices.size() + static_cast<std::uint64_t>(triangulation->NbNodes()),
              "vertices");
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (Standard_Integer i = 1; i <= triangulation->NbNodes(); ++i) {
    const gp_Pnt node = triangulation->Node(i).Transformed(location.Transformation());
    mesh.vertices.push_back({node.X(), node.Y(), node.Z()});
  }
  for (Standard_Integer i = 1; i <= triangulation->NbTriangles(); ++i) {
    Standard_Integer a = 0, b = 0, c = 0;
    triangulation->Triangle(i).Get(a, b, c);
    if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
    const auto corner = [&](Standard_Integer n) {
      return first + static_cast<std::uint32_t>(n - 1);
    };
    mesh.triangles.push_back({corner(a), corner(b), corner(c)});
  }
  return true;
}

}  // namespace forcelayer::mesh
