#include "workbench/viewer/vtk/section.h"

#include <vtkCellArray.h>
#include <vtkContourTriangulator.h>
#include <vtkCutter.h>
#include <vtkIdList.h>
#include <vtkNew.h>

#include <numeric>
#include <vector>

namespace forcelayer::viewer {
namespace {

// Points that lines join, however far, have one root.
class Joined {
 public:
  explicit Joined(std::size_t points) : parents_(points) {
    std::iota(parents_.begin(), parents_.end(), vtkIdType{0});
  }
  vtkIdType root(vtkIdType n) {
    while (at(n) != n) n = at(n) = at(at(n));
    return n;
  }
  void join(vtkIdType a, vtkIdType b) { at(root(a)) = root(b); }

 private:
  vtkIdType& at(vtkIdType n) { return parents_[static_cast<std::size_t>(n)]; }
  std::vector<vtkIdType> parents_;
};

// The lines that come back to where they began: at each of their points as many end as begin.
vtkSmartPointer<vtkCellArray> closed_lines(vtkPolyData* cut) {
  const auto points = static_cast<std::size_t>(cut->GetNumberOfPoints());
  Joined joined(points);
  std::vector<int> ends(points, 0);  // lines that begin here less those that end
  vtkNew<vtkIdList> line;
  vtkCellArray* const lines = cut->GetLines();
  const auto is_line = [&] {
    return line->GetNumberOfIds() == 2 && line->GetId(0) != line->GetId(1);
  };
  for (lines->InitTraversal(); lines->GetNextCell(line) != 0;) {
    if (!is_line()) continue;
    ++ends[static_cast<std::size_t>(line->GetId(0))];
    --ends[static_cast<std::size_t>(line->GetId(1))];
    joined.join(line->GetId(0), line->GetId(1));
  }
  std::vector<char> is_open(points, 0);  // [roots]
  for (std::size_t n = 0; n < points; ++n) {
    if (ends[n] != 0) is_open[static_cast<std::size_t>(joined.root(static_cast<vtkIdType>(n)))] = 1;
  }
  auto closed = vtkSmartPointer<vtkCellArray>::New();
  for (lines->InitTraversal(); lines->GetNextCell(line) != 0;) {
    if (!is_line()) continue;
    if (is_open[static_cast<std::size_t>(joined.root(line->GetId(0)))] == 0) {
      closed->InsertNextCell(line);
    }
  }
  return closed;
}

}  // namespace

Section section_of(const PolyData& mesh, vtkPlane* plane) {
  vtkNew<vtkCutter> cutter;
  cutter->SetInputData(mesh);
  cutter->SetCutFunction(plane);
  cutter->GenerateCutScalarsOff();
  cutter->Update();
  Section section{PolyData::New(), PolyData::New()};
  section.outline->SetPoints(cutter->GetOutput()->GetPoints());
  section.outline->SetLines(closed_lines(cutter->GetOutput()));
  if (section.outline->GetNumberOfLines() == 0) return {PolyData::New(), PolyData::New()};
  vtkNew<vtkContourTriangulator> fill;
  fill->SetInputData(section.outline);
  fill->TriangulationErrorDisplayOff();
  fill->Update();
  section.faces->ShallowCopy(fill->GetOutput());
  return section;
}

}  // namespace forcelayer::viewer
