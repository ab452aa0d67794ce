// Counts what a program calls of the runtime. The linker puts these functions before the ones of
// the same names (-Wl,--wrap), so the programs that are counted are made of the same objects as
// those that run and are timed: voxrun_counted beside voxrun, query_bench_counted beside
// query_bench. At the end the counts are appended to the file FORCELAYER_CALLS names, one line
// each:
//
//   STEP <tab> CALL <tab> TIMES
//
// STEP is the model's step in which the call was made: default, paper or none. CALL says how a
// query looks for which points in which kind of map, or which field measures in which kind of map.
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <sstream>
#include <string>

#include "forcelayer/step.h"
#include "runtime/field/force_field.h"
#include "runtime/guard/pose_guard.h"
#include "runtime/model/default_model.h"
#include "runtime/model/paper_model.h"
#include "runtime/query/contact_query.h"

namespace forcelayer {
namespace {

const char* g_step = "none";

class Counts {
 public:
  ~Counts() {
    const char* const path = std::getenv("FORCELAYER_CALLS");
    std::FILE* const file = path != nullptr ? std::fopen(path, "a") : nullptr;
    if (file == nullptr) return;
    for (const auto& [call, times] : times_) std::fprintf(file, "%s\t%llu\n", call.c_str(), times);
    std::fclose(file);
  }
  void count(const std::string& call) { ++times_[g_step + ("\t" + call)]; }

  std::map<const query::ContactQuery*, std::string> queries;

 private:
  std::map<std::string, unsigned long long> times_;
};

Counts& counts() {
  static Counts counts;
  return counts;
}

std::string kind_of(const Voxmap& voxmap) {
  const VoxmapHeader& header = voxmap.header();
  std::ostringstream text;
  text << (header.metric == static_cast<std::uint32_t>(Metric::kEuclidean) ? "Euclidean"
                                                                           : "Chebyshev")
       << " map of " << header.offset_layers << " layers, "
       << (voxmap.distances() != nullptr ? "with" : "without") << " distances";
  return text.str();
}

std::string said(const query::QueryOptions& options) {
  std::ostringstream text;
  text << "skips by clearance " << options.skip.clearance << " super-blocks "
       << options.skip.super_blocks << " coherence " << options.skip.coherence << " walls "
       << options.skip.walls << ", vectors " << options.vector << " (" << query::kernel_target()
       << "), threads " << options.threads;
  return text.str();
}

class CountedField final : public field::ForceField {
 public:
  CountedField(std::unique_ptr<field::ForceField> field, std::string call)
      : field_(std::move(field)), call_(std::move(call)) {}
  void measure(const query::CollectedPoints& points,
               field::FieldSamples& samples) const noexcept override {
    counts().count(call_);
    field_->measure(points, samples);
  }
  bool proves_distances() const noexcept override { return field_->proves_distances(); }
  bool has_exact_slopes() const noexcept override { return field_->has_exact_slopes(); }

 private:
  std::unique_ptr<field::ForceField> field_;
  std::string call_;
};

// For the time of a step.
class InStep {
 public:
  explicit InStep(const char* step) : before_(g_step) {
    g_step = step;
    counts().count("step");
  }
  InStep(const InStep&) = delete;
  ~InStep() { g_step = before_; }

 private:
  const char* before_;
};

}  // namespace
}  // namespace forcelayer

using namespace forcelayer;

// Declares the function as it is, real_NAME, and begins the one that stands before it. A member
// takes its object as first parameter.
#define FORCELAYER_WRAP(symbol, result, name, ...)              \
  result real_##name(__VA_ARGS__) __asm__("__real_" symbol);    \
  result name##_counted(__VA_ARGS__) __asm__("__wrap_" symbol); \
  result name##_counted(__VA_ARGS__)

FORCELAYER_WRAP(FORCELAYER_QUERY_MAKER, void, query, query::ContactQuery* query,
                const Voxmap& voxmap, const Pshell& shell, const query::QueryOptions& options) {
  real_query(query, voxmap, shell, options);
  counts().queries[query] = "query: " + kind_of(voxmap) + ", " + said(options);
}

FORCELAYER_WRAP(FORCELAYER_QUERY_RUN, void, run, query::ContactQuery* query, const Pose& pose,
                query::CollectedPoints& out) {
  counts().count(counts().queries.at(query));
  real_run(query, pose, out);
}

FORCELAYER_WRAP(FORCELAYER_MAKE_FIELD, Result<std::unique_ptr<field::ForceField>>, field,
                Model model, ForceKind kind, const Voxmap& voxmap) {
  auto field = real_field(model, kind, voxmap);
  if (!field) return field;
  constexpr const char* kNames[] = {"tangent plane", "level field", "distance field"};
  const std::string call = std::string("measure: ") + kNames[kind == ForceKind::kTangentPlane ? 0
                                                             : kind == ForceKind::kLevel      ? 1
                                                                                              : 2];
  return std::unique_ptr<field::ForceField>(
      std::make_unique<CountedField>(std::move(*field), call + " of a " + kind_of(voxmap)));
}

FORCELAYER_WRAP(FORCELAYER_AVERAGE, void, average, const query::CollectedPoints& points,
                const field::FieldSamples& samples, float voxel_size_m, float min_depth_m,
                field::ContactSet& set) {
  counts().count("directions averaged");
  real_average(points, samples, voxel_size_m, min_depth_m, set);
}

FORCELAYER_WRAP(FORCELAYER_DEFAULT_STEP, StepResult, default_step, model::DefaultModel* model,
                State& state, const StepInput& input, double dt_s) {
  const InStep step("default");
  return real_default_step(model, state, input, dt_s);
}

FORCELAYER_WRAP(FORCELAYER_PAPER_STEP, StepResult, paper_step, const model::StepContext& context,
                State& state, const StepInput& input, double dt_s) {
  const InStep step("paper");
  return real_paper_step(context, state, input, dt_s);
}
