// The JSON report of a bake and the provenance that its file holds.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pointshell/bake.h"
#include "pointshell/cost.h"
#include "pointshell/part/part.h"

namespace forcelayer::pointshell {

// A hash of the part's vertices and triangles in meters, 16 hexadecimal digits. Files that hold the
// same triangles in any order have the same hash.
std::string part_hash(const part::Part& part);

// The content hash and the options that affect the shell, as JSON.
std::string provenance(const part::Part& part, const ShellOptions& options);

const char* method_name(ShellMethod method);
const char* effort_name(sample::Effort effort);

// The shell's points over planar_bound() for this area: 1 is a perfect covering.
double points_over_bound(const PshellHeader& header, double area_m2);

// Says before it starts that a bake takes more than a minute or a gigabyte; else empty.
std::string cost_warning(const BakeCost& cost, const ShellOptions& options, const part::Part& part);

// The warning about the part's open sheets, all of them, or that its surface is open where a
// solid's is closed; empty where neither is.
std::string sheet_warning(const BakedShell& shell);

nlohmann::ordered_json bake_report(const BakedShell& shell, const ShellOptions& options,
                                   const part::Part& part);

}  // namespace forcelayer::pointshell
