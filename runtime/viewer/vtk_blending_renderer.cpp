#include "runtime/viewer/vtk_blending_renderer.h"

#include <vtkObjectFactory.h>

namespace forcelayer {

vtkStandardNewMacro(BlendingRenderer);

}  // namespace forcelayer
