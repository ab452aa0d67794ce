#include "formats/mesh/step/entities/dimensions.h"

#include <Interface_Check.hxx>
#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_Axis1Placement.hxx>
#include <StepGeom_Axis2Placement3d.hxx>
#include <StepGeom_CartesianPoint.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Direction.hxx>
#include <StepGeom_Pcurve.hxx>
#include <StepGeom_Surface.hxx>
#include <StepRepr_DefinitionalRepresentation.hxx>
#include <StepShape_SolidModel.hxx>
#include <StepShape_TopologicalRepresentationItem.hxx>
#include <StepVisual_CoordinatesList.hxx>
#include <cctype>
#include <charconv>
#include <vector>

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);
using EntitySet = std::unordered_set<const Standard_Transient*>;

constexpr int kInSpace = 3;

bool is_in_space(const Entity& entity) {
  for (const Handle(Standard_Type) & type :
       {STANDARD_TYPE(StepShape_TopologicalRepresentationItem), STANDARD_TYPE(StepGeom_Surface),
        STANDARD_TYPE(StepGeom_Axis2Placement3d), STANDARD_TYPE(StepGeom_Axis1Placement),
        STANDARD_TYPE(StepGeom_CartesianTransformationOperator3d),
        STANDARD_TYPE(StepShape_SolidModel)}) {
    if (entity->IsKind(type)) return true;
  }
  return false;
}

bool is_in_parameters(const Entity& entity) {
  return entity->IsKind(STANDARD_TYPE(StepGeom_Pcurve)) ||
         entity->IsKind(STANDARD_TYPE(StepRepr_DefinitionalRepresentation));
}

// All that geometry in space refers to, but for curves in the parameters of a surface.
EntitySet in_space(const Handle(StepData_StepModel) & model, const Interface_Graph& graph) {
  EntitySet found;
  std::vector<Entity> open;
  const auto add = [&](const Entity& entity) {
    if (!is_in_parameters(entity) && found.insert(entity.get()).second) open.push_back(entity);
  };
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    if (is_in_space(model->Value(i))) add(model->Value(i));
  }
  while (!open.empty()) {
    const Entity entity = open.back();
    open.pop_back();
    Interface_EntityIterator part = graph.Shareds(entity);
    for (part.Start(); part.More(); part.Next()) add(part.Value());
  }
  return found;
}

bool has_too_many(const Handle(StepData_StepModel) & model, Standard_Integer number) {
  const Handle(Interface_Check) check = model->Check(number, Standard_True);
  for (Standard_Integer i = 1; i <= check->NbWarnings(); ++i) {
    if (std::string_view(check->CWarning(i, Standard_True)).find("More than 3") !=
        std::string_view::npos) {
      return true;
    }
  }
  return false;
}

// Walks over the text of a STEP file, past comments, and finds lists of coordinates in which a
// point has not three of them. OpenCASCADE does not keep how many there were.
class CoordinateLists {
 public:
  explicit CoordinateLists(std::string_view text) : text_(text) {}

  // The numbers of their entities.
  std::unordered_set<int> flawed() {
    constexpr std::string_view kType = "COORDINATES_LIST";
    std::unordered_set<int> found;
    for (at_ = 0; (at_ = text_.find(kType, at_)) != std::string_view::npos;) {
      const int number = number_before(at_);
      at_ += kType.size();
      if (number > 0 && has_flaw()) found.insert(number);
    }
    return found;
  }

 private:
  // 45 of "#45 = " before `place`; 0 where that stands before it not.
  int number_before(std::size_t place) const {
    const auto skip_spaces = [&] {
      while (place > 0 && std::isspace(static_cast<unsigned char>(text_[place - 1]))) --place;
    };
    skip_spaces();
    if (place == 0 || text_[--place] != '=') return 0;
    skip_spaces();
    const std::size_t end = place;
    while (place > 0 && std::isdigit(static_cast<unsigned char>(text_[place - 1]))) --place;
    int number = 0;
    if (place == 0 || text_[place - 1] != '#') return 0;
    std::from_chars(text_.data() + place, text_.data() + end, number);
    return number;
  }

  // Whether a point of the list that begins here has other than three coordinates. Points are lists
  // in a list in the parameters.
  bool has_flaw() {
    constexpr int kPoint = 3;
    int depth = 0, commas = 0;
    bool is_empty = true;
    for (; at_ < text_.size(); ++at_) {
      const char letter = text_[at_];
      if (letter == '\'') {
        at_ = text_.find('\'', at_ + 1);
      } else if (text_.substr(at_, 2) == "/*") {
        at_ = text_.find("*/", at_ + 2);
      } else if (letter == '(') {
        if (++depth == kPoint) commas = 0, is_empty = true;
      } else if (letter == ')') {
        if (depth-- == kPoint && (is_empty || commas != kInSpace - 1)) return true;
      } else if (letter == ',') {
        ++commas;
      } else if (letter == ';') {
        return false;
      } else if (!std::isspace(static_cast<unsigned char>(letter))) {
        is_empty = false;
      }
      if (at_ == std::string_view::npos) break;
    }
    at_ = text_.size();
    return false;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

EntitySet entities_without_three_numbers(const Handle(XSControl_WorkSession) & session,
                                         std::string_view text) {
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  const EntitySet space = in_space(model, session->Graph());
  const std::unordered_set<int> lists = CoordinateLists(text).flawed();
  EntitySet flawed;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Entity& entity = model->Value(i);
    const auto point = Handle(StepGeom_CartesianPoint)::DownCast(entity);
    const auto direction = Handle(StepGeom_Direction)::DownCast(entity);
    bool has_flaw = false;
    if (!point.IsNull()) {
      has_flaw = space.contains(entity.get()) &&
                 (point->NbCoordinates() != kInSpace || has_too_many(model, i));
    } else if (!direction.IsNull()) {
      has_flaw = direction->DirectionRatios().IsNull() ||
                 (space.contains(entity.get()) && direction->NbDirectionRatios() != kInSpace);
    } else if (entity->IsKind(STANDARD_TYPE(StepVisual_CoordinatesList))) {
      has_flaw = lists.contains(model->IdentLabel(entity));
    }
    if (has_flaw) flawed.insert(entity.get());
  }
  return flawed;
}

}  // namespace forcelayer::mesh
