// Takes an assembly apart, round by round: every part that is still there is tried against all
// others that are still there, and those that come out leave. Straight motions come first, then two
// straight legs, then groups of parts that block each other only together.
//
// Each motion that is found is proven by the meshes (pair_proof.h). Nothing depends on the clock,
// but for a limit of time, nor on the number of threads.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "workbench/disassembly/blocking_graph.h"
#include "workbench/pairs/assembly_parts.h"

namespace forcelayer::disassembly {

// A part that the moved part overlaps where it is installed: allowed, and reported.
struct Overlap {
  std::size_t object = 0;
  double depth_m = 0;
};

// Parts that leave together.
struct Step {
  Parts parts;
  std::vector<PathRow> rows;  // world_from_installed
  std::string settled_by;     // "meshes, one straight leg"
  double length_m = 0;        // of the path
  // The object that the path comes nearest to, of those that the installed part does not touch;
  // none where no such object is left.
  std::optional<std::size_t> nearest;
  double distance_m = 0;   // from it, as measured
  double clearance_m = 0;  // a lower bound
  Parts touched;           // objects that the installed part touches
  Parts ignored;           // objects that a rule ignores, and whose boxes the path may meet
  std::vector<Overlap> overlaps;
  // How much deeper than installed the part may go into what it touches, because cracks of a mesh
  // hide it; 0 without cracks.
  double hidden_overlap_m = 0;
  // Where the parts are taken from: a group that came out together, which is taken apart outside.
  // Empty: the assembly.
  Parts from;
};

// A part that did not come out.
struct Left {
  std::size_t part = 0;
  std::string reason;
  Parts blocked_by;
};

struct Outcome {
  std::vector<Step> steps;
  std::vector<Left> left;
  std::optional<std::size_t> base;  // the last part, which nothing is left to be taken off
  bool is_out_of_time = false;      // or stopped by a signal: more may come apart
};

struct Request {
  double required_m = 0;                // clearance of pairs that no rule names
  Parts target;                         // parts that shall come out together; empty: all
  std::optional<double> max_s;          // seconds
  std::vector<pairs::Rule> rules = {};  // each pair of parts keeps its own, also in a group
};

struct Observer {
  // The steps of an earlier run that led on from these parts, in a whole round; none where none are
  // known.
  std::function<std::vector<Step>(const Parts& present)> recall;
  // Called with the steps of each round as it is done, and the parts that were there before. Where
  // `is_known`, recall() had them.
  std::function<void(const Parts& present, const std::vector<Step>& steps, bool is_known)> found;
  std::function<void(const std::string& stage, double fraction)> progress;
};

// Why a run ended before its time: "--time was over", or a signal (stop_signal()).
std::string end_text();

// The parts of `assembly` are two or more. Where command::stop_signal() is set, it ends as at the
// end of its time.
Outcome take_apart(const pairs::AssemblyParts& assembly, const Request& request,
                   const Observer& observer);

}  // namespace forcelayer::disassembly
