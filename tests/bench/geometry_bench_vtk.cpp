#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkGenericCell.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>
#include <vtkVoxelModeller.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/bench/bench_report.h"
#include "tests/bench/geometry_bench_voxels.h"

namespace forcelayer::bench {
namespace {

vtkNew<vtkPolyData> poly_data(const mesh::Mesh& mesh) {
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (const mesh::Vec3d& v : mesh.vertices) points->InsertNextPoint(v.data());
  vtkNew<vtkCellArray> cells;
  for (const mesh::Triangle& t : mesh.triangles) cells->InsertNextCell({t[0], t[1], t[2]});
  vtkNew<vtkPolyData> data;
  data->SetPoints(points);
  data->SetPolys(cells);
  return data;
}

}  // namespace

VoxelRun vtk_voxels(const mesh::Mesh& mesh) {
  const vtkNew<vtkPolyData> data = poly_data(mesh);
  std::array<double, 6> bounds{};
  data->GetBounds(bounds.data());
  std::array<int, 3> low{}, dims{};
  int longest = 0;
  for (int d = 0; d < 3; ++d) {
    low[d] = static_cast<int>(std::floor(bounds[2 * d])) - 1;
    dims[d] = static_cast<int>(std::floor(bounds[2 * d + 1])) + 2 - low[d];
    longest = std::max(longest, dims[d] - 1);
    bounds[2 * d] = low[d] + 0.5;  // it samples from one bound to the other: at voxel centers
    bounds[2 * d + 1] = low[d] + dims[d] - 0.5;
  }
  vtkNew<vtkVoxelModeller> modeller;
  modeller->SetInputData(data);
  modeller->SetSampleDimensions(dims.data());
  modeller->SetModelBounds(bounds.data());
  modeller->SetMaximumDistance(0.5 / longest);  // of the longest side: half a voxel
  modeller->SetScalarTypeToUnsignedChar();
  modeller->SetForegroundValue(1);
  modeller->SetBackgroundValue(0);
  VoxelRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  modeller->Update();
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.peak_rss_bytes = peak_rss_bytes();
  vtkDataArray* const values = modeller->GetOutput()->GetPointData()->GetScalars();
  vtkIdType at = 0;
  for (int z = 0; z < dims[2]; ++z) {
    for (int y = 0; y < dims[1]; ++y) {
      for (int x = 0; x < dims[0]; ++x) {
        if (values->GetTuple1(at++) > 0) run.voxels.push_back({low[0] + x, low[1] + y, low[2] + z});
      }
    }
  }
  return run;
}

std::vector<double> vtk_distances(const mesh::Mesh& mesh, const std::vector<mesh::Vec3d>& points) {
  const vtkNew<vtkPolyData> data = poly_data(mesh);
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(data);
  locator->BuildLocator();
  vtkNew<vtkGenericCell> cell;
  std::vector<double> distances;
  for (const mesh::Vec3d& point : points) {
    mesh::Vec3d closest{};
    vtkIdType id = 0;
    int sub_id = 0;
    double squared = 0;
    locator->FindClosestPoint(point.data(), closest.data(), cell, id, sub_id, squared);
    distances.push_back(std::sqrt(squared));
  }
  return distances;
}

}  // namespace forcelayer::bench
