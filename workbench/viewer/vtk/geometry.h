// Plain data as VTK's geometry.
#pragma once

#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <glm/vec3.hpp>
#include <vector>

#include "formats/pshell.h"
#include "workbench/viewer/plan/style.h"
#include "workbench/viewer/plan/view_scene.h"
#include "workbench/viewer/run/contact_view.h"
#include "workbench/viewer/surface/quad_surface.h"

namespace forcelayer::viewer {

using PolyData = vtkSmartPointer<vtkPolyData>;

PolyData poly_data_of(const ViewMesh& mesh);
// The rectangles of one direction (QuadSurface::directions).
PolyData poly_data_of(const QuadSurface& surface, int direction);

// Gives every cell of a mesh this color.
void color_cells(const PolyData& mesh, const Color& color);

// Edges where a mesh turns by more than 30 degrees or ends.
PolyData feature_edges_of(const PolyData& mesh);

// A disc per shell point, in its tangent plane, of the covering radius, in the part's frame: a
// surface to look at where there is no mesh. Beyond kMaxDiscs points: bare points.
inline constexpr std::uint64_t kMaxDiscs = 60000;
PolyData discs_of(const Pshell& shell);

// Points at `places_m` less origin_m, each carrying a vector for glyphs.
PolyData vectors_at(const std::vector<glm::dvec3>& places_m, const std::vector<glm::dvec3>& vectors,
                    const glm::dvec3& origin_m);

// A point at each place less origin_m, and a line through all of them.
PolyData places_and_line(const std::vector<glm::dvec3>& places_m, const glm::dvec3& origin_m);

// A coil from `from_m` to `to_m`, as a spring is drawn.
PolyData spring_between(const glm::dvec3& from_m, const glm::dvec3& to_m, double width_m,
                        const glm::dvec3& origin_m);

}  // namespace forcelayer::viewer
