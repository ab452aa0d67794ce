// The words of --version about STEP and IGES.
#pragma once

namespace forcelayer::mesh {

#ifdef FORCELAYER_STEP
inline constexpr const char* kStepSupport = "reads STEP and IGES";
#else
inline constexpr const char* kStepSupport = "without STEP and IGES";
#endif

}  // namespace forcelayer::mesh
