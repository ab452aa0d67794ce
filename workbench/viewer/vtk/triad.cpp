#include "workbench/viewer/vtk/triad.h"

#include <vtkAxesActor.h>
#include <vtkCamera.h>
#include <vtkCaptionActor2D.h>
#include <vtkTextProperty.h>

#include <algorithm>

#include "workbench/viewer/plan/style.h"

namespace forcelayer::viewer {

Triad::Triad(vtkRenderWindow* window, int layer) {
  vtkNew<vtkAxesActor> axes;
  axes->SetXAxisLabelText("x");
  axes->SetYAxisLabelText("y");
  axes->SetZAxisLabelText("z");
  for (vtkCaptionActor2D* caption : {axes->GetXAxisCaptionActor2D(), axes->GetYAxisCaptionActor2D(),
                                     axes->GetZAxisCaptionActor2D()}) {
    caption->GetCaptionTextProperty()->SetColor(kInk[0], kInk[1], kInk[2]);
    caption->GetCaptionTextProperty()->ItalicOff();
    caption->GetCaptionTextProperty()->ShadowOff();
  }
  renderer_->SetLayer(layer);
  renderer_->InteractiveOff();
  renderer_->AddActor(axes);
  renderer_->GetActiveCamera()->SetParallelProjection(1);
  window->AddRenderer(renderer_);
}

void Triad::aim(const glm::dvec3& to_eye, const glm::dvec3& up, int width, int height, int pixels) {
  renderer_->SetViewport(0, 0, std::min(1.0, static_cast<double>(pixels) / width),
                         std::min(1.0, static_cast<double>(pixels) / height));
  vtkCamera* camera = renderer_->GetActiveCamera();
  camera->SetFocalPoint(0, 0, 0);
  camera->SetPosition(to_eye.x, to_eye.y, to_eye.z);
  camera->SetViewUp(up.x, up.y, up.z);
  renderer_->ResetCamera(-1.2, 1.2, -1.2, 1.2, -1.2, 1.2);
  camera->SetParallelScale(1.5);
}

}  // namespace forcelayer::viewer
