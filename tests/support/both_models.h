// Tests that run once on `default`, which is what users get, and once on `paper`.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "forcelayer/parameters.h"

namespace forcelayer::test {

// Instantiate a derived fixture with INSTANTIATE_TEST_SUITE_P(Models, FIXTURE, kBothModels,
// name_of_model).
class BothModels : public testing::TestWithParam<Model> {};

inline const auto kBothModels = testing::Values(Model::kDefault, Model::kPaper);

inline std::string name_of_model(const testing::TestParamInfo<Model>& info) {
  return std::string(to_text(info.param));
}

}  // namespace forcelayer::test
