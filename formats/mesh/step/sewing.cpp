#include "formats/mesh/step/sewing.h"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "formats/mesh/step/entities/faces.h"

namespace forcelayer::mesh {
namespace {

template <typename Visit>
void for_each_edge(const TopoDS_Shape& shape, const Visit& visit) {
  for (TopExp_Explorer edge(shape, TopAbs_EDGE); edge.More(); edge.Next()) {
    if (!BRep_Tool::Degenerated(TopoDS::Edge(edge.Current()))) {
      visit(edge.Current().TShape().get());
    }
  }
}

// The root of `i` among `parents`, each of which is at most its index.
std::size_t root_of(std::size_t i, std::vector<std::size_t>& parents) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

std::optional<SewnShape> sew_loose_faces(const TopoDS_Shape& shape, double tolerance_mm) {
  SewnShape sewn;
  BRepBuilderAPI_Sewing sewing(tolerance_mm);
  TopTools_MapOfShape seen;  // a damaged group may list a face twice
  for (TopExp_Explorer face(shape, TopAbs_FACE, TopAbs_SHELL); face.More(); face.Next()) {
    if (!seen.Add(face.Current())) continue;
    sewing.Add(face.Current());
    ++sewn.faces;
  }
  if (sewn.faces < 2) return {};
  try {
    sewing.Perform();
  } catch (const Standard_Failure&) {
    return {};  // loose they are read as well
  }
  const TopoDS_Shape joined = sewing.SewedShape();
  if (joined.IsNull() || sewing.NbContigousEdges() == 0 || count_faces(joined) != sewn.faces) {
    return {};
  }
  for (Standard_Integer n = 1; n <= sewing.NbContigousEdges(); ++n) {
    sewn.gap_mm = std::max(sewn.gap_mm, BRep_Tool::Tolerance(sewing.ContigousEdge(n)));
  }
  TopoDS_Compound whole;
  const BRep_Builder builder;
  builder.MakeCompound(whole);
  builder.Add(whole, joined);
  for (TopExp_Explorer shell(shape, TopAbs_SHELL); shell.More(); shell.Next()) {
    builder.Add(whole, shell.Current());
  }
  sewn.shape = whole;
  sewn.open_edges = count_open_edges(joined);
  return sewn;
}

std::uint64_t count_open_edges(const TopoDS_Shape& shape) {
  std::unordered_map<const TopoDS_TShape*, int> uses;
  for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
    for_each_edge(face.Current(), [&](const TopoDS_TShape* edge) { ++uses[edge]; });
  }
  return static_cast<std::uint64_t>(
      std::count_if(uses.begin(), uses.end(), [](const auto& use) { return use.second == 1; }));
}

std::uint64_t count_open_edges(const TopoDS_Shape& shape, double tolerance_mm) {
  const std::uint64_t count = count_open_edges(shape);
  if (count == 0) return 0;
  const auto sewn = sew_loose_faces(loose_faces_of({&shape, 1}), tolerance_mm);
  return sewn ? sewn->open_edges : count;
}

std::vector<std::size_t> first_met(std::span<const TopoDS_Shape> shapes, double tolerance_mm) {
  std::vector<std::size_t> parents(shapes.size());
  std::iota(parents.begin(), parents.end(), std::size_t{0});
  BRepBuilderAPI_Sewing sewing(tolerance_mm);
  for (const TopoDS_Shape& shape : shapes) {
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      sewing.Add(face.Current());
    }
  }
  try {
    sewing.Perform();
  } catch (const Standard_Failure&) {
    return parents;
  }
  std::unordered_map<const TopoDS_TShape*, std::size_t> owner_of_edge;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (TopExp_Explorer face(shapes[i], TopAbs_FACE); face.More(); face.Next()) {
      for_each_edge(sewing.ModifiedSubShape(face.Current()), [&](const TopoDS_TShape* edge) {
        const auto [known, is_new] = owner_of_edge.try_emplace(edge, i);
        if (is_new) return;
        const std::size_t a = root_of(i, parents), b = root_of(known->second, parents);
        parents[std::max(a, b)] = std::min(a, b);
      });
    }
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) parents[i] = root_of(i, parents);
  return parents;
}

TopoDS_Shape loose_faces_of(std::span<const TopoDS_Shape> shapes) {
  TopoDS_Compound all;
  const BRep_Builder builder;
  builder.MakeCompound(all);
  TopTools_MapOfShape seen;
  for (const TopoDS_Shape& shape : shapes) {
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      if (seen.Add(face.Current())) builder.Add(all, face.Current());
    }
  }
  return all;
}

}  // namespace forcelayer::mesh
