#include "tests/bench/force_bench_fit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/model/contact_force.h"
#include "tests/bench/bench_report.h"

namespace forcelayer::bench {
namespace {

constexpr std::size_t kOffsets = 121;
// Torque over force, in radii of the part, below which the true torque is nothing to compare with.
constexpr double kLeastArm = 0.2;

double median(std::vector<double> values) { return percentiles(std::move(values)).p50; }

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
  const double lengths = glm::length(a) * glm::length(b);
  if (!(lengths > 0)) return 90;
  return std::acos(std::clamp(glm::dot(a, b) / lengths, -1.0, 1.0)) * 180 / M_PI;
}

// The offset that suits the mean forces best, once with and once without a free stiffness.
struct Fit {
  double offset_m = 0, free_offset_m = 0, stiffness = 0;
};

Fit fitted(const std::vector<glm::dvec3>& mean, const TruthAt& truth_at,
           const std::vector<double>& offsets_m) {
  Fit fit;
  double best = 1e300, best_free = 1e300;
  for (const double at : offsets_m) {
    double mm = 0, mt = 0, tt = 0;
    for (std::size_t d = 0; d < mean.size(); ++d) {
      const glm::dvec3 t = truth_at(d, at).force_n;
      mm += glm::dot(mean[d], mean[d]), mt += glm::dot(mean[d], t), tt += glm::dot(t, t);
    }
    if (mm - 2 * mt + tt < best) best = mm - 2 * mt + tt, fit.offset_m = at;
    if (tt > 0 && mm - mt * mt / tt < best_free) {
      best_free = mm - mt * mt / tt, fit.stiffness = mt / tt, fit.free_offset_m = at;
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
    const bool has_torque = torque2 > true2 * std::pow(kLeastArm * part_radius_m, 2);
    return has_torque ? std::sqrt(torque_error2 / torque2) : NAN;
  }
};

// The errors of force and torque, with offset and gain fitted and without.
void judge_errors(const Measured& measured, const std::vector<glm::dvec3>& mean, const Fit& fit,
                  const TruthAt& truth_at, const Nominal& nominal, double part_radius_m,
                  Quality& q) {
  Left fitted, raw, pressing, touching;
  double deviation2 = 0;
  for (std::size_t d = 0; d < measured.size(); ++d) {
    const Wrench t = truth_at(d, fit.free_offset_m), plain = truth_at(d, nominal.offset_m);
    const glm::dvec3 f = fit.stiffness * t.force_n, m = fit.stiffness * t.torque_nm;
    fitted.add(measured[d], f, m);
    raw.add(measured[d], plain.force_n, plain.torque_nm);
    if (nominal.depths_m[d] >= nominal.pressing_m) {
      pressing.add(measured[d], f, m);
    } else if (nominal.depths_m[d] > 0) {
      touching.add(measured[d], f, m);
    }
    deviation2 += static_cast<double>(measured[d].size()) * glm::dot(mean[d] - f, mean[d] - f);
  }
  q.force_error = fitted.force_error();
  q.deviation = fitted.true2 > 0 ? std::sqrt(deviation2 / fitted.true2) : 1;
  q.torque_error = fitted.torque_error(part_radius_m);
  q.raw_error = raw.force_error();
  q.raw_torque_error = raw.torque_error(part_radius_m);
  q.pressing_error = pressing.force_error();
  q.touching_error = touching.force_error();
}

}  // namespace

TruthTable::TruthTable(const std::vector<SurfaceSample>& samples, double first, double last)
    : first_m(first), step_m((last - first) / (kOffsets - 1)) {
  // Per bin of distance: sum of area * direction, and of that times the distance.
  std::vector<Wrench> plain(kOffsets), by_distance(kOffsets);
  area.assign(kOffsets, 0);
  std::vector<double> area_by_distance(kOffsets);
  for (const SurfaceSample& sample : samples) {
    const double bin = std::max(0.0, std::ceil((sample.distance_m - first_m) / step_m));
    if (bin >= kOffsets) continue;
    const auto b = static_cast<std::size_t>(bin);
    const glm::dvec3 f = sample.area * sample.direction;
    const glm::dvec3 t = glm::cross(sample.arm_m, f);
    plain[b].force_n += f, plain[b].torque_nm += t;
    by_distance[b].force_n += sample.distance_m * f;
    by_distance[b].torque_nm += sample.distance_m * t;
    area[b] += sample.area, area_by_distance[b] += sample.area * sample.distance_m;
  }
  Wrench a, b;
  for (std::size_t o = 0; o < kOffsets; ++o) {
    a.force_n += plain[o].force_n, a.torque_nm += plain[o].torque_nm;
    b.force_n += by_distance[o].force_n, b.torque_nm += by_distance[o].torque_nm;
    if (o > 0) area[o] += area[o - 1], area_by_distance[o] += area_by_distance[o - 1];
    const double offset = first_m + static_cast<double>(o) * step_m;
    area_depth.push_back(offset * area[o] - area_by_distance[o]);
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

double TruthTable::between(const std::vector<double>& of, double offset_m) const {
  const double x = entry_of(offset_m);
  const auto i = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(i);
  return of[i] * (1 - f) + of[i + 1] * f;
}

double TruthTable::area_at(double offset_m) const { return between(area, offset_m); }

double TruthTable::sharing_area_at(double offset_m, double full_m) const {
  return (between(area_depth, offset_m) - between(area_depth, offset_m - full_m)) / full_m;
}

Wrench shared_truth(const TruthTable& table, double offset_m, Shared shared, double voxel_size_m) {
  constexpr double kFullDepthVoxels = 0.125;  // of the default model (contact_force.h)
  double share = 1;
  if (shared == Shared::kByTen) share = 10 / std::max(10.0, table.area_at(offset_m));
  if (shared == Shared::kAsDefault) {
    model::ContactTotals totals;
    totals.sharing = table.sharing_area_at(offset_m, kFullDepthVoxels * voxel_size_m);
    share = model::LoadSharing(totals).average();
  }
  const Wrench w = table.wrench_at(offset_m);
  return {share * w.force_n, share * w.torque_nm};
}

Quality judged(const Measured& measured, const TruthAt& truth_at, const Nominal& nominal,
               const std::vector<double>& offsets_m, double part_radius_m) {
  Quality q{};
  q.step = NAN;
  std::vector<glm::dvec3> mean;
  for (const std::vector<Wrench>& at_depth : measured) {
    glm::dvec3 sum(0);
    for (const Wrench& w : at_depth) sum += w.force_n / static_cast<double>(at_depth.size());
    mean.push_back(sum);
  }
  const Fit fit = fitted(mean, truth_at, offsets_m);
  q.stiffness = fit.stiffness;
  judge_errors(measured, mean, fit, truth_at, nominal, part_radius_m, q);
  double true2 = 0, bias2 = 0, noise2 = 0, most = 0;
  for (std::size_t d = 0; d < measured.size(); ++d) {
    const double length = glm::length(truth_at(d, fit.offset_m).force_n);
    const double error = glm::length(mean[d]) - length;
    true2 += length * length, bias2 += error * error, most = std::max(most, length);
    for (const Wrench& w : measured[d]) {
      const double spread = glm::length(w.force_n) - glm::length(mean[d]);
      noise2 += spread * spread / static_cast<double>(measured[d].size());
    }
  }
  q.bias = std::sqrt(bias2 / true2), q.noise = std::sqrt(noise2 / true2);
  std::vector<double> direction, torque;
  for (std::size_t d = 0; d < measured.size(); ++d) {
    const Wrench t = truth_at(d, fit.offset_m);
    const double length = glm::length(t.force_n);
    if (length < 0.1 * most) continue;  // too little force to have a direction
    for (const Wrench& w : measured[d]) {
      direction.push_back(degrees_between(w.force_n, t.force_n));
      const double f = glm::length(w.force_n);
      if (!(f > 0)) continue;
      torque.push_back(glm::length(w.torque_nm / f - t.torque_nm / length) / part_radius_m);
    }
  }
  q.direction_deg = median(direction), q.torque = median(torque);
  return q;
}

}  // namespace forcelayer::bench
