// The faces that the document of a STEP or IGES file holds, and what of a file has no shape there.
#pragma once

#include <TDF_Label.hxx>
#include <TDocStd_Document.hxx>
#include <TopoDS_Shape.hxx>
#include <TopoDS_TShape.hxx>
#include <cstdint>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// The place of a label in its document.
std::string entry_of(const TDF_Label& label);

class DocumentFaces {
 public:
  explicit DocumentFaces(const Handle(TDocStd_Document) & document);

  // Whether a face of `shape` is in the document.
  bool has(const TopoDS_Shape& shape) const;

  // entry_of() the free shapes that have faces of `shape`.
  std::set<std::string> owners_of(const TopoDS_Shape& shape) const;

 private:
  std::unordered_map<const TopoDS_TShape*, std::string> faces_;  // with the first that has it
};

std::uint64_t count_faces(const TopoDS_Shape& shape);

// Whether a face of `part` is one of `whole`, wherever it is placed.
bool contains_face_of(const TopoDS_Shape& whole, const TopoDS_Shape& part);

// The lost entities of one kind: "2 of 6 faces: #45 ADVANCED_FACE 'left', #77 ADVANCED_FACE".
struct Losses {
  const char* kind;                // in the singular
  std::uint64_t count = 0;         // in the file; 0 where only the lost ones are counted
  std::vector<std::string> names;  // of those that are lost
};

// "2 of 6 faces: #45 ADVANCED_FACE 'left', #77 ADVANCED_FACE; 1 solid: ..."; "" where nothing is
// lost.
std::string text_of(const std::vector<Losses>& all);

}  // namespace forcelayer::mesh
