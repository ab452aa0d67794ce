// make_box_file FILE.step|FILE.igs [solid|cylinder|two]: writes a box of 10 x 20 x 30 mm from the
// origin, as six trimmed surfaces in IGES, or as a solid with six faces; or a cylinder of 10 mm
// radius and 30 mm height, as three trimmed surfaces; or the box and another that touches it.
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <IGESControl_Controller.hxx>
#include <IGESControl_Writer.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Writer.hxx>
#include <cstdio>
#include <cstdlib>
#include <string>

int main(int argc, char** argv) {
  if (argc < 2)
    return std::fputs("usage: make_box_file FILE.step|FILE.igs [solid|cylinder|two]\n", stderr), 2;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  const bool cylinder = argc > 2 && argv[2] == std::string("cylinder");
  const TopoDS_Shape box =
      cylinder ? BRepPrimAPI_MakeCylinder(10, 30).Shape() : BRepPrimAPI_MakeBox(10, 20, 30).Shape();
  const std::string path = argv[1];
  if (path.ends_with(".igs")) {
    IGESControl_Controller::Init();
    const bool two = argc > 2 && argv[2] == std::string("two");
    const bool solid = argc > 2 && !cylinder && !two;
    IGESControl_Writer writer("MM", solid ? 1 : 0);
    const TopoDS_Shape beside = BRepPrimAPI_MakeBox(gp_Pnt(10, 0, 0), 10, 20, 30).Shape();
    if (two && !writer.AddShape(beside)) return 1;
    // At once: OpenCASCADE's writer of IGES solids leaks, which is not what is tested.
    std::_Exit(writer.AddShape(box) && writer.Write(path.c_str()) ? 0 : 1);
  }
  STEPControl_Writer writer;
  if (writer.Transfer(box, STEPControl_AsIs) != IFSelect_RetDone) return 1;
  return writer.Write(path.c_str()) == IFSelect_RetDone ? 0 : 1;
}
