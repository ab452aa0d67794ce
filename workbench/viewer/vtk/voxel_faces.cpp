#include "workbench/viewer/vtk/voxel_faces.h"

#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "workbench/viewer/vtk/geometry.h"

namespace forcelayer::viewer {
namespace {

constexpr double kEdgeOn = 1e-9;  // a face that is seen under less than this covers no pixel

vtkPolyDataMapper* mapper_of(vtkActor* actor) {
  return vtkPolyDataMapper::SafeDownCast(actor->GetMapper());
}

// Never dark, so that faces towards the camera differ from ink.
double shade_of(const glm::dvec3& normal, const glm::dvec3& to_eye, const glm::dvec3& up) {
  const glm::dvec3 right = glm::cross(up, to_eye);
  const glm::dvec3 to_light = kToLight[0] * right + kToLight[1] * up + kToLight[2] * to_eye;
  return 0.5 + 0.5 * std::max(0.0, glm::dot(normal, to_light));
}

}  // namespace

VoxelFaces::VoxelFaces(vtkRenderer* renderer, const Color& color, double opacity) : color_(color) {
  for (auto& actor : actors_) {
    actor = vtkSmartPointer<vtkActor>::New();
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(PolyData::New());
    mapper->ScalarVisibilityOff();
    actor->SetMapper(mapper);
    actor->GetProperty()->LightingOff();
    actor->GetProperty()->SetOpacity(opacity);
    actor->VisibilityOff();
    renderer->AddActor(actor);
  }
}

void VoxelFaces::set(const QuadSurface& surface) {
  for (int n = 0; n < kDirections; ++n) {
    mapper_of(actors_[n])->SetInputData(poly_data_of(surface, n));
  }
}

void VoxelFaces::cut(vtkPlane* plane) {
  for (const auto& actor : actors_) {
    actor->GetMapper()->RemoveAllClippingPlanes();
    if (plane != nullptr) actor->GetMapper()->AddClippingPlane(plane);
  }
}

void VoxelFaces::draw_edges(const Color& color) {
  for (const auto& actor : actors_) {
    actor->GetProperty()->EdgeVisibilityOn();
    actor->GetProperty()->SetEdgeColor(color[0], color[1], color[2]);
  }
}

void VoxelFaces::make_plain() {
  plain_ = true;
  for (const auto& actor : actors_) {
    actor->GetProperty()->EdgeVisibilityOff();
    actor->GetProperty()->SetOpacity(1);
  }
}

void VoxelFaces::face_camera(const glm::dvec3& to_eye, const glm::dvec3& up) {
  for (int n = 0; n < kDirections; ++n) {
    glm::dvec3 normal(0);
    normal[n / 2] = n % 2 == 1 ? 1 : -1;
    vtkPolyDataMapper* mapper = mapper_of(actors_[n]);
    const bool seen =
        glm::dot(normal, to_eye) > kEdgeOn && mapper->GetInput()->GetNumberOfCells() > 0;
    actors_[n]->SetVisibility(shown_ && seen);
    const double shade = plain_ ? 1 : shade_of(normal, to_eye, up);
    actors_[n]->GetProperty()->SetColor(shade * color_[0], shade * color_[1], shade * color_[2]);
  }
}

}  // namespace forcelayer::viewer
