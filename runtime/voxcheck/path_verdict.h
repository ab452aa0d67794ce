// The verdict of a check along a path, for voxcheck and voxplan.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "formats/command/verdict/verdict.h"
#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/clearance/path_check.h"
#include "runtime/clearance/path_length.h"
#include "runtime/voxcheck/exact_exchange.h"

namespace forcelayer::voxcheck {

// A path that was checked.
struct CheckedPath {
  const Voxmap& scene;
  const Pshell& part;
  std::span<const PathRow> rows;
  const clearance::CenterPath& path;
  const clearance::PathLength& length;
  const clearance::CheckResult& result;
  const ExactAnswer* exact;  // of --exact: its violations are those of `result`; else null
  double required_m;
};

// How far along the path the part is at that time, m.
double along_m(const CheckedPath& checked, double time_s);

// The measurement by the meshes of a violation of `checked`; null without --exact, and where the
// meshes cannot settle it.
const ExactViolation* exact_of(const CheckedPath& checked, const clearance::Violation& violation);

// The measurement of a stretch in the seat; null without --exact, and where no object counts.
const ExactMoment* exact_in_seat(const CheckedPath& checked, std::size_t stretch);

// The violation that the verdict is about: a collision before a distance, that before what is open.
// There must be one.
const clearance::Violation& worst_of(const CheckedPath& checked);

// "straight along +z", or where a path ends that turns; empty where the part does not move.
std::string motion_text(std::span<const PathRow> rows, const Pshell& part);

// "at x 94.64, y 39.86, z 51.52 mm"
std::string place_text(const glm::dvec3& point_m);

// The moment of which the sentence of a verdict speaks, where the path is clear; and its
// measurement, null without --exact.
struct ToldMoment {
  clearance::CheckedMoment moment;
  const ExactMoment* exact = nullptr;
};
ToldMoment told_moment(const CheckedPath& checked);

// The verdict, without advice and notes.
command::Verdict verdict_of(const CheckedPath& checked);

// The object with a closed surface all around the part, and the words for that.
std::optional<std::uint32_t> enclosing_object(const CheckedPath& checked);
inline constexpr char kEnclosed[] = "the part is enclosed on all sides";

// Adds the objects that the installed part overlaps for certain to a verdict that is yes.
void add_overlaps(const Voxmap& scene, const ExactAnswer& exact, command::Verdict& verdict);

// A violation as one line: from where to where, what, and where it is worst.
std::string violation_text(const CheckedPath& checked, const clearance::Violation& violation);

// Bounds and places for people who want to know more, a line each: of the least distance, and of
// each stretch in the seat.
std::vector<std::string> bounds_texts(const CheckedPath& checked);

// `clearance_m`: proven for more than this moment, where it is of more.
nlohmann::ordered_json moment_json(const CheckedPath& checked,
                                   const clearance::CheckedMoment& moment, double clearance_m);

// A stretch in seconds, and along the path.
nlohmann::ordered_json stretch_json(const CheckedPath& checked, double from_s, double to_s);

// A stretch in the seat.
nlohmann::ordered_json seated_json(const CheckedPath& checked,
                                   const clearance::SeatedStretch& stretch);

}  // namespace forcelayer::voxcheck
