#include "formats/mesh/step/cost/triangle_forecast.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepLProp_SLProps.hxx>
#include <BRepTools.hxx>
#include <Bnd_Box.hxx>
#include <Precision.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>

namespace forcelayer::mesh {
namespace {

// Points along each parameter: some of each piece of the surface.
int samples_along(int pieces) {
  constexpr int kOfEach = 3, kMax = 100;
  return std::clamp(kOfEach * pieces, 1, kMax);
}

class FaceForecast {
 public:
  FaceForecast(const TopoDS_Face& face, double deflection_mm, double angle_rad)
      : surface_(face), deflection_mm_(deflection_mm), angle_rad_(angle_rad) {
    BRepTools::UVBounds(face, u0_, u1_, v0_, v1_);
    Bnd_Box box;
    BRepBndLib::Add(face, box, false);
    if (!box.IsVoid() && !box.IsOpen()) size_mm_ = std::sqrt(box.SquareExtent());
  }

  double triangles() {
    constexpr double kOfAPlane = 2;
    if (surface_.GetType() == GeomAbs_Plane || !(size_mm_ > 0)) return kOfAPlane;
    const int across = samples_along(surface_.NbUIntervals(GeomAbs_C2)),
              along = samples_along(surface_.NbVIntervals(GeomAbs_C2));
    const double fraction = (u1_ - u0_) * (v1_ - v0_) / across / along;
    double count = kOfAPlane;
    for (int i = 0; i < across; ++i) {
      for (int j = 0; j < along; ++j) {
        count += fraction * density(u0_ + (i + 0.5) * (u1_ - u0_) / across,
                                    v0_ + (j + 0.5) * (v1_ - v0_) / along);
      }
    }
    return count;
  }

 private:
  // Triangles per unit of the parameters' area.
  double density(double u, double v) const {
    BRepLProp_SLProps point(surface_, u, v, 2, Precision::Confusion());
    const double area = point.D1U().Crossed(point.D1V()).Magnitude();
    if (!point.IsCurvatureDefined()) return 0;
    constexpr double kOfOpenCascade = 10;  // of the 2 that fit; measured, within a factor of two
    return kOfOpenCascade * area / (edge_mm(point.MinCurvature()) * edge_mm(point.MaxCurvature()));
  }

  double edge_mm(double curvature) const {
    const double k = std::abs(curvature);
    return std::min({size_mm_, std::sqrt(8 * deflection_mm_ / k), angle_rad_ / k});
  }

  BRepAdaptor_Surface surface_;
  double deflection_mm_, angle_rad_;
  double u0_ = 0, u1_ = 0, v0_ = 0, v1_ = 0, size_mm_ = 0;
};

}  // namespace

double forecast_triangles(const TopoDS_Shape& shape, double deflection_mm, double angle_rad) {
  double count = 0;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    try {
      count += FaceForecast(TopoDS::Face(face.Current()), deflection_mm, angle_rad).triangles();
    } catch (const Standard_Failure&) {
      // Such a face is looked at when it is tessellated.
    }
  }
  return count;
}

}  // namespace forcelayer::mesh
