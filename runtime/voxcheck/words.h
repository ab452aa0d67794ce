// The words and keys for a proof along a path that all who report one have in common.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/clearance/path_check.h"

namespace forcelayer::voxcheck {

// Between meshes that are known exactly, nothing but rounding is allowed: less than this.
inline constexpr double kRoundingM = 1e-6;

// In millimeters, rounded up.
double ceil_mm(double length_m);

// " to NAME"; empty for object 0.
std::string to_object(const Voxmap& scene, std::uint32_t object);

// The first five names, and how many more there are.
std::string listed_names(const Voxmap& scene, std::span<const std::uint32_t> objects);

// Whether all along a way without a seat the part is farther from the scene than it is across: it
// may be of another scene, or in another unit. Where objects are allowed that is no news.
bool is_never_near(const clearance::CheckResult& result, const Pshell& part,
                   std::span<const std::string> allow);

// The warning of that; `given` is the path, or what else says where the part is.
std::string never_near_text(const char* given);

// How near to an object that does not count, in the seat or by `allow`, others may be hidden from
// the files (front.h); 0 where all count, or there is no other.
double hidden_within_m(const Voxmap& scene, const clearance::CheckResult& result,
                       std::span<const std::string> allow);

// Words that say so.
std::string hidden_text(double within_m);

}  // namespace forcelayer::voxcheck
