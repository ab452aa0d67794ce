// Objects of a scene by the names that a user types and reads.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/clearance/front.h"

namespace forcelayer::voxcheck {

// The object's name in the file, with "[1]" where it is the first of several of that name; "object
// N" where that is empty; empty for object 0.
std::string object_name(const Voxmap& scene, std::uint32_t object);

// All of them, in the order of their numbers.
std::vector<std::string> object_names(const Voxmap& scene);

// As a sentence shows the object: the end of its name, by which --allow knows it, too. Empty for
// object 0.
std::string shown_name(const Voxmap& scene, std::uint32_t object);

// Whether `pattern` matches the whole `name`, or all of it behind one of its slashes. `*` stands
// for any number of characters but "/", `?` for one.
bool fits(std::string_view name, std::string_view pattern);

// The objects that the patterns name; "A[1]" is "A" where nothing else is called so. Errors: kUsage
// for a pattern that names none.
Result<clearance::LeftOut> named_objects(const Voxmap& scene,
                                         std::span<const std::string> patterns);

}  // namespace forcelayer::voxcheck
