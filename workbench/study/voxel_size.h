// --voxel-size auto: the size that a study begins with, and how far it refines.
//
// The answer on a path is measured between the meshes, so voxels do not change it. They
// decide which paths a simulated hand and a search find, and how far apart STEP surfaces and their
// triangles lie. So a size is good where the part passes its gaps in contact, and smaller ones are
// tried only where an answer is left open.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace forcelayer::study {

// A bake at one voxel size, by the forecasts of voxelize and pointshell.
struct SizeCost {
  double voxel_size_m = 0;
  double fits_m = 0;    // the smallest play in which the part slides in contact
  double points = 0;    // of the shell
  double bytes = 0;     // of memory, at the peak
  double thread_s = 0;  // of both bakes, on one core
};
// The same at another size: surfaces outweigh all else.
SizeCost cost_at(const SizeCost& known, double voxel_size_m);

// For a part that overlaps a neighbor, distances are stored this many voxels deep.
inline constexpr double kDeepestVoxels = 32;

// The part as installed.
struct Play {
  double play_m = std::numeric_limits<double>::infinity();  // the smallest that is not contact
  std::string object;                                       // to which; empty: none is that near
  std::vector<std::string> touched;                         // objects without any
  double overlap_m = 0;                                     // with one of these, at most
  bool is_measured = true;                                  // between the meshes
  bool is_whole = true;                                     // all were, before the time ended
  std::string shown_object = {};                            // both as sentences show them
  std::vector<std::string> shown_touched = {};
};
// By a report of voxcheck --exact for the installed pose.
Play play_of(const nlohmann::json& report);

struct SizeQuestion {
  double part_m = 0;      // the part's longest side
  double required_m = 0;  // of clearance
  double time_s = 0;      // that is allowed
  double memory_bytes = 0;
};

// A size for a first look, which measures the play: a coarse one, from the sizes of the files.
double look_size_m(double part_m, double scene_m, double required_m);

struct SizeChoice {
  double first_m = 0, last_m = 0;  // of voxels: to begin with, and the smallest that are tried
  std::string why_first, why_last;
};
// The first is no larger than the look's, unless the part is so large.
SizeChoice choose_size(const SizeQuestion& question, const SizeCost& look, const Play& play);

// 1, 2 or 5 times a power of ten: the next one below.
double smaller_size_m(double voxel_size_m);

// "0.2mm", as an option takes it.
std::string size_option(double voxel_size_m);

// "smallest measured gap: 0.098 mm, to plate".
std::string play_text(const Play& play);

// A table of the sizes from the first to the last.
std::vector<SizeCost> sizes_of(const SizeChoice& choice, const SizeCost& look);
std::string table_of(const std::vector<SizeCost>& sizes);

}  // namespace forcelayer::study
