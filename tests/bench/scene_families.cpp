#include "tests/bench/scene_families.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "tests/support/places.h"

namespace forcelayer::bench {

FamilyChoice::FamilyChoice() : models(test::source_path("../shared/models")) {}

void add_options(CLI::App& app, const char* count, FamilyChoice& choice) {
  app.add_option("--family", choice.only, "\"generated\", \"pump on bay\", ... (default: all)");
  app.add_option(count, choice.wanted, "of all families together")->check(CLI::PositiveNumber);
  app.add_option("--models", choice.models, "folder of the models");
}

void judge_families(const FamilyChoice& choice, const JudgeScene& judge) {
  const auto families = stress::clearance_families();
  const double each = (1 - choice.generated_share) / static_cast<double>(families.size() - 1);
  for (const stress::ClearanceFamily& family : families) {
    const std::string name(family.name), needs(family.needs);
    if (!choice.only.empty() && std::ranges::find(choice.only, name) == choice.only.end()) continue;
    if (!needs.empty() && !std::filesystem::exists(std::filesystem::path(choice.models) / needs)) {
      std::printf("%s left out: no %s\n", name.c_str(), needs.c_str());
      continue;
    }
    const double share = family.group == "generated" ? choice.generated_share : each;
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(choice.wanted));
    std::size_t judged = 0;
    for (std::uint64_t seed = 1; judged < wanted; ++seed) judged += judge(family, seed);
  }
}

}  // namespace forcelayer::bench
