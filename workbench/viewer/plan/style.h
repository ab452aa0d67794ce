// Colors and their names in the legend. Told apart by brightness and shape too, not by hue alone;
// hues from the color-blind-safe set of Okabe and Ito.
#pragma once

#include <array>

namespace forcelayer::viewer {

using Color = std::array<double, 3>;  // red, green, blue, 0 to 1

inline constexpr Color kBackground = {1.0, 1.0, 1.0};
inline constexpr Color kInk = {0.13, 0.15, 0.18};
inline constexpr Color kSceneColor = {0.78, 0.79, 0.80};
inline constexpr Color kEdgeColor = {0.35, 0.37, 0.40};
inline constexpr Color kForceLayerColor = {0.34, 0.71, 0.91};
inline constexpr Color kInteriorColor = {0.62, 0.64, 0.66};
inline constexpr Color kProximityColor = {0.94, 0.89, 0.26};
inline constexpr Color kPartColor = {0.90, 0.62, 0.0};
inline constexpr Color kContactColor = {0.70, 0.08, 0.05};
inline constexpr Color kPenetrationColor = {0.55, 0.0, 0.55};
inline constexpr Color kGhostColor = {0.0, 0.45, 0.70};
inline constexpr Color kNetForceColor = {0.05, 0.05, 0.05};
inline constexpr Color kMeasuredColor = {0.0, 0.45, 0.70};
inline constexpr Color kMissingFaceColor = {0.84, 0.37, 0.0};
inline constexpr Color kMeasureColor = {0.0, 0.62, 0.45};
inline constexpr Color kPathColor = {0.0, 0.62, 0.45};
inline constexpr Color kClearanceColor = {0.80, 0.30, 0.56};
inline constexpr Color kAddedColor = {0.0, 0.45, 0.70};
inline constexpr Color kRemovedColor = {0.84, 0.37, 0.0};

// Towards the light, in the camera's axes: to the right, up, towards the eye. It falls from above
// the eye's left shoulder.
inline constexpr std::array<double, 3> kToLight = {-0.2, 0.35, 0.915};

inline constexpr double kOthersOpacity = 0.25;  // of objects beside one that is measured
// The part must not hide what it meets.
inline constexpr double kMeasuredPartOpacity = 0.4;
inline constexpr double kForceLayerOpacity = 0.28;
inline constexpr double kProximityOpacity = 0.12;
inline constexpr double kUnchangedOpacity = 0.08;  // of the force layer where changes are shown

}  // namespace forcelayer::viewer
