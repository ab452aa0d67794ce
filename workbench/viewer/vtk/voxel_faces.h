// The faces of voxels, drawn so that a million of them turn smoothly without a graphics card.
#pragma once

#include <vtkActor.h>
#include <vtkPlane.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <array>
#include <glm/vec3.hpp>

#include "workbench/viewer/plan/style.h"
#include "workbench/viewer/surface/quad_surface.h"

namespace forcelayer::viewer {

// One actor for each of the six directions that a voxel's face can have. Under a parallel camera a
// direction is seen as a whole or not at all, and has one shade: half of the faces are never drawn,
// and none is lit pixel by pixel.
class VoxelFaces {
 public:
  VoxelFaces(vtkRenderer* renderer, const Color& color, double opacity);

  void set(const QuadSurface& surface);
  void show(bool shown) { shown_ = shown; }  // from the next face_camera() on
  void cut(vtkPlane* plane);                 // hides the faces behind it; null: none
  void draw_edges(const Color& color);
  void make_plain();  // opaque, without shades or edges

  // Shows and shades the faces for a camera that looks from `to_eye` with `up` upwards (unit).
  void face_camera(const glm::dvec3& to_eye, const glm::dvec3& up);

 private:
  static constexpr int kDirections = 6;

  std::array<vtkSmartPointer<vtkActor>, kDirections> actors_;
  Color color_;
  bool shown_ = true, plain_ = false;
};

}  // namespace forcelayer::viewer
