// Bodies that a STEP file hides.
#pragma once

#include <Interface_InterfaceModel.hxx>
#include <cstdint>

namespace forcelayer::mesh {

// Solids, surface models, mapped items and shapes that the model says are invisible.
std::uint64_t count_hidden_bodies(const Handle(Interface_InterfaceModel) & model);

}  // namespace forcelayer::mesh
