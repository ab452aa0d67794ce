// The boundaries of trimmed (144) and bounded (143) surfaces of an IGES file.
#pragma once

#include <IGESData_IGESEntity.hxx>
#include <IGESData_IGESModel.hxx>
#include <cstdint>
#include <vector>

namespace forcelayer::mesh {

// Whether it is such a surface, and a boundary of it is none, lies on another surface, or has a
// curve that is none, has a parameter that makes no sense, or is that of another boundary:
// OpenCASCADE trims the surface by something else then, without an error. A boundary that names no
// surface lies on this one.
bool is_badly_trimmed(const Handle(IGESData_IGESModel) & model,
                      const Handle(IGESData_IGESEntity) & entity);

// All that a face or boundary refers to, as far as it could be read: the graph of the file lacks it
// where a parameter of the entity makes no sense.
std::vector<Handle(IGESData_IGESEntity)> parts_of_trimmed(const Handle(IGESData_IGESEntity) &
                                                          entity);

// Takes the boundaries out of such a surface: OpenCASCADE makes no face of it then, whatever lists
// it.
void empty_trims(const Handle(IGESData_IGESEntity) & entity);

// How many boundaries it has; 0 for other entities.
std::uint64_t count_boundaries(const Handle(IGESData_IGESEntity) & entity);

}  // namespace forcelayer::mesh
