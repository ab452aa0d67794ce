// make_sample_step FILE.step: the assembly of sample_data/gearbox.glb
// (scripts/samplegen/housing.py) as exact surfaces. Instances bear the names that SolidWorks and
// Creo give them, "NAUO1" and
// "=>[0:1:1:3]", so that only the names of products say what they are.
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
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
#include <string>

namespace {

constexpr double kBoltPlaces[4][2] = {{4, 4}, {76, 4}, {76, 66}, {4, 66}};
constexpr double kPinX = 94, kPinY = 35;

TopoDS_Shape cylinder(double radius, double height, const gp_Pnt& foot = {0, 0, 0}) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(foot, gp_Dir(0, 0, 1)), radius, height).Shape();
}

TopoDS_Shape box(const gp_Pnt& low, const gp_Pnt& high) {
  return BRepPrimAPI_MakeBox(low, high).Shape();
}

TopoDS_Shape cut(const TopoDS_Shape& from, const TopoDS_Shape& what) {
  return BRepAlgoAPI_Cut(from, what).Shape();
}

TopoDS_Shape hexagon(double radius, double height) {
  BRepBuilderAPI_MakePolygon outline;
  for (int i = 0; i < 6; ++i) {
    const double turn = std::numbers::pi / 3 * i;
    outline.Add(gp_Pnt(radius * std::cos(turn), radius * std::sin(turn), 0));
  }
  outline.Close();
  return BRepPrimAPI_MakePrism(BRepBuilderAPI_MakeFace(outline.Wire()).Face(), gp_Vec(0, 0, height))
      .Shape();
}

TopoDS_Shape housing() {
  TopoDS_Shape shape = cut(box({0, 0, 0}, {110, 70, 40}), box({8, 8, 8}, {72, 62, 50}));
  for (const auto& [x, y] : kBoltPlaces) shape = cut(shape, cylinder(2, 20, {x, y, 25}));
  return cut(shape, cylinder(5, 50, {kPinX, kPinY, -5}));
}

TopoDS_Shape cover() {
  TopoDS_Shape shape = box({0, 0, 0}, {80, 70, 6});
  for (const auto& [x, y] : kBoltPlaces) shape = cut(shape, cylinder(2, 10, {x, y, -2}));
  return shape;
}

TopoDS_Shape bolt() {
  return BRepAlgoAPI_Fuse(hexagon(3.5, 3), cylinder(1.9, 18, {0, 0, -18})).Shape();
}

TopoDS_Shape clip_half() {
  return cut(cut(cylinder(10, 8), cylinder(5, 20, {0, 0, -5})), box({-20, -20, -5}, {0.1, 20, 20}));
}

class Assembly {
 public:
  explicit Assembly(const Handle(TDocStd_Document) & document)
      : tool_(XCAFDoc_DocumentTool::ShapeTool(document->Main())) {}

  TDF_Label part(const char* name, const TopoDS_Shape& shape) {
    return named(tool_->AddShape(shape, false), name);
  }
  TDF_Label assembly(const char* name) { return named(tool_->NewShape(), name); }

  // `child` turned about z, then moved. Every second instance keeps the name that OpenCASCADE
  // makes up.
  void place(const TDF_Label& parent, const TDF_Label& child, const gp_Vec& move,
             double turn_rad = 0) {
    gp_Trsf turn, placing;
    turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), turn_rad);
    placing.SetTranslation(move);
    const TDF_Label instance = tool_->AddComponent(parent, child, TopLoc_Location(placing * turn));
    if (++instances_ % 2 == 1) named(instance, ("NAUO" + std::to_string(instances_)).c_str());
  }

  void finish() { tool_->UpdateAssemblies(); }

 private:
  static TDF_Label named(const TDF_Label& label, const char* name) {
    TDataStd_Name::Set(label, name);
    return label;
  }

  Handle(XCAFDoc_ShapeTool) tool_;
  int instances_ = 0;
};

void fill(const Handle(TDocStd_Document) & document) {
  Assembly made(document);
  const TDF_Label bolt_part = made.part("Bolt", bolt()), half = made.part("Half", clip_half());
  const TDF_Label lid = made.assembly("Lid");
  made.place(lid, made.part("Cover", cover()), {0, 0, 0});
  for (const auto& [x, y] : kBoltPlaces) made.place(lid, bolt_part, {x, y, 6});
  const TDF_Label clip = made.assembly("Clip");
  made.place(clip, half, {0, 0, 0});
  made.place(clip, half, {0, 0, 0}, std::numbers::pi);
  const TDF_Label top = made.assembly("Gearbox");
  made.place(top, made.part("Housing", housing()), {0, 0, 0});
  made.place(top, lid, {0, 0, 40});
  made.place(top, made.part("Pin", cylinder(4.9, 60)), {kPinX, kPinY, 0});
  made.place(top, clip, {kPinX, kPinY, 42});
  made.finish();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: make_sample_step FILE.step\n", stderr), 2;
  Message::DefaultMessenger()->ChangePrinters().Clear();
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  fill(document);
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  if (!writer.Transfer(document, STEPControl_AsIs)) return 1;
  return writer.Write(argv[1]) == IFSelect_RetDone ? 0 : 1;
}
