// Parameters from physics: every value that the user did not set follows from the voxel size, the
// shell, the rate and the device, by a rule that is written beside it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "forcelayer/device.h"
#include "forcelayer/parameters.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer {

struct ParameterRequest {
  Model model = Model::kPaper;
  ForceKind force = ForceKind::kTangentPlane;
  bool braking = true;
  double rate_hz = 1000;
  double motion_scale = 1;                 // scene metres a metre of the device
  std::map<std::string, double> settings;  // by ParameterInfo::name
};

struct DerivedParameters {
  Parameters values;
  std::map<std::string, std::string> reasons;  // by name: the rule, or "set"
  std::vector<std::string> warnings;           // settings beyond a bound, which names its source
};

// Errors: kUsage for a setting that is not finite and positive (limits may be infinite).
Result<DerivedParameters> derive_parameters(const ParameterRequest& request, const Voxmap& voxmap,
                                            const Pshell& shell, const DeviceCapabilities& device);

// Largest |r x n| over the shell's points, m: the arm with which a contact force can turn the part
// about its centroid.
double largest_contact_arm_m(const Pshell& shell);

}  // namespace forcelayer
