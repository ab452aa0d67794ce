// Shapes with faces that OpenCASCADE does not tessellate, and a writer of STEP files. Millimeters.
#pragma once

#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakePolygon.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRep_Builder.hxx>
#include <Geom_BezierCurve.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <array>
#include <gp_Pln.hxx>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace forcelayer::test {

inline TopoDS_Edge bezier_edge(const std::vector<gp_Pnt>& poles) {
  TColgp_Array1OfPnt array(1, static_cast<Standard_Integer>(poles.size()));
  for (std::size_t i = 0; i < poles.size(); ++i) {
    array.SetValue(static_cast<Standard_Integer>(i + 1), poles[i]);
  }
  return BRepBuilderAPI_MakeEdge(Handle(Geom_Curve)(new Geom_BezierCurve(array))).Edge();
}

// The plane z = 0 between two curves that share their ends.
inline TopoDS_Face face_between(const TopoDS_Edge& a, const TopoDS_Edge& b) {
  const TopoDS_Wire wire = BRepBuilderAPI_MakeWire(a, b).Wire();
  return BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), wire, true).Face();
}

// A solid 30 high between two curves 100 long that are less than 3 mm apart:
// at some deflections their polygons cross, and OpenCASCADE gives top and bottom no triangles.
inline TopoDS_Shape crescent(const std::array<double, 3>& y, const std::array<double, 3>& move_x,
                             double move_y) {
  const auto edge = [&](double fraction) {
    std::vector<gp_Pnt> poles{{0, 0, 0}};
    for (std::size_t i = 0; i < 3; ++i) {
      poles.emplace_back(25.0 * static_cast<double>(i + 1) + fraction * move_x[i],
                         y[i] + fraction * move_y, 0);
    }
    poles.emplace_back(100, 0, 0);
    return bezier_edge(poles);
  };
  return BRepPrimAPI_MakePrism(face_between(edge(0), edge(1)), gp_Vec(0, 0, 30)).Shape();
}

// Top and bottom have no triangles at a deflection of 1, and have all at 0.5.
inline TopoDS_Shape crescent_for_finer() { return crescent({-49, -47, -40}, {-0.4, 0.6, -3}, 0.5); }

// Top and bottom have no triangles at 0.1, 0.05 and 0.025, and have all at 0.2.
inline TopoDS_Shape crescent_for_coarser() { return crescent({-32, -46, 24}, {-1, -0.5, -0.3}, 1); }

// A face 100 x 12 whose outline crosses itself; no deflection up to 2 and no mending gives
// triangles.
inline TopoDS_Face crossed_face(double bulge = 20) {
  return face_between(bezier_edge({{0, 0, 0}, {30, bulge, 0}, {70, -bulge, 0}, {100, 0, 0}}),
                      bezier_edge({{0, 0, 0}, {30, -bulge, 0}, {70, bulge, 0}, {100, 0, 0}}));
}

// A square of 10 whose corners are joined crosswise: two triangles that meet in the middle.
inline TopoDS_Face bow_tie() {
  BRepBuilderAPI_MakePolygon outline(gp_Pnt(0, 0, 0), gp_Pnt(10, 10, 0), gp_Pnt(10, 0, 0),
                                     gp_Pnt(0, 10, 0), true);
  return BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), outline.Wire(), true)
      .Face();
}

// Planar faces that share vertices and edges.
class Polyhedron {
 public:
  // The corners of a face, counterclockwise seen from outside.
  void add(const std::vector<gp_Pnt>& corners) {
    BRepBuilderAPI_MakeWire wire;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      wire.Add(edge(corners[i], corners[(i + 1) % corners.size()]));
    }
    const gp_Vec across(corners[0], corners[1]), back(corners[0], corners.back());
    const gp_Pln plane(corners[0], gp_Dir(across.Crossed(back)));
    builder_.Add(shape_, BRepBuilderAPI_MakeFace(plane, wire.Wire(), true).Face());
  }

  TopoDS_Shape shape() const { return shape_; }

  Polyhedron() { builder_.MakeCompound(shape_); }

 private:
  using Key = std::array<double, 3>;

  static Key key(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

  TopoDS_Vertex vertex(const gp_Pnt& p) {
    TopoDS_Vertex& made = vertices_[key(p)];
    if (made.IsNull()) builder_.MakeVertex(made, p, 1e-7);
    return made;
  }

  TopoDS_Edge edge(const gp_Pnt& a, const gp_Pnt& b) {
    if (const auto back = edges_.find({key(b), key(a)}); back != edges_.end()) {
      return TopoDS::Edge(back->second.Reversed());
    }
    TopoDS_Edge& made = edges_[{key(a), key(b)}];
    if (made.IsNull()) made = BRepBuilderAPI_MakeEdge(vertex(a), vertex(b)).Edge();
    return made;
  }

  BRep_Builder builder_;
  TopoDS_Compound shape_;
  std::map<Key, TopoDS_Vertex> vertices_;
  std::map<std::pair<Key, Key>, TopoDS_Edge> edges_;
};

// A cube of 10 whose top is cut in three: the middle piece is a triangle 10 x `width`.
inline TopoDS_Shape cube_with_sliver(double width) {
  const gp_Pnt tip(5, 5 + width, 10);
  Polyhedron cube;
  cube.add({{0, 0, 0}, {0, 10, 0}, {10, 10, 0}, {10, 0, 0}});
  cube.add({{0, 0, 0}, {0, 0, 10}, {0, 5, 10}, {0, 10, 10}, {0, 10, 0}});
  cube.add({{10, 0, 0}, {10, 10, 0}, {10, 10, 10}, {10, 5, 10}, {10, 0, 10}});
  cube.add({{0, 0, 0}, {10, 0, 0}, {10, 0, 10}, {0, 0, 10}});
  cube.add({{0, 10, 0}, {0, 10, 10}, {10, 10, 10}, {10, 10, 0}});
  cube.add({{0, 0, 10}, {10, 0, 10}, {10, 5, 10}, {0, 5, 10}});
  cube.add({{0, 5, 10}, {10, 5, 10}, tip});
  cube.add({{10, 5, 10}, {10, 10, 10}, {0, 10, 10}, {0, 5, 10}, tip});
  return cube.shape();
}

inline TopoDS_Shape together(const std::vector<TopoDS_Shape>& shapes) {
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& shape : shapes) builder.Add(compound, shape);
  return compound;
}

// A cube of 20 and, over it, a face that gets no triangles.
inline TopoDS_Shape cube_with_lost_face() {
  gp_Trsf lift;
  lift.SetTranslation(gp_Vec(0, 10, 40));
  return together(
      {BRepPrimAPI_MakeBox(20, 20, 20).Shape(), crossed_face().Moved(TopLoc_Location(lift))});
}

// Writes an assembly "tray" of these parts, each as far along x as its number times 200. False
// where that fails.
inline bool write_tray(const std::string& path,
                       const std::vector<std::pair<std::string, TopoDS_Shape>>& parts) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  const Handle(XCAFDoc_ShapeTool) tool = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto named = [](const TDF_Label& label, const std::string& name) {
    TDataStd_Name::Set(label, name.c_str());
    return label;
  };
  const TDF_Label tray = named(tool->NewShape(), "tray");
  for (std::size_t i = 0; i < parts.size(); ++i) {
    gp_Trsf place;
    place.SetTranslation(gp_Vec(200.0 * static_cast<double>(i), 0, 0));
    const TDF_Label part = named(tool->AddShape(parts[i].second, false), parts[i].first + "_part");
    named(tool->AddComponent(tray, part, TopLoc_Location(place)), parts[i].first);
  }
  tool->UpdateAssemblies();
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  return writer.Transfer(document) && writer.Write(path.c_str()) == IFSelect_RetDone;
}

}  // namespace forcelayer::test
