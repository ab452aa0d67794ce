// The lines about the faces of a STEP or IGES file that were not tessellated as they are.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/mesh/step/entities/lost_pieces.h"
#include "formats/mesh/step/tessellator.h"

namespace forcelayer::mesh {

// A face without triangles, or a piece of the file that OpenCASCADE did not read.
struct MissingPiece {
  MissingFace face;       // millimeters; no node where nobody knows to which it belongs
  std::string name;       // of the entity, for a piece
  bool has_edges = true;  // LostFace::has_edges
};

// Appends what was dropped, mended or tessellated otherwise at the node of this path.
void add_face_warnings(const Tessellation& tessellation, const std::string& path,
                       std::vector<std::string>& warnings);

// Notes and warns of every missing piece of `assembly`, whose unit is the millimeter and of which
// `nodes` have triangles. Throws kMeshIncomplete where they are more than the options accept, with
// `losses`, which the named pieces are, the number of the other faces, node and place of the first
// ones, and a way out that leaves a face. `unknown_nodes`: the names of ReadOptions::without that
// no node has.
void check_missing_faces(const SourceFile& file, const FileLosses& losses,
                         const std::vector<std::string>& unknown_nodes,
                         std::span<const MissingPiece> missing, std::size_t nodes,
                         Assembly& assembly);

}  // namespace forcelayer::mesh
