#include "workbench/viewer/vtk/cad_style.h"

#include <vtkCamera.h>
#include <vtkObjectFactory.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "workbench/viewer/plan/camera.h"

namespace forcelayer::viewer {

vtkStandardNewMacro(CadStyle);

void CadStyle::OnKeyPress() {
  // The event's own place: moves that wait behind it may have been handled before it.
  const int* at = Interactor->GetEventPosition();
  on_hover(at[0], at[1]);
  on_key(Interactor->GetKeySym());
}

void CadStyle::OnLeftButtonDown() {
  const int* at = Interactor->GetEventPosition();
  dragging_ = on_press(at[0], at[1]);
  if (!dragging_) Superclass::OnLeftButtonDown();
}

void CadStyle::OnLeftButtonUp() {
  if (!dragging_) Superclass::OnLeftButtonUp();
  dragging_ = false;
}

void CadStyle::OnMouseMove() {
  const int* at = Interactor->GetEventPosition();
  if (dragging_) {
    on_drag(at[0], at[1]);
  } else {
    Superclass::OnMouseMove();
    if (State == VTKIS_NONE) on_hover(at[0], at[1]);
  }
}

void CadStyle::Rotate() {
  constexpr double kTurn = 2 * std::numbers::pi;  // over the shorter side of the window
  vtkRenderer* renderer = GetDefaultRenderer();
  vtkCamera* camera = renderer->GetActiveCamera();
  const int *now = Interactor->GetEventPosition(), *before = Interactor->GetLastEventPosition();
  const int* size = renderer->GetRenderWindow()->GetSize();
  const double per_pixel = kTurn / std::min(size[0], size[1]);
  double focus[3], along[3], up[3];
  camera->GetFocalPoint(focus);
  camera->GetDirectionOfProjection(along);
  camera->GetViewUp(up);
  const Orbit orbit = turned({-glm::dvec3(along[0], along[1], along[2]), {up[0], up[1], up[2]}},
                             per_pixel * (before[0] - now[0]), per_pixel * (before[1] - now[1]));
  const glm::dvec3 eye =
      glm::dvec3(focus[0], focus[1], focus[2]) + camera->GetDistance() * orbit.to_eye;
  camera->SetPosition(eye.x, eye.y, eye.z);
  camera->SetViewUp(orbit.up.x, orbit.up.y, orbit.up.z);
  Interactor->Render();
}

void CadStyle::zoom(double factor) {
  vtkRenderer* renderer = GetDefaultRenderer();
  vtkCamera* camera = renderer->GetActiveCamera();
  const int* at = Interactor->GetEventPosition();
  const int* size = renderer->GetRenderWindow()->GetSize();
  double eye[3], focus[3], up[3];
  camera->GetPosition(eye);
  camera->GetFocalPoint(focus);
  camera->OrthogonalizeViewUp();
  camera->GetViewUp(up);
  const glm::dvec3 along(focus[0] - eye[0], focus[1] - eye[1], focus[2] - eye[2]);
  const glm::dvec3 sky(up[0], up[1], up[2]);
  const glm::dvec3 right = glm::normalize(glm::cross(along, sky));
  const double scale = camera->GetParallelScale();  // half of the picture's height
  const double per_pixel = 2 * (scale - scale / factor) / size[1];
  const glm::dvec3 shift =
      per_pixel * ((at[0] - 0.5 * size[0]) * right + (at[1] - 0.5 * size[1]) * sky);
  camera->SetParallelScale(scale / factor);
  camera->SetPosition(eye[0] + shift.x, eye[1] + shift.y, eye[2] + shift.z);
  camera->SetFocalPoint(focus[0] + shift.x, focus[1] + shift.y, focus[2] + shift.z);
  Interactor->Render();
}

}  // namespace forcelayer::viewer
