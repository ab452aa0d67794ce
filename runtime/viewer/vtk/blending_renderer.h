// A renderer that blends what is translucent as it comes.
#pragma once

#include <vtkOpenGLRenderer.h>

namespace forcelayer {

// Without depth peeling, VTK sums all that is translucent in floating-point buffers of the whole
// window and blends that in a second pass. Without a graphics card this takes most of a frame, for
// layers of one colour each whose order does not show.
class BlendingRenderer : public vtkOpenGLRenderer {
 public:
  static BlendingRenderer* New();
  vtkTypeMacro(BlendingRenderer, vtkOpenGLRenderer)

      void DeviceRenderTranslucentPolygonalGeometry(vtkFrameBufferObjectBase*) override {
    UpdateTranslucentPolygonalGeometry();
  }
};

}  // namespace forcelayer
