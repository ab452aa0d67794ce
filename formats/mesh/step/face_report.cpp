#include "formats/mesh/step/face_report.h"

#include <algorithm>
#include <cstdio>

namespace forcelayer::mesh {
namespace {

// In deflections: a gap between edges and faces that is reported. The coarsest deflection that is
// tried is as large.
constexpr double kNotableGap = 4;
constexpr double kFinestMm = 1e-3;  // shorter bounds are reported as this

std::string length_text(double length_mm) {
  char text[40];
  std::snprintf(text, sizeof text, "%.3g mm", length_mm);
  return text;
}

std::string place_text(const MissingPiece& piece) {
  const MissingFace& face = piece.face;
  const std::string node = face.node.empty() ? "an unknown node" : face.node;
  if (face.size == 0) return node + " at an unknown position";
  char place[160];
  std::snprintf(place, sizeof place, " at (%.6g, %.6g, %.6g) mm, ", face.center[0], face.center[1],
                face.center[2]);
  return node +
         (piece.has_edges      ? ""
          : piece.name.empty() ? ", a face without edges, somewhere in the region"
                               : ", somewhere in the region") +
         place + length_text(face.size) + " across";
}

// The first of them, each place once.
std::string places_text(std::span<const MissingPiece> missing) {
  constexpr std::size_t kListed = 4;
  std::vector<std::string> places;
  for (const MissingPiece& piece : missing) {
    std::string place = place_text(piece);
    if (std::find(places.begin(), places.end(), place) == places.end()) {
      places.push_back(places.size() < kListed ? std::move(place) : "...");
    }
    if (places.size() > kListed) break;
  }
  std::string text;
  for (const std::string& place : places) text += (text.empty() ? "" : "; ") + place;
  return text;
}

std::string remedy(std::string mend, std::span<const MissingPiece> missing,
                   const std::vector<std::string>& unknown_nodes, std::size_t nodes) {
  if (nodes == 0) return mend + "; the file has no other face";
  if (nodes > 1) mend += ", leave out the node of these faces with --without";
  mend += ", or accept the holes with --missing-faces " + std::to_string(missing.size());
  for (const std::string& name : unknown_nodes) {
    mend += "; no node of this file is called " + in_quotes(name);
  }
  return mend;
}

}  // namespace

void add_face_warnings(const Tessellation& tessellation, const std::string& path,
                       std::vector<std::string>& warnings) {
  if (tessellation.dropped > 0) {
    warnings.push_back(
        path + ": " + counted(tessellation.dropped, "face") +
        (tessellation.dropped == 1
             ? " is left out, because it is too thin for triangles. All its points are within "
             : " are left out, because they are too thin for triangles. All their points are "
               "within ") +
        length_text(tessellation.dropped_reach_mm) + " of the neighboring faces");
  }
  if (tessellation.sewn > 0) {
    const std::string gap = length_text(std::max(tessellation.sewn_gap_mm, kFinestMm));
    warnings.push_back(path + ": " + counted(tessellation.sewn, "loose face") +
                       (tessellation.sewn == 1 ? " is" : " are") + " joined at edges within " +
                       length_text(tessellation.sewing_tolerance_mm) +
                       " of each other. These edges lie up to " + gap +
                       " from their faces, so the guaranteed distance is " + gap + " smaller" +
                       (tessellation.open_edges > 0
                            ? ". " + counted(tessellation.open_edges, "other edge") +
                                  (tessellation.open_edges == 1 ? " is" : " are") + " not joined"
                            : "") +
                       (tessellation.sewn_gap_mm > kNotableGap * tessellation.wanted_deflection_mm
                            ? "; check whether an edge is damaged"
                            : ""));
  }
  if (tessellation.edge_gap_mm > kNotableGap * tessellation.wanted_deflection_mm) {
    const std::string gap = length_text(tessellation.edge_gap_mm);
    warnings.push_back(path + ": an edge lies up to " + gap +
                       " from its faces, so the guaranteed distance is " + gap +
                       " smaller; check whether the edge is damaged");
  }
  if (tessellation.surface_gap_mm > kNotableGap * tessellation.wanted_deflection_mm) {
    const std::string gap = length_text(tessellation.surface_gap_mm);
    warnings.push_back(
        path + ": the triangles of a surface lie up to " + gap +
        " from this surface (allowed: " + length_text(tessellation.wanted_deflection_mm) +
        "), so the guaranteed distance is " + gap + " smaller");
  }
  if (tessellation.deflection_mm != tessellation.wanted_deflection_mm) {
    warnings.push_back(path + ": the deflection is " + length_text(tessellation.deflection_mm) +
                       ", because some faces cannot be tessellated with " +
                       length_text(tessellation.wanted_deflection_mm));
  }
}

void check_missing_faces(const SourceFile& file, const FileLosses& losses,
                         const std::vector<std::string>& unknown_nodes,
                         std::span<const MissingPiece> missing, std::size_t nodes,
                         Assembly& assembly) {
  if (missing.size() > file.options.missing_faces) {
    const auto failed = static_cast<std::uint64_t>(
        std::count_if(missing.begin(), missing.end(),
                      [](const MissingPiece& piece) { return piece.name.empty(); }));
    const bool is_read = losses.text.empty();
    const std::string untessellated =
        failed > 0 ? "could not tessellate " + counted(failed, "face") : "";
    fail_read(
        file, ErrorCode::kMeshIncomplete, is_read ? "" : missing.front().face.node,
        "OpenCASCADE " + (is_read ? untessellated + ": " + places_text(missing)
                                  : "could not read " + losses.text + (failed > 0 ? ", and " : "") +
                                        untessellated + " (" + places_text(missing) + ")"),
        remedy(is_read ? "repair these faces in the CAD system" : losses.mend, missing,
               unknown_nodes, nodes));
  }
  for (const MissingPiece& piece : missing) {
    assembly.missing_faces.push_back(piece.face);
    assembly.warnings.push_back((piece.name.empty() ? "a face" : piece.name) +
                                " is missing, and no guarantee covers it: " + place_text(piece));
  }
}

}  // namespace forcelayer::mesh
