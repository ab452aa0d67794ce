// The instruction sets for which the kernels of query, field and model are compiled; included
// before Highway.
#pragma once

// The kernels hold vectors in arrays and structures, which vectors of unknown size cannot be in.
// Processors with SSSE3 and no SSE4 (Core 2 of 2006, Bobcat) run them without vectors.
// Builds with sanitizers disable more (scripts/cmake/forcelayer_target.cmake).
#ifndef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#endif
