// make_step_faces FILE.step: writes an assembly "tray" of three parts: "cube", "seam" (a cube with
// a face of 1e-10 mm^2) and "bad" (a cube and a face that gets no triangles). Millimeters.
#include <cstdio>

#include "tests/support/step_shapes.h"

int main(int argc, char** argv) {
  using namespace forcelayer::test;
  if (argc != 2) return std::fputs("usage: make_step_faces FILE.step\n", stderr), 2;
  const bool written = write_tray(argv[1], {{"cube", BRepPrimAPI_MakeBox(20, 20, 20).Shape()},
                                            {"seam", cube_with_sliver(2e-11)},
                                            {"bad", cube_with_lost_face()}});
  return written ? 0 : 1;
}
