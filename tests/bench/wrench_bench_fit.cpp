#include "tests/bench/wrench_bench_fit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace forcelayer::bench {
namespace {

constexpr std::size_t kOffsets = 121;
// Torque over force, in radii of the part, below which the true torque is nothing to compare with.
constexpr double kMinArm = 0.2;

// The offset and the gain that suit the mean forces best.
struct Fit {
  double offset_m = 0, gain = 0;
};

Fit fitted(const std::vector<glm::dvec3>& mean, const TruthAt& truth_at,
           const std::vector<double>& offsets_m) {
  Fit fit;
  double best = 1e300;
  for (const double at : offsets_m) {
    double mm = 0, mt = 0, tt = 0;
    for (std::size_t d = 0; d < mean.size(); ++d) {
      const glm::dvec3 t = truth_at(d, at).force_n;
      mm += glm::dot(mean[d], mean[d]), mt += glm::dot(mean[d], t), tt += glm::dot(t, t);
    }
    if (tt > 0 && mm - mt * mt / tt < best) {
      best = mm - mt * mt / tt;
      fit = {at, mt / tt};
    }
  }
  return fit;
}

// Sums over poses of what is left of a wrench, and of the true one.
struct Left {
  double error2 = 0, true2 = 0, torque_error2 = 0, torque2 = 0;

  void add(const std::vector<Wrench>& measured, const glm::dvec3& force, const glm::dvec3& torque) {
    for (const Wrench& w : measured) {
      error2 += glm::dot(w.force_n - force, w.force_n - force), true2 += glm::dot(force, force);
      torque_error2 += glm::dot(w.torque_nm - torque, w.torque_nm - torque);
      torque2 += glm::dot(torque, torque);
    }
  }
  // Where nothing is felt and something is there, all of it is error.
  double force_error() const { return true2 > 0 ? std::sqrt(error2 / true2) : 1; }
  double torque_error(double part_radius_m) const {
    const bool has_torque = torque2 > true2 * std::pow(kMinArm * part_radius_m, 2);
    return has_torque ? std::sqrt(torque_error2 / torque2) : NAN;
  }
};

}  // namespace

TruthTable::TruthTable(const std::vector<SurfaceSample>& samples, double first, double last)
    : first_m(first), step_m((last - first) / (kOffsets - 1)) {
  // Per bin of distance: sum of area * direction, and of that times the distance.
  std::vector<Wrench> plain(kOffsets), by_distance(kOffsets);
  area.assign(kOffsets, 0);
  for (const SurfaceSample& sample : samples) {
    const double bin = std::max(0.0, std::ceil((sample.distance_m - first_m) / step_m));
    if (bin >= kOffsets) continue;
    const auto b = static_cast<std::size_t>(bin);
    const glm::dvec3 f = sample.area * sample.direction;
    const glm::dvec3 t = glm::cross(sample.arm_m, f);
    plain[b].force_n += f, plain[b].torque_nm += t;
    by_distance[b].force_n += sample.distance_m * f;
    by_distance[b].torque_nm += sample.distance_m * t;
    area[b] += sample.area;
  }
  Wrench a, b;
  for (std::size_t o = 0; o < kOffsets; ++o) {
    a.force_n += plain[o].force_n, a.torque_nm += plain[o].torque_nm;
    b.force_n += by_distance[o].force_n, b.torque_nm += by_distance[o].torque_nm;
    if (o > 0) area[o] += area[o - 1];
    const double offset = first_m + static_cast<double>(o) * step_m;
    wrench.push_back({offset * a.force_n - b.force_n, offset * a.torque_nm - b.torque_nm});
  }
}

double TruthTable::entry_of(double offset_m) const {
  return std::clamp((offset_m - first_m) / step_m, 0.0, static_cast<double>(kOffsets) - 1.001);
}

Wrench TruthTable::wrench_at(double offset_m) const {
  const double x = entry_of(offset_m);
  const auto i = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(i);
  return {wrench[i].force_n * (1 - f) + wrench[i + 1].force_n * f,
          wrench[i].torque_nm * (1 - f) + wrench[i + 1].torque_nm * f};
}

double TruthTable::area_at(double offset_m) const {
  const double x = entry_of(offset_m);
  const auto i = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(i);
  return area[i] * (1 - f) + area[i + 1] * f;
}

Wrench true_wrench_at(const TruthTable& table, double offset_m, LoadOfTruth load) {
  const double points = load == LoadOfTruth::kByTen ? table.area_at(offset_m) : 0;
  const double fraction = 10 / std::max(10.0, points);
  const Wrench w = table.wrench_at(offset_m);
  return {fraction * w.force_n, fraction * w.torque_nm};
}

Quality judged(const Measured& measured, const TruthAt& truth_at, const Nominal& nominal,
               const std::vector<double>& offsets_m, double part_radius_m) {
  std::vector<glm::dvec3> mean;
  for (const std::vector<Wrench>& at_depth : measured) {
    glm::dvec3 sum(0);
    for (const Wrench& w : at_depth) sum += w.force_n / static_cast<double>(at_depth.size());
    mean.push_back(sum);
  }
  const Fit fit = fitted(mean, truth_at, offsets_m);
  Left fitted, raw, touching;
  for (std::size_t d = 0; d < measured.size(); ++d) {
    const Wrench t = truth_at(d, fit.offset_m), plain = truth_at(d, nominal.offset_m);
    const glm::dvec3 f = fit.gain * t.force_n, m = fit.gain * t.torque_nm;
    fitted.add(measured[d], f, m);
    raw.add(measured[d], plain.force_n, plain.torque_nm);
    const double depth_m = nominal.depths_m[d];
    if (depth_m > 0 && depth_m < nominal.pressing_m) touching.add(measured[d], f, m);
  }
  return {fitted.force_error(), fitted.torque_error(part_radius_m), raw.force_error(),
          touching.force_error()};
}

}  // namespace forcelayer::bench
