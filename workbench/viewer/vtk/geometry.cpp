#include "workbench/viewer/vtk/geometry.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFeatureEdges.h>
#include <vtkFloatArray.h>
#include <vtkIdTypeArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStaticCleanPolyData.h>
#include <vtkTypeInt32Array.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace forcelayer::viewer {
namespace {

vtkSmartPointer<vtkPoints> points_of(const std::vector<std::array<float, 3>>& points) {
  vtkNew<vtkFloatArray> array;
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(points.size()));
  std::copy_n(points.empty() ? nullptr : points.front().data(), 3 * points.size(),
              array->GetPointer(0));
  auto result = vtkSmartPointer<vtkPoints>::New();
  result->SetData(array);
  return result;
}

// Cells of `corners` points each; `index`(n) is the n-th corner's point.
template <typename Index>
vtkSmartPointer<vtkCellArray> cells_of(std::size_t cells, std::size_t corners, Index index) {
  vtkNew<vtkTypeInt32Array> offsets, connectivity;
  offsets->SetNumberOfValues(static_cast<vtkIdType>(cells + 1));
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(cells * corners));
  for (std::size_t n = 0; n <= cells; ++n) {
    offsets->SetValue(static_cast<vtkIdType>(n), static_cast<int>(n * corners));
  }
  for (std::size_t n = 0; n < cells * corners; ++n) {
    connectivity->SetValue(static_cast<vtkIdType>(n), static_cast<int>(index(n)));
  }
  auto result = vtkSmartPointer<vtkCellArray>::New();
  result->SetData(offsets, connectivity);
  return result;
}

glm::dvec3 across(const glm::dvec3& axis) {
  const glm::dvec3 other = std::abs(axis.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return glm::normalize(glm::cross(axis, other));
}

std::array<float, 3> floats(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

PolyData poly_data_of(const ViewMesh& mesh) {
  auto data = PolyData::New();
  data->SetPoints(points_of(mesh.points));
  data->SetPolys(cells_of(mesh.triangles.size(), 3,
                          [&](std::size_t n) { return mesh.triangles[n / 3][n % 3]; }));
  return data;
}

PolyData poly_data_of(const QuadSurface& surface, int direction) {
  std::vector<std::array<float, 3>> corners;
  for (std::size_t n = 0; n < surface.corners.size(); ++n) {
    if (surface.directions[n / 4] == direction) corners.push_back(surface.corners[n]);
  }
  auto data = PolyData::New();
  data->SetPoints(points_of(corners));
  data->SetPolys(cells_of(corners.size() / 4, 4, [](std::size_t n) { return n; }));
  return data;
}

void color_cells(const PolyData& mesh, const Color& color) {
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  colors->SetNumberOfTuples(mesh->GetNumberOfCells());
  for (int n = 0; n < 3; ++n) {
    colors->FillComponent(n, std::round(255 * color[static_cast<std::size_t>(n)]));
  }
  mesh->GetCellData()->SetScalars(colors);
}

PolyData feature_edges_of(const PolyData& mesh) {
  // An STL's facets share no points; slivers become lines, which have no edges.
  vtkNew<vtkStaticCleanPolyData> clean;
  clean->SetInputData(mesh);
  vtkNew<vtkFeatureEdges> edges;
  edges->SetInputConnection(clean->GetOutputPort());
  edges->SetFeatureAngle(30);
  edges->NonManifoldEdgesOff();
  edges->ColoringOff();
  edges->Update();
  return edges->GetOutput();
}

PolyData discs_of(const Pshell& shell) {
  constexpr std::size_t kCorners = 10;
  const PshellView& view = shell.view();
  const PshellHeader& header = shell.header();
  const glm::dvec3 center_m(header.center_m[0], header.center_m[1], header.center_m[2]);
  const bool discs = view.point_count <= kMaxDiscs;
  std::vector<std::array<float, 3>> points;
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    const glm::dvec3 point = center_m + glm::dvec3(view.x[n], view.y[n], view.z[n]);
    if (!discs) {
      points.push_back(floats(point));
      continue;
    }
    const glm::dvec3 outward = -glm::dvec3(view.nx[n], view.ny[n], view.nz[n]);
    const glm::dvec3 u = across(outward), v = glm::cross(outward, u);
    for (std::size_t corner = 0; corner < kCorners; ++corner) {
      const double a = 2 * std::numbers::pi * static_cast<double>(corner) / kCorners;
      points.push_back(
          floats(point + 0.75 * header.covering_radius_m * (std::cos(a) * u + std::sin(a) * v)));
    }
  }
  auto data = PolyData::New();
  data->SetPoints(points_of(points));
  const auto identity = [](std::size_t n) { return n; };
  if (discs) {
    data->SetPolys(cells_of(view.point_count, kCorners, identity));
  } else {
    data->SetVerts(cells_of(view.point_count, 1, identity));
  }
  return data;
}

PolyData vectors_at(const std::vector<glm::dvec3>& places_m, const std::vector<glm::dvec3>& vectors,
                    const glm::dvec3& origin_m) {
  std::vector<std::array<float, 3>> points;
  vtkNew<vtkFloatArray> array;
  array->SetNumberOfComponents(3);
  for (std::size_t n = 0; n < places_m.size(); ++n) {
    points.push_back(floats(places_m[n] - origin_m));
    array->InsertNextTypedTuple(floats(vectors[n]).data());
  }
  auto data = PolyData::New();
  data->SetPoints(points_of(points));
  data->GetPointData()->SetVectors(array);
  return data;
}

PolyData places_and_line(const std::vector<glm::dvec3>& places_m, const glm::dvec3& origin_m) {
  std::vector<std::array<float, 3>> points;
  for (const glm::dvec3& place_m : places_m) points.push_back(floats(place_m - origin_m));
  auto data = PolyData::New();
  data->SetPoints(points_of(points));
  const auto identity = [](std::size_t n) { return n; };
  data->SetVerts(cells_of(points.size(), 1, identity));
  if (points.size() > 1) data->SetLines(cells_of(1, points.size(), identity));
  return data;
}

PolyData spring_between(const glm::dvec3& from_m, const glm::dvec3& to_m, double width_m,
                        const glm::dvec3& origin_m) {
  constexpr int kTurns = 8, kSteps = 16;
  const glm::dvec3 along = to_m - from_m;
  const double length_m = glm::length(along);
  std::vector<std::array<float, 3>> points;
  if (length_m > 0) {
    const glm::dvec3 u = across(along / length_m), v = glm::cross(along / length_m, u);
    for (int n = 0; n <= kTurns * kSteps; ++n) {
      const double fraction = static_cast<double>(n) / (kTurns * kSteps);
      const double a = 2 * std::numbers::pi * kTurns * fraction;
      const double radius_m = std::min({1.0, 10 * fraction, 10 * (1 - fraction)}) * width_m / 2;
      points.push_back(floats(from_m + fraction * along +
                              radius_m * (std::cos(a) * u + std::sin(a) * v) - origin_m));
    }
  }
  auto data = PolyData::New();
  data->SetPoints(points_of(points));
  const std::size_t segments = points.empty() ? 0 : points.size() - 1;
  data->SetLines(cells_of(segments, 2, [](std::size_t n) { return n / 2 + n % 2; }));
  return data;
}

}  // namespace forcelayer::viewer
