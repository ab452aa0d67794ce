#include "formats/mesh/step/entities/faces.h"

#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Iterator.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <unordered_set>

namespace forcelayer::mesh {
namespace {

using ShapeSet = std::unordered_set<const TopoDS_TShape*>;

// Looks at each shape once, however often it is placed.
void add_faces(const TopoDS_Shape& shape, ShapeSet& seen, ShapeSet& faces) {
  if (shape.IsNull() || !seen.insert(shape.TShape().get()).second) return;
  if (shape.ShapeType() == TopAbs_FACE) {
    faces.insert(shape.TShape().get());
    return;
  }
  for (TopoDS_Iterator part(shape); part.More(); part.Next()) add_faces(part.Value(), seen, faces);
}

std::string text_of(const Losses& losses) {
  constexpr std::size_t kMaxNames = 5;
  std::string text = losses.count > 0 ? std::to_string(losses.names.size()) + " of " +
                                            counted(losses.count, losses.kind)
                                      : counted(losses.names.size(), losses.kind);
  for (std::size_t i = 0; i < losses.names.size() && i < kMaxNames; ++i) {
    text += (i == 0 ? ": " : ", ") + losses.names[i];
  }
  if (losses.names.size() > kMaxNames) {
    text += " and " + std::to_string(losses.names.size() - kMaxNames) + " more";
  }
  return text;
}

}  // namespace

std::string entry_of(const TDF_Label& label) {
  TCollection_AsciiString entry;
  TDF_Tool::Entry(label, entry);
  return entry.ToCString();
}

DocumentFaces::DocumentFaces(const Handle(TDocStd_Document) & document) {
  TDF_LabelSequence roots;
  XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(roots);
  ShapeSet seen;
  for (TDF_LabelSequence::Iterator root(roots); root.More(); root.Next()) {
    ShapeSet faces;
    add_faces(XCAFDoc_ShapeTool::GetShape(root.Value()), seen, faces);
    for (const TopoDS_TShape* face : faces) faces_.try_emplace(face, entry_of(root.Value()));
  }
}

std::set<std::string> DocumentFaces::owners_of(const TopoDS_Shape& shape) const {
  std::set<std::string> owners;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    const auto found = faces_.find(face.Current().TShape().get());
    if (found != faces_.end()) owners.insert(found->second);
  }
  return owners;
}

bool DocumentFaces::has(const TopoDS_Shape& shape) const {
  if (shape.IsNull()) return false;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    if (faces_.contains(face.Current().TShape().get())) return true;
  }
  return false;
}

bool contains_face_of(const TopoDS_Shape& whole, const TopoDS_Shape& part) {
  ShapeSet seen, faces;
  add_faces(whole, seen, faces);
  if (part.IsNull()) return false;
  for (TopExp_Explorer face(part, TopAbs_FACE); face.More(); face.Next()) {
    if (faces.contains(face.Current().TShape().get())) return true;
  }
  return false;
}

std::uint64_t count_faces(const TopoDS_Shape& shape) {
  std::uint64_t count = 0;
  if (shape.IsNull()) return count;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) ++count;
  return count;
}

std::string text_of(const std::vector<Losses>& all) {
  std::string text;
  for (const Losses& losses : all) {
    if (!losses.names.empty()) text += (text.empty() ? "" : "; ") + text_of(losses);
  }
  return text;
}

}  // namespace forcelayer::mesh
