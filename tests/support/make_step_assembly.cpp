// make_step_assembly FILE.step [UNIT [external]]: writes an assembly of 18 instances of five parts:
// a plate, two angle brackets with three bolts and nuts each, and a rod with a nut on either end.
// UNIT is that of the lengths below: MM (default), INCH or M. With "external" each part goes to a
// file of its own in the working folder.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace {

constexpr double kBoltRadius = 5, kNutHeight = 8;

TopoDS_Shape cylinder(double radius, double height, const gp_Pnt& foot = {0, 0, 0},
                      const gp_Dir& axis = {0, 0, 1}) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(foot, axis), radius, height).Shape();
}

TopoDS_Shape hexagon(double radius, double height) {
  BRepBuilderAPI_MakePolygon outline;
  for (int i = 0; i < 6; ++i) {
    const double turn = std::numbers::pi / 3 * i;
    outline.Add(gp_Pnt(radius * std::cos(turn), radius * std::sin(turn), 0));
  }
  outline.Close();
  const TopoDS_Face face = BRepBuilderAPI_MakeFace(outline.Wire()).Face();
  return BRepPrimAPI_MakePrism(face, gp_Vec(0, 0, height)).Shape();
}

TopoDS_Shape cut(const TopoDS_Shape& from, const TopoDS_Shape& what) {
  return BRepAlgoAPI_Cut(from, what).Shape();
}

TopoDS_Shape fuse(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  return BRepAlgoAPI_Fuse(a, b).Shape();
}

// An L of 60 x 60 x 100, 10 thick, three holes in its foot and one in its wall.
TopoDS_Shape bracket() {
  TopoDS_Shape shape =
      fuse(BRepPrimAPI_MakeBox(60, 100, 10).Shape(), BRepPrimAPI_MakeBox(10, 100, 60).Shape());
  for (const double y : {20.0, 50.0, 80.0})
    shape = cut(shape, cylinder(kBoltRadius, 10, {40, y, 0}));
  return cut(shape, cylinder(kBoltRadius, 10, {0, 50, 40}, {1, 0, 0}));
}

class Assembly {
 public:
  explicit Assembly(const Handle(TDocStd_Document) & document)
      : tool_(XCAFDoc_DocumentTool::ShapeTool(document->Main())) {}

  TDF_Label part(const char* name, const TopoDS_Shape& shape) {
    return named(tool_->AddShape(shape, false), name);
  }

  TDF_Label assembly(const char* name) { return named(tool_->NewShape(), name); }

  // `child` turned about z, then moved.
  void place(const TDF_Label& parent, const TDF_Label& child, const std::string& name,
             const gp_Vec& move, double turn_rad = 0) {
    gp_Trsf turn, placing;
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turn_rad);
    placing.SetTranslation(move);
    named(tool_->AddComponent(parent, child, TopLoc_Location(placing * turn)), name.c_str());
  }

  void finish() { tool_->UpdateAssemblies(); }

 private:
  static TDF_Label named(const TDF_Label& label, const char* name) {
    TDataStd_Name::Set(label, name);
    return label;
  }

  Handle(XCAFDoc_ShapeTool) tool_;
};

void fill(const Handle(TDocStd_Document) & document) {
  Assembly made(document);
  const TDF_Label nut =
      made.part("nut", cut(hexagon(10, kNutHeight), cylinder(kBoltRadius, kNutHeight)));
  const TDF_Label rod = made.part("rod", cylinder(kBoltRadius, 200));
  const TDF_Label bolt =
      made.part("bolt", fuse(hexagon(9, 6), cylinder(kBoltRadius, 40, {0, 0, 0}, {0, 0, -1})));
  const TDF_Label angle = made.part("bracket", bracket());
  const TDF_Label plate = made.part("plate", BRepPrimAPI_MakeBox(180, 150, 20).Shape());

  const TDF_Label rod_assembly = made.assembly("rod-assembly");
  made.place(rod_assembly, nut, "nut_1", {0, 0, 10});
  made.place(rod_assembly, nut, "nut_2", {0, 0, 182}, 0.2);
  made.place(rod_assembly, rod, "rod_1", {0, 0, 0});
  const TDF_Label bolted = made.assembly("nut-bolt-assembly");
  made.place(bolted, bolt, "bolt_1", {0, 0, 10});
  made.place(bolted, nut, "nut_1", {0, 0, -28}, 0.5);
  const TDF_Label side = made.assembly("bracket-assembly");
  made.place(side, angle, "bracket_1", {0, 0, 0});
  for (int i = 0; i < 3; ++i) {
    made.place(side, bolted, "nut-bolt-assembly_" + std::to_string(i + 1), {40, 20.0 + 30 * i, 0});
  }
  const TDF_Label top = made.assembly("clamp");
  made.place(top, rod_assembly, "rod-assembly_1", {90, 75, 20});
  made.place(top, side, "bracket-assembly_1", {10, 25, 20});
  made.place(top, side, "bracket-assembly_2", {170, 125, 20}, std::numbers::pi);
  made.place(top, plate, "plate_1", {0, 0, 0});
  made.finish();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 4) {
    return std::fputs("usage: make_step_assembly FILE.step [UNIT [external]]\n", stderr), 2;
  }
  Message::DefaultMessenger()->ChangePrinters().Clear();
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  fill(document);
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  if (argc > 2 && !Interface_Static::SetCVal("write.step.unit", argv[2])) return 1;
  const char* const prefix_of_external_files = argc > 3 ? "" : nullptr;
  if (!writer.Transfer(document, STEPControl_AsIs, prefix_of_external_files)) return 1;
  return writer.Write(argv[1]) == IFSelect_RetDone ? 0 : 1;
}
