#include "formats/mesh/step/face_report.h"

#include <algorithm>
#include <cstdio>

namespace forcelayer::mesh {
namespace {

// In deflections: a gap between edges and faces that is told. The coarsest deflection that is tried
// is as large.
constexpr double kNotableGap = 4;

std::string length_text(double length_mm) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g mm", length_mm);
  return text;
}

std::string place_text(const MissingFace& face) {
  if (face.size == 0) return face.node + ", a face without edges, whose place is unknown";
  char place[160];
  std::snprintf(place, sizeof place, " at (%.6g, %.6g, %.6g) mm, ", face.center[0], face.center[1],
                face.center[2]);
  return face.node + place + length_text(face.size) + " across";
}

}  // namespace

void add_face_warnings(const Tessellation& tessellation, const std::string& path,
                       std::vector<std::string>& warnings) {
  if (tessellation.dropped > 0) {
    warnings.push_back(path + ": " + counted(tessellation.dropped, "face") +
                       " thinner than the deflection left out: no point of " +
                       (tessellation.dropped == 1 ? "it" : "them") + " is farther than " +
                       length_text(tessellation.dropped_reach_mm) + " from the faces beside them");
  }
  if (tessellation.sewn > 0) {
    warnings.push_back(
        path + ": " + counted(tessellation.sewn, "loose face") + " sewn where edges are within " +
        length_text(tessellation.sewing_tolerance_mm) +
        " of each other; the joined edges lie up to " + length_text(tessellation.sewn_gap_mm) +
        " from their faces, and the guarantee is less by it" +
        (tessellation.sewn_gap_mm > kNotableGap * tessellation.wanted_deflection_mm
             ? "; look whether an edge is damaged"
             : ""));
  }
  if (tessellation.edge_gap_mm > kNotableGap * tessellation.wanted_deflection_mm) {
    warnings.push_back(path + ": an edge lies up to " + length_text(tessellation.edge_gap_mm) +
                       " from its faces: the triangles deviate as much, and the guarantee is less "
                       "by it; look whether the edge is damaged");
  }
  if (tessellation.healed > 0) {
    warnings.push_back(path + ": " + counted(tessellation.healed, "face") +
                       " mended by OpenCASCADE (ShapeFix) to get triangles");
  }
  if (tessellation.deflection_mm != tessellation.wanted_deflection_mm) {
    warnings.push_back(path + ": tessellated to " + length_text(tessellation.deflection_mm) +
                       ", because faces fail at " + length_text(tessellation.wanted_deflection_mm));
  }
}

void check_missing_faces(const SourceFile& file, const std::vector<std::string>& unknown_nodes,
                         Assembly& assembly) {
  constexpr std::size_t kListed = 4;
  const std::vector<MissingFace>& missing = assembly.missing_faces;
  if (missing.size() <= file.options.missing_faces) {
    for (const MissingFace& face : missing) {
      assembly.warnings.push_back("a face is missing, and no guarantee covers it: " +
                                  place_text(face));
    }
    return;
  }
  std::string places;
  for (std::size_t i = 0; i < std::min(missing.size(), kListed); ++i) {
    places += (i == 0 ? "" : "; ") + place_text(missing[i]);
  }
  if (missing.size() > kListed) places += "; ...";
  std::string mend =
      "mend them where the part was drawn, leave their node out with --without, or accept "
      "the holes with --missing-faces " +
      std::to_string(missing.size());
  for (const std::string& name : unknown_nodes) {
    mend += "; no node of this file is called " + in_quotes(name);
  }
  fail_read(file, ErrorCode::kMeshIncomplete, "",
            "OpenCASCADE could not tessellate " + counted(missing.size(), "face") + ": " + places,
            std::move(mend));
}

}  // namespace forcelayer::mesh
