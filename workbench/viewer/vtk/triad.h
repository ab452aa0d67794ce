// The directions of the world's axes, in the lower left corner.
#pragma once

#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <glm/vec3.hpp>

namespace forcelayer::viewer {

inline constexpr int kTriadPixels = 130;  // side of its square at scale 1

class Triad {
 public:
  // On the window's layer `layer`.
  Triad(vtkRenderWindow* window, int layer);

  // `width`, `height`: of the window; `pixels`: side of the square it is drawn in.
  void aim(const glm::dvec3& to_eye, const glm::dvec3& up, int width, int height, int pixels);

 private:
  vtkNew<vtkRenderer> renderer_;
};

}  // namespace forcelayer::viewer
