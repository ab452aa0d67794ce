// The mouse moves the camera as in CAD programs.
#pragma once

#include <vtkInteractorStyleTrackballCamera.h>

#include <functional>
#include <string>

namespace forcelayer::viewer {

// Left turns, as a turntable does: z stays upright. Middle or shift-left moves, right or wheel
// zooms, the wheel towards the pointer. The owner handles keys and other buttons.
class CadStyle : public vtkInteractorStyleTrackballCamera {
 public:
  static CadStyle* New();
  vtkTypeMacro(CadStyle, vtkInteractorStyleTrackballCamera)

      std::function<void(const std::string&)> on_key;  // X's name of a key
  // The left button went down at a pixel from the lower left corner. True takes the drag that
  // follows away from the camera and gives it to on_drag.
  std::function<bool(int, int)> on_press;
  std::function<void(int, int)> on_drag;
  std::function<void(int, int)> on_hover;  // the pointer moved there with no button held

  void OnChar() override {}
  void OnTimer() override {}  // else the last motion is repeated while a button is held
  void OnKeyPress() override;
  void OnLeftButtonDown() override;
  void OnLeftButtonUp() override;
  void OnMouseMove() override;
  void Rotate() override;
  void OnMouseWheelForward() override { zoom(kWheelZoom); }
  void OnMouseWheelBackward() override { zoom(1 / kWheelZoom); }

 private:
  static constexpr double kWheelZoom = 1.15;  // a notch

  void zoom(double factor);  // the point under the pointer stays

  bool dragging_ = false;  // a drag that on_press took
};

}  // namespace forcelayer::viewer
