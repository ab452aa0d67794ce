// Flat shapes over a picture, in pixels.
#pragma once

#include <vtkActor2D.h>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkUnsignedCharArray.h>

#include <vector>

#include "workbench/viewer/plan/style.h"

namespace forcelayer::viewer {

struct Pixel {
  double x, y;
};

// Convex polygons, each in one color, drawn in the order in which they were added.
class Shapes {
 public:
  Shapes();

  vtkActor2D* actor() { return actor_; }
  void clear();
  void polygon(const std::vector<Pixel>& corners, const Color& color, double opacity);
  void box(double x0, double y0, double x1, double y1, const Color& color, double opacity);

 private:
  vtkNew<vtkPoints> points_;
  vtkNew<vtkCellArray> polygons_;
  vtkNew<vtkUnsignedCharArray> colors_;
  vtkNew<vtkPolyData> data_;
  vtkNew<vtkPolyDataMapper2D> mapper_;
  vtkNew<vtkActor2D> actor_;
};

}  // namespace forcelayer::viewer
