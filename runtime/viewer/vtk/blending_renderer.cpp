#include "runtime/viewer/vtk/blending_renderer.h"

#include <vtkObjectFactory.h>

namespace forcelayer {

vtkStandardNewMacro(BlendingRenderer);

}  // namespace forcelayer
