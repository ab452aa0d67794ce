#include "formats/mesh/step/iges/iges_trims.h"

#include <IGESGeom_Boundary.hxx>
#include <IGESGeom_BoundedSurface.hxx>
#include <IGESGeom_CompositeCurve.hxx>
#include <IGESGeom_CurveOnSurface.hxx>
#include <IGESGeom_TrimmedSurface.hxx>
#include <IGESSolid_Face.hxx>
#include <Interface_Check.hxx>
#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

namespace forcelayer::mesh {
namespace {

using Entity = Handle(IGESData_IGESEntity);

constexpr int kMostLevels = 8;  // of composite curves; a damaged one may list itself

bool is_one_of(const Entity& entity, std::initializer_list<int> types) {
  return std::find(types.begin(), types.end(), entity->TypeNumber()) != types.end();
}

bool is_simple_curve(const Entity& entity) {
  return is_one_of(entity, {100, 104, 106, 110, 112, 126, 130});
}

// Points may stand between the curves of a composite one.
bool is_point(const Entity& entity) { return is_one_of(entity, {116, 132}); }

class Trims {
 public:
  explicit Trims(const Handle(IGESData_IGESModel) & model) : model_(model) {}

  bool is_bad(const Handle(IGESGeom_TrimmedSurface) & face) const {
    if (fails(face) || fails(face->Surface())) return true;
    std::vector<Handle(IGESGeom_CurveOnSurface)> all;
    if (face->HasOuterContour()) all.push_back(face->OuterContour());
    for (Standard_Integer i = 1; i <= face->NbInnerContours(); ++i) {
      all.push_back(face->InnerContour(i));
    }
    std::set<const Standard_Transient*> curves;
    for (const auto& boundary : all) {
      if (is_bad(boundary, face->Surface())) return true;
      const Entity in_space = boundary->Curve3D();
      if (!curves.insert(in_space.IsNull() ? boundary->CurveUV().get() : in_space.get()).second)
        return true;
    }
    return false;
  }

  bool is_bad(const Handle(IGESGeom_BoundedSurface) & face) const {
    if (fails(face) || fails(face->Surface())) return true;
    for (Standard_Integer i = 1; i <= face->NbBoundaries(); ++i) {
      if (is_bad(face->Boundary(i), face->Surface())) return true;
    }
    return false;
  }

 private:
  bool is_bad(const Handle(IGESGeom_CurveOnSurface) & boundary, const Entity& surface) const {
    if (boundary.IsNull() || is_elsewhere(boundary->Surface(), surface)) return true;
    const Entity in_space = boundary->Curve3D(), in_parameters = boundary->CurveUV();
    if (in_space.IsNull() && in_parameters.IsNull()) return true;
    return is_no_curve(in_space) || is_no_curve(in_parameters);
  }

  bool is_bad(const Handle(IGESGeom_Boundary) & boundary, const Entity& surface) const {
    if (boundary.IsNull() || is_elsewhere(boundary->Surface(), surface)) return true;
    for (Standard_Integer i = 1; i <= boundary->NbModelSpaceCurves(); ++i) {
      if (boundary->ModelSpaceCurve(i).IsNull() || is_no_curve(boundary->ModelSpaceCurve(i))) {
        return true;
      }
      for (Standard_Integer n = 1; n <= boundary->NbParameterCurves(i); ++n) {
        if (is_no_curve(boundary->ParameterCurve(i, n))) return true;
      }
    }
    return boundary->NbModelSpaceCurves() == 0;
  }

  static bool is_elsewhere(const Entity& surface, const Entity& of_face) {
    return !surface.IsNull() && surface != of_face;
  }

  // One that is left out is no flaw.
  bool is_no_curve(const Entity& entity, int levels = kMostLevels) const {
    if (entity.IsNull()) return false;
    const auto all = Handle(IGESGeom_CompositeCurve)::DownCast(entity);
    if (all.IsNull()) return !is_simple_curve(entity) || fails(entity);
    if (levels == 0 || all->NbCurves() == 0 || fails(all) || lacks_a_curve(all)) return true;
    for (Standard_Integer i = 1; i <= all->NbCurves(); ++i) {
      const Entity part = all->Curve(i);
      if (part.IsNull() || (!is_point(part) && is_no_curve(part, levels - 1))) return true;
    }
    return false;
  }

  // OpenCASCADE drops pointers that lead nowhere from a list.
  bool lacks_a_curve(const Entity& list) const {
    const Handle(Interface_Check) check = model_->Check(model_->Number(list), Standard_True);
    for (Standard_Integer i = 1; i <= check->NbWarnings(); ++i) {
      const std::string_view warning = check->CWarning(i, Standard_True);
      if (warning.find("ignored") != warning.npos) return true;
    }
    return false;
  }

  bool fails(const Entity& entity) const {
    const Standard_Integer number = entity.IsNull() ? 0 : model_->Number(entity);
    return number > 0 && model_->Check(number, Standard_True)->NbFails() > 0;
  }

  Handle(IGESData_IGESModel) model_;
};

}  // namespace

bool is_badly_trimmed(const Handle(IGESData_IGESModel) & model, const Entity& entity) {
  const auto trimmed = Handle(IGESGeom_TrimmedSurface)::DownCast(entity);
  if (!trimmed.IsNull()) return Trims(model).is_bad(trimmed);
  const auto bounded = Handle(IGESGeom_BoundedSurface)::DownCast(entity);
  return !bounded.IsNull() && Trims(model).is_bad(bounded);
}

std::vector<Entity> parts_of_trimmed(const Entity& entity) {
  if (const auto face = Handle(IGESGeom_TrimmedSurface)::DownCast(entity); !face.IsNull()) {
    return {face->Surface(), face->OuterContour()};
  }
  if (const auto face = Handle(IGESGeom_BoundedSurface)::DownCast(entity); !face.IsNull()) {
    return {face->Surface()};
  }
  if (const auto face = Handle(IGESSolid_Face)::DownCast(entity); !face.IsNull()) {
    return {face->Surface()};
  }
  const auto boundary = Handle(IGESGeom_CurveOnSurface)::DownCast(entity);
  if (boundary.IsNull()) return {};
  return {boundary->Surface(), boundary->Curve3D(), boundary->CurveUV()};
}

void empty_trims(const Entity& entity) {
  const auto trimmed = Handle(IGESGeom_TrimmedSurface)::DownCast(entity);
  if (!trimmed.IsNull()) trimmed->Init(nullptr, 0, nullptr, nullptr);
  const auto bounded = Handle(IGESGeom_BoundedSurface)::DownCast(entity);
  if (!bounded.IsNull()) bounded->Init(0, nullptr, nullptr);
}

std::uint64_t count_boundaries(const Entity& entity) {
  const auto trimmed = Handle(IGESGeom_TrimmedSurface)::DownCast(entity);
  if (!trimmed.IsNull()) {
    return static_cast<std::uint64_t>(trimmed->NbInnerContours()) + trimmed->HasOuterContour();
  }
  const auto bounded = Handle(IGESGeom_BoundedSurface)::DownCast(entity);
  return bounded.IsNull() ? 0 : static_cast<std::uint64_t>(bounded->NbBoundaries());
}

}  // namespace forcelayer::mesh
