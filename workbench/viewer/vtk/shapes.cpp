#include "workbench/viewer/vtk/shapes.h"

#include <vtkCellData.h>

#include <cmath>

namespace forcelayer::viewer {

Shapes::Shapes() {
  colors_->SetNumberOfComponents(4);
  data_->SetPoints(points_);
  data_->SetPolys(polygons_);
  data_->GetCellData()->SetScalars(colors_);
  mapper_->SetInputData(data_);
  actor_->SetMapper(mapper_);
}

void Shapes::clear() {
  points_->Reset();
  polygons_->Reset();
  colors_->Reset();
}

void Shapes::polygon(const std::vector<Pixel>& corners, const Color& color, double opacity) {
  std::vector<vtkIdType> ids;
  for (const Pixel& corner : corners) {
    ids.push_back(points_->InsertNextPoint(corner.x, corner.y, 0));
  }
  polygons_->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  for (const double value : {color[0], color[1], color[2], opacity}) {
    colors_->InsertNextValue(static_cast<unsigned char>(std::lround(255 * value)));
  }
  points_->Modified();
  polygons_->Modified();
  colors_->Modified();
  data_->Modified();
}

void Shapes::box(double x0, double y0, double x1, double y1, const Color& color, double opacity) {
  polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, color, opacity);
}

}  // namespace forcelayer::viewer
