#include "forcelayer/parameters.h"

#include <algorithm>
#include <iterator>

namespace forcelayer {
namespace {

template <typename T>
struct Named {
  T value;
  std::string_view name;
};

constexpr Named<Model> kModels[] = {{Model::kPaper, "paper"}, {Model::kDefault, "default"}};
constexpr Named<ForceKind> kForces[] = {{ForceKind::kTangentPlane, "tangent-plane"},
                                        {ForceKind::kLevel, "level"},
                                        {ForceKind::kDistance, "distance"}};

template <typename T, std::size_t kCount>
std::string_view name_of(const Named<T> (&names)[kCount], T value) {
  const auto* at = std::find_if(std::begin(names), std::end(names),
                                [&](const Named<T>& n) { return n.value == value; });
  return at == std::end(names) ? std::string_view() : at->name;
}

template <typename T, std::size_t kCount>
std::optional<T> value_of(const Named<T> (&names)[kCount], std::string_view name) {
  const auto* at = std::find_if(std::begin(names), std::end(names),
                                [&](const Named<T>& n) { return n.name == name; });
  return at == std::end(names) ? std::nullopt : std::optional<T>(at->value);
}

}  // namespace

std::string_view to_text(Model model) { return name_of(kModels, model); }
std::string_view to_text(ForceKind force) { return name_of(kForces, force); }
std::optional<Model> parse_model(std::string_view name) { return value_of(kModels, name); }
std::optional<ForceKind> parse_force(std::string_view name) { return value_of(kForces, name); }
bool is_known_model(std::uint32_t number) { return !to_text(static_cast<Model>(number)).empty(); }
bool is_known_force(std::uint32_t number) {
  return !to_text(static_cast<ForceKind>(number)).empty();
}

}  // namespace forcelayer
