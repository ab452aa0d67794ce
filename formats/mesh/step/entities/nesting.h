// How often the products of a STEP or IGES file are placed, before OpenCASCADE visits each.
#pragma once

#include <Interface_InterfaceModel.hxx>

namespace forcelayer::mesh {

// The placed products, groups and mapped shapes of all levels together. Of those that hold
// themselves none count.
double count_placings(const Handle(Interface_InterfaceModel) & model);

}  // namespace forcelayer::mesh
