// make_box_file FILE.step|FILE.igs [solid|cylinder|two|plate]: writes a box of 10 x 20 x 30 mm from
// the origin, as six trimmed surfaces in IGES, or as a solid with six faces; or a cylinder of 10 mm
// radius and 30 mm height, as three trimmed surfaces; or the box and another that touches it; or a
// plate of 30 x 20 x 10 mm with a hole of 5 mm radius, as seven trimmed surfaces.
#include <BRepAlgoAPI_Cut.hxx>
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

namespace {

TopoDS_Shape plate() {
  const gp_Ax2 axis(gp_Pnt(15, 10, -5), gp_Dir(0, 0, 1));
  return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(30, 20, 10).Shape(),
                         BRepPrimAPI_MakeCylinder(axis, 5, 20).Shape())
      .Shape();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2)
    return std::fputs("usage: make_box_file FILE.step|FILE.igs [solid|cylinder|two|plate]\n",
                      stderr),
           2;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  const std::string kind = argc > 2 ? argv[2] : "";
  const TopoDS_Shape box = kind == "cylinder" ? BRepPrimAPI_MakeCylinder(10, 30).Shape()
                           : kind == "plate"  ? plate()
                                              : BRepPrimAPI_MakeBox(10, 20, 30).Shape();
  const std::string path = argv[1];
  if (path.ends_with(".igs")) {
    IGESControl_Controller::Init();
    IGESControl_Writer writer("MM", kind == "solid" ? 1 : 0);
    const TopoDS_Shape beside = BRepPrimAPI_MakeBox(gp_Pnt(10, 0, 0), 10, 20, 30).Shape();
    if (kind == "two" && !writer.AddShape(beside)) return 1;
    // At once: OpenCASCADE's writer of IGES solids leaks, which is not what is tested.
    std::_Exit(writer.AddShape(box) && writer.Write(path.c_str()) ? 0 : 1);
  }
  STEPControl_Writer writer;
  if (writer.Transfer(box, STEPControl_AsIs) != IFSelect_RetDone) return 1;
  return writer.Write(path.c_str()) == IFSelect_RetDone ? 0 : 1;
}
