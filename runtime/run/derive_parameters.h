// Parameters from physics: every value that the user did not set follows from the voxel size, the
// shell, the rate and the device, by a rule that is written beside it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "forcelayer/run.h"

namespace forcelayer {

struct DerivedParameters {
  Parameters values;
  std::map<std::string, std::string> reasons;  // by name: the rule, or "set"
  std::vector<std::string> warnings;           // settings beyond a bound, which names its source
};

// Errors: kUsage for a setting out of its range (parameter_table()), or of no parameter.
// The files of the request are not read: `voxmap` and `shell` are.
Result<DerivedParameters> derive_parameters(const RunRequest& request, const Voxmap& voxmap,
                                            const Pshell& shell);

// Largest |r x n| over the shell's points, m: the arm with which a contact force can turn the part
// about its centroid.
double largest_contact_arm_m(const Pshell& shell);

// A warning where the paper's coupling, which acts at the centroid, is stiffer against turning than
// the device can render: a handle at an arm of `arm_m` from it feels k_R + k_T L^2. The default
// model's acts at the grip, and no arm makes it stiffer.
std::optional<std::string> arm_warning(const RunRequest& request, const Parameters& parameters,
                                       double arm_m);

}  // namespace forcelayer
