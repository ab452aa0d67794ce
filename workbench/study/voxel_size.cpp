#include "workbench/study/voxel_size.h"

#include <algorithm>
#include <cmath>

#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"
#include "formats/result.h"

namespace forcelayer::study {
namespace {

using command::kDecimalM;
using command::length_text;
using command::text;

constexpr double kPartVoxels = 100;   // across the part: its shape is felt
constexpr double kLookVoxels = 50;    // the same of the first look, at a quarter of the cost
constexpr double kSceneVoxels = 500;  // across the scene at the first look: less than a second
// So many voxels voxcheck looks around (kMaxCapVoxels of runtime/clearance/path_check.cpp, with its
// mend's reserve).
constexpr double kClearanceVoxels = 0.9 * 160;
constexpr double kContactM = 1e-6;      // a smaller gap is contact
constexpr double kFirstFraction = 0.1;  // of the time allowed, for the bakes of the first size
constexpr double kProgramBytes = 9e6;   // that a bake takes whatever its size
constexpr std::size_t kListed = 3;

// 1, 2 or 5 times a power of ten: the largest that is no more than this, to rounding.
double round_down_m(double length_m) {
  const double power = std::pow(10, std::floor(std::log10(length_m) + 1e-9));
  for (const double digit : {5.0, 2.0}) {
    if (digit * power <= length_m * (1 + 1e-9)) return digit * power;
  }
  return power;
}
double round_up_m(double length_m) {
  const double down_m = round_down_m(length_m);
  return down_m >= length_m * (1 - 1e-9) ? down_m : round_down_m(2.6 * down_m);
}

// The smallest voxel size whose cost is no more than allowed.
double size_for_m(double known_m, double cost, double allowed) {
  return known_m * std::sqrt(cost / std::max(allowed, 1e-9));
}

// A lower bound of voxel sizes, and the reason.
struct Bound {
  double size_m;
  std::string why;
};
Bound larger_of(std::initializer_list<Bound> bounds) {
  return *std::max_element(bounds.begin(), bounds.end(),
                           [](const Bound& a, const Bound& b) { return a.size_m < b.size_m; });
}

}  // namespace

SizeCost cost_at(const SizeCost& known, double voxel_size_m) {
  const double ratio = known.voxel_size_m / voxel_size_m, faces = ratio * ratio;
  const double bytes = std::max(0.0, known.bytes - kProgramBytes) * faces + kProgramBytes;
  return {voxel_size_m, known.fits_m / ratio, known.points * faces, bytes, known.thread_s * faces};
}

Play play_of(const nlohmann::json& report) {
  Play play;
  const auto objects = report.value("seat_depths", nlohmann::json::array());
  play.is_measured = report.contains("exact");
  for (const auto& violation : report.value("violations", nlohmann::json::array())) {
    play.is_whole &= !violation.value("out_of_time", false);
  }
  for (const auto& object : objects) {
    const std::string name = object.value("object", "");
    const std::string shown = object.value("shown_as", escaped(name));
    const double gap_m = object.value("gap_m", 0.0), overlap_m = object.value("installed_m", 0.0);
    if (overlap_m > 0 || gap_m <= kContactM) {
      play.touched.push_back(name);
      play.shown_touched.push_back(shown);
      play.overlap_m = std::max(play.overlap_m, overlap_m);
    } else if (gap_m < play.play_m) {
      play.play_m = gap_m;
      play.object = name;
      play.shown_object = shown;
    }
  }
  return play;
}

double look_size_m(double part_m, double scene_m, double required_m) {
  return round_up_m(std::max(
      {part_m / kLookVoxels, scene_m / kSceneVoxels, required_m / kClearanceVoxels, 1e-9}));
}

double smaller_size_m(double voxel_size_m) { return round_down_m(voxel_size_m / 1.9); }

std::string size_option(double voxel_size_m) { return text("%.6gmm", 1e3 * voxel_size_m); }

SizeChoice choose_size(const SizeQuestion& question, const SizeCost& look, const Play& play) {
  const double s = look.voxel_size_m;
  const std::string time = text("%.4g s", question.time_s);
  const double own_bytes = std::max(0.0, look.bytes - kProgramBytes);
  const Bound memory{size_for_m(s, own_bytes, question.memory_bytes / 2 - kProgramBytes),
                     "smaller voxels would take more than half of the memory"};
  const Bound clearance{
      question.required_m / kClearanceVoxels,
      "with smaller voxels the required clearance would have too many voxels to search"};
  const Bound fits{play.play_m * s / look.fits_m, "small enough for the smallest gap"};
  constexpr double kReserveVoxels = 4;  // voxcheck needs more than the overlap
  const Bound overlap{play.overlap_m / (kDeepestVoxels - kReserveVoxels),
                      "smaller voxels could not store how deep the part overlaps a neighbor"};
  const Bound part{question.part_m / kPartVoxels, "a hundredth of the part's size"};
  const Bound wish = fits.size_m < part.size_m ? fits : part;
  const Bound lowest = larger_of(
      {{size_for_m(s, look.thread_s, kFirstFraction * question.time_s),
        "with smaller voxels the bakes would take more than a tenth of the " + time + " allowed"},
       memory,
       clearance,
       overlap});
  const Bound limit =
      larger_of({{size_for_m(s, look.thread_s, question.time_s),
                  "with smaller voxels the bakes would take more than the " + time + " allowed"},
                 memory,
                 clearance,
                 overlap});
  SizeChoice choice;
  const double wish_m = round_down_m(wish.size_m), lowest_m = round_up_m(lowest.size_m);
  // No larger than those of the first look, which are there.
  choice.first_m = std::max(wish_m, std::min(lowest_m, s));
  choice.why_first = wish_m >= choice.first_m * (1 - 1e-9) ? wish.why : lowest.why;
  const double fits_m = std::isfinite(fits.size_m) ? round_down_m(fits.size_m) : 0;
  const double limit_m = round_up_m(limit.size_m);
  choice.last_m = std::min(choice.first_m, std::max(fits_m, limit_m));
  choice.why_last = fits_m >= limit_m ? fits.why : limit.why;
  return choice;
}

std::string play_text(const Play& play) {
  if (!play.is_measured) return "no gap was measured, because the meshes were not used";
  std::string touched;
  const std::vector<std::string>& names = play.shown_touched;
  for (std::size_t n = 0; n < names.size() && n <= kListed; ++n) {
    touched += n == kListed ? text(" and %zu more", names.size() - n)
                            : (n == 0 ? "in contact with " : ", ") + names[n];
  }
  const std::string others = !play.is_whole ? "not all gaps were measured in time"
                             : touched.empty()
                                 ? "no object is nearer than the required clearance"
                                 : "no other object is nearer than the required clearance";
  if (play.object.empty()) {
    return "when installed" + (touched.empty() ? ", " : ": " + touched + "; ") + others;
  }
  return "smallest gap " + std::string(play.is_whole ? "" : "measured ") +
         "when installed: " + length_text(play.play_m + kDecimalM) + ", to " + play.shown_object +
         (touched.empty() ? "" : "; " + touched) + (play.is_whole ? "" : "; " + others);
}

std::vector<SizeCost> sizes_of(const SizeChoice& choice, const SizeCost& look) {
  constexpr std::size_t kMax = 8;
  std::vector<SizeCost> sizes;
  for (double size_m = choice.first_m; sizes.size() < kMax && size_m >= choice.last_m * (1 - 1e-9);
       size_m = smaller_size_m(size_m)) {
    sizes.push_back(cost_at(look, size_m));
  }
  return sizes;
}

std::string table_of(const std::vector<SizeCost>& sizes) {
  std::string table = text("%10s %14s %10s %10s %14s\n", "voxel", "play needed", "points", "memory",
                           "time, 1 core");
  for (const SizeCost& size : sizes) {
    table += text("%7.4g mm %11.3g mm %10.0f %7.3g MB %12.2g s\n", 1e3 * size.voxel_size_m,
                  1e3 * size.fits_m, size.points, 1e-6 * size.bytes, size.thread_s);
  }
  // Without this line a reader takes a gap that is smaller than this column for a "no".
  return table +
         "play needed: in less play, voxels hold a simulated hand; meshes can still prove a path\n";
}

}  // namespace forcelayer::study
