// The triangles that a STEP file of AP242 holds in place of exact surfaces (ISO 10303-42,
// tessellated geometry). OpenCASCADE 7.6 does not know these entities.
#pragma once

#include <Standard_Transient.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <XSControl_WorkSession.hxx>
#include <vector>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {

// A tessellated solid, shell, face or surface set.
struct TriangleItem {
  Handle(StepBasic_ProductDefinition) product;
  Mesh mesh;                                         // frame of the product, millimeters
  std::vector<Handle(Standard_Transient)> entities;  // of the file, that it was read from
};

// Reads the tessellated items of a file that was read and not yet transferred; not those that stand
// for an exact face or solid of the file, and none that it does not understand whole. Puts an empty
// shape representation in the place of each tessellated one, so that its product gets a label.
std::vector<TriangleItem> take_triangles(const Handle(XSControl_WorkSession) & session);

// The types of an entity that OpenCASCADE does not know: one, or those of a complex entity. Empty
// for one that it knows.
std::vector<std::string> unknown_types(const Handle(Standard_Transient) & entity);

}  // namespace forcelayer::mesh
