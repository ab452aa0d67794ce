#include "formats/mesh/step/entities/constructive.h"

#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepPrimAPI_MakeWedge.hxx>
#include <Bnd_Box.hxx>
#include <Geom_Axis1Placement.hxx>
#include <Geom_Axis2Placement.hxx>
#include <Geom_CartesianPoint.hxx>
#include <Geom_Direction.hxx>
#include <Geom_Plane.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Standard_Failure.hxx>
#include <StepData_GlobalFactors.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_Axis1Placement.hxx>
#include <StepGeom_Axis2Placement3d.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepGeom_CurveBoundedSurface.hxx>
#include <StepGeom_Direction.hxx>
#include <StepGeom_Plane.hxx>
#include <StepRepr_RepresentationContext.hxx>
#include <StepShape_Block.hxx>
#include <StepShape_BooleanResult.hxx>
#include <StepShape_CsgSolid.hxx>
#include <StepShape_ExtrudedAreaSolid.hxx>
#include <StepShape_HalfSpaceSolid.hxx>
#include <StepShape_RevolvedAreaSolid.hxx>
#include <StepShape_RightAngularWedge.hxx>
#include <StepShape_RightCircularCylinder.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <StepShape_Sphere.hxx>
#include <StepShape_Torus.hxx>
#include <StepToGeom.hxx>
#include <StepToTopoDS_TranslateCurveBoundedSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TransferBRep_ShapeBinder.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <cmath>
#include <functional>
#include <gp_Ax2.hxx>
#include <gp_Pln.hxx>
#include <optional>
#include <vector>

#include "formats/mesh/step/entities/step_units.h"

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);

struct NotUnderstood {};

// A solid beside the answer to whether it holds a place, which is told by the primitives alone.
struct Solid {
  TopoDS_Shape shape;
  std::function<TopAbs_State(const gp_Pnt&)> state;
  std::vector<Bnd_Box> primitives;  // the boxes of those that it is made of
};

template <typename Geometry>
Geometry understood(const Geometry& geometry) {
  if (geometry.IsNull()) throw NotUnderstood{};
  return geometry;
}

double positive(double length) {
  if (!(length > 0)) throw NotUnderstood{};
  return length;
}

// OpenCASCADE's translators keep units in globals; each transfer sets its own.
void use_units_of(const Handle(StepRepr_RepresentationContext) & context) {
  const std::optional<StepUnits> units = units_of(context);
  if (!units) throw NotUnderstood{};
  StepData_GlobalFactors::Intance().InitializeFactors(units->mm, units->radians, 1);
}

double mm(double length) { return length * StepData_GlobalFactors::Intance().LengthFactor(); }

gp_Ax2 frame_of(const Handle(StepGeom_Axis2Placement3d) & placement) {
  return understood(StepToGeom::MakeAxis2Placement(understood(placement)))->Ax2();
}

gp_Ax1 axis_of(const Handle(StepGeom_Axis1Placement) & placement) {
  return understood(StepToGeom::MakeAxis1Placement(understood(placement)))->Ax1();
}

gp_Ax2 frame_of(const Handle(StepGeom_Axis1Placement) & placement) {
  const gp_Ax1 axis = axis_of(placement);
  return {axis.Location(), axis.Direction()};
}

Bnd_Box box_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  if (box.IsVoid()) throw NotUnderstood{};
  return box;
}

// Where a place lies in a shape that may be several solids.
TopAbs_State state_in(const TopoDS_Shape& shape, const gp_Pnt& place) {
  constexpr double kNear = 1e-5;  // mm
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    BRepClass3d_SolidClassifier classifier(solid.Current());
    classifier.Perform(place, kNear);
    if (classifier.State() != TopAbs_OUT) return classifier.State();
  }
  return TopAbs_OUT;
}

Solid primitive(const TopoDS_Shape& shape) {
  if (shape.IsNull() || !BRepCheck_Analyzer(shape).IsValid()) throw NotUnderstood{};
  return {shape, [shape](const gp_Pnt& place) { return state_in(shape, place); }, {box_of(shape)}};
}

// As much of a half space as can matter to a solid in `other`.
Solid half_space(const Handle(StepShape_HalfSpaceSolid) & entity, const Bnd_Box& other) {
  const auto surface = Handle(StepGeom_Plane)::DownCast(entity->BaseSurface());
  const gp_Pln plane = understood(StepToGeom::MakePlane(understood(surface)))->Pln();
  // The flag is set where the normal points away from the material.
  gp_Dir inwards = plane.Axis().Direction();
  if (entity->AgreementFlag()) inwards.Reverse();
  const gp_Pnt low = other.CornerMin(), high = other.CornerMax();
  const gp_Pnt middle((low.XYZ() + high.XYZ()) / 2);
  const double depth = gp_Vec(plane.Location(), middle).Dot(gp_Vec(inwards));
  const double reach = low.Distance(high) + std::abs(depth) + 1;
  gp_Ax2 frame(middle.Translated(-depth * gp_Vec(inwards)), inwards);
  frame.Translate(-reach * (gp_Vec(frame.XDirection()) + gp_Vec(frame.YDirection())));
  return primitive(BRepPrimAPI_MakeBox(frame, 2 * reach, 2 * reach, 2 * reach).Shape());
}

TopAbs_State opposite(TopAbs_State state) {
  return state == TopAbs_IN ? TopAbs_OUT : state == TopAbs_OUT ? TopAbs_IN : state;
}

TopAbs_State both(TopAbs_State a, TopAbs_State b) {
  if (a == TopAbs_OUT || b == TopAbs_OUT) return TopAbs_OUT;
  return a == TopAbs_IN && b == TopAbs_IN ? TopAbs_IN : TopAbs_ON;
}

TopAbs_State combined(StepShape_BooleanOperator how, TopAbs_State a, TopAbs_State b) {
  switch (how) {
    case StepShape_boDifference:
      return both(a, opposite(b));
    case StepShape_boIntersection:
      return both(a, b);
    case StepShape_boUnion:
      return opposite(both(opposite(a), opposite(b)));
  }
  throw NotUnderstood{};
}

TopoDS_Shape shape_of(StepShape_BooleanOperator how, const TopoDS_Shape& a, const TopoDS_Shape& b) {
  const auto result = [](BRepAlgoAPI_BooleanOperation&& operation) {
    if (!operation.IsDone() || operation.HasErrors()) throw NotUnderstood{};
    return operation.Shape();
  };
  switch (how) {
    case StepShape_boDifference:
      return result(BRepAlgoAPI_Cut(a, b));
    case StepShape_boIntersection:
      return result(BRepAlgoAPI_Common(a, b));
    case StepShape_boUnion:
      return result(BRepAlgoAPI_Fuse(a, b));
  }
  throw NotUnderstood{};
}

// Digits of `n` behind the point, in this base.
double halton(int n, int base) {
  double value = 0, digit = 1;
  for (; n > 0; n /= base) value += (digit /= base) * (n % base);
  return value;
}

// OpenCASCADE's Boolean operations may miss an intersection without an error: the result must hold
// the places that its primitives say it holds. Each primitive's box has places of its own.
void check_result(const Solid& solid) {
  constexpr int kPlaces = 64;
  if (!BRepCheck_Analyzer(solid.shape).IsValid()) throw NotUnderstood{};
  for (const Bnd_Box& box : solid.primitives) {
    const gp_XYZ low = box.CornerMin().XYZ(), size = box.CornerMax().XYZ() - low;
    for (int n = 1; n <= kPlaces; ++n) {
      const gp_Pnt place(
          low + gp_XYZ(halton(n, 2) * size.X(), halton(n, 3) * size.Y(), halton(n, 5) * size.Z()));
      const TopAbs_State wanted = solid.state(place), got = state_in(solid.shape, place);
      if (wanted != TopAbs_ON && got != TopAbs_ON && wanted != got) throw NotUnderstood{};
    }
  }
}

// Roots of trees; their operands are found from them.
bool is_constructive_solid(const Entity& entity) {
  for (const Handle(Standard_Type) & type :
       {STANDARD_TYPE(StepShape_CsgSolid), STANDARD_TYPE(StepShape_BooleanResult),
        STANDARD_TYPE(StepShape_Block), STANDARD_TYPE(StepShape_Sphere),
        STANDARD_TYPE(StepShape_Torus), STANDARD_TYPE(StepShape_RightAngularWedge),
        STANDARD_TYPE(StepShape_RightCircularCylinder), STANDARD_TYPE(StepShape_ExtrudedAreaSolid),
        STANDARD_TYPE(StepShape_RevolvedAreaSolid)}) {
    if (!entity.IsNull() && entity->IsKind(type)) return true;
  }
  return false;
}

class SolidMaker {
 public:
  SolidMaker(const Interface_Graph& graph, const Handle(Transfer_TransientProcess) & process)
      : graph_(graph), process_(process) {}

  std::vector<Entity> entities;  // that were used

  Solid make(const Entity& entity, int levels = kMostLevels) {
    if (levels == 0 || entity.IsNull()) throw NotUnderstood{};
    entities.push_back(entity);
    if (entity->IsKind(STANDARD_TYPE(StepShape_CsgSolid))) {
      return make(operands_of(entity, 1).front(), levels - 1);
    }
    if (const auto result = Handle(StepShape_BooleanResult)::DownCast(entity); !result.IsNull()) {
      return combine(result, levels - 1);
    }
    return primitive(shape_of(entity));
  }

 private:
  static constexpr int kMostLevels = 200;

  // The entities that `entity` refers to, in their order. OpenCASCADE's own fields lack operands of
  // most types.
  std::vector<Entity> operands_of(const Entity& entity, std::size_t count) const {
    std::vector<Entity> operands;
    Interface_EntityIterator operand = graph_.Shareds(entity);
    for (operand.Start(); operand.More(); operand.Next()) operands.push_back(operand.Value());
    if (operands.size() != count) throw NotUnderstood{};
    return operands;
  }

  Solid combine(const Handle(StepShape_BooleanResult) & result, int levels) {
    const std::vector<Entity> operands = operands_of(result, 2);
    const Entity &first = operands[0], &second = operands[1];
    const auto first_half = Handle(StepShape_HalfSpaceSolid)::DownCast(first),
               second_half = Handle(StepShape_HalfSpaceSolid)::DownCast(second);
    const StepShape_BooleanOperator how = result->Operator();
    // A result that a half space leaves without end is no solid.
    const bool is_endless = !first_half.IsNull()
                                ? how != StepShape_boIntersection || !second_half.IsNull()
                                : !second_half.IsNull() && how == StepShape_boUnion;
    if (is_endless) throw NotUnderstood{};
    if (!first_half.IsNull()) {
      const Solid b = make(second, levels);
      return combine(how, half(first_half, b), b);
    }
    const Solid a = make(first, levels);
    return combine(how, a, second_half.IsNull() ? make(second, levels) : half(second_half, a));
  }

  Solid half(const Handle(StepShape_HalfSpaceSolid) & entity, const Solid& beside) {
    entities.push_back(entity);
    return half_space(entity, box_of(beside.shape));
  }

  static Solid combine(StepShape_BooleanOperator how, const Solid& a, const Solid& b) {
    Solid solid{mesh::shape_of(how, a.shape, b.shape),
                [how, in_a = a.state, in_b = b.state](const gp_Pnt& place) {
                  return combined(how, in_a(place), in_b(place));
                },
                a.primitives};
    solid.primitives.insert(solid.primitives.end(), b.primitives.begin(), b.primitives.end());
    check_result(solid);
    return solid;
  }

  TopoDS_Shape shape_of(const Entity& entity) const {
    if (const auto block = Handle(StepShape_Block)::DownCast(entity); !block.IsNull()) {
      return BRepPrimAPI_MakeBox(frame_of(block->Position()), positive(mm(block->X())),
                                 positive(mm(block->Y())), positive(mm(block->Z())))
          .Shape();
    }
    if (const auto sphere = Handle(StepShape_Sphere)::DownCast(entity); !sphere.IsNull()) {
      const auto centre = Handle(StepGeom_CartesianPoint)::DownCast(sphere->Centre());
      return BRepPrimAPI_MakeSphere(
                 understood(StepToGeom::MakeCartesianPoint(understood(centre)))->Pnt(),
                 positive(mm(sphere->Radius())))
          .Shape();
    }
    if (const auto torus = Handle(StepShape_Torus)::DownCast(entity); !torus.IsNull()) {
      if (!(torus->MajorRadius() > torus->MinorRadius())) throw NotUnderstood{};
      return BRepPrimAPI_MakeTorus(frame_of(torus->Position()), mm(torus->MajorRadius()),
                                   positive(mm(torus->MinorRadius())))
          .Shape();
    }
    if (const auto rod = Handle(StepShape_RightCircularCylinder)::DownCast(entity); !rod.IsNull()) {
      return BRepPrimAPI_MakeCylinder(frame_of(rod->Position()), positive(mm(rod->Radius())),
                                      positive(mm(rod->Height())))
          .Shape();
    }
    if (const auto wedge = Handle(StepShape_RightAngularWedge)::DownCast(entity); !wedge.IsNull()) {
      if (!(wedge->Ltx() >= 0)) throw NotUnderstood{};
      return BRepPrimAPI_MakeWedge(frame_of(wedge->Position()), positive(mm(wedge->X())),
                                   positive(mm(wedge->Y())), positive(mm(wedge->Z())),
                                   mm(wedge->Ltx()))
          .Shape();
    }
    return swept(entity);
  }

  TopoDS_Shape swept(const Entity& entity) const {
    if (const auto rib = Handle(StepShape_ExtrudedAreaSolid)::DownCast(entity); !rib.IsNull()) {
      const gp_Dir along =
          understood(StepToGeom::MakeDirection(understood(rib->ExtrudedDirection())))->Dir();
      return BRepPrimAPI_MakePrism(area(rib->SweptArea()),
                                   positive(mm(rib->Depth())) * gp_Vec(along))
          .Shape();
    }
    if (const auto ring = Handle(StepShape_RevolvedAreaSolid)::DownCast(entity); !ring.IsNull()) {
      const double angle = ring->Angle() * StepData_GlobalFactors::Intance().PlaneAngleFactor();
      return BRepPrimAPI_MakeRevol(area(ring->SweptArea()), axis_of(ring->Axis()), positive(angle))
          .Shape();
    }
    throw NotUnderstood{};
  }

  TopoDS_Shape area(const Handle(StepGeom_CurveBoundedSurface) & surface) const {
    const StepToTopoDS_TranslateCurveBoundedSurface face(understood(surface), process_);
    if (!face.IsDone() || face.Value().IsNull()) throw NotUnderstood{};
    return face.Value();
  }

  const Interface_Graph& graph_;
  Handle(Transfer_TransientProcess) process_;
};

}  // namespace

ReadEntities make_constructive_solids(const Handle(XSControl_WorkSession) & session) {
  ReadEntities read;
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  if (!session->TransferReader()->BeginTransfer()) return read;
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(model->Value(i));
    if (shape.IsNull()) continue;
    for (Standard_Integer n = 1; n <= shape->NbItems(); ++n) {
      const Entity item = shape->ItemsValue(n);
      if (!is_constructive_solid(item) || process->IsBound(item)) continue;
      try {
        use_units_of(shape->ContextOfItems());
        SolidMaker maker(session->Graph(), process);
        const Solid solid = maker.make(item);
        process->Bind(item, new TransferBRep_ShapeBinder(solid.shape));
        for (const Entity& entity : maker.entities) {
          if (entity != item) read.insert(entity.get());
        }
      } catch (const NotUnderstood&) {
        continue;
      } catch (const Standard_Failure&) {
        continue;
      }
    }
  }
  return read;
}

}  // namespace forcelayer::mesh
