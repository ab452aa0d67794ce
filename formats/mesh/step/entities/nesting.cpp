#include "formats/mesh/step/entities/nesting.h"

#include <IGESBasic_Group.hxx>
#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESData_IGESEntity.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <map>
#include <vector>

namespace forcelayer::mesh {
namespace {

using Entity = Handle(Standard_Transient);

// Which entity holds which others.
class Nesting {
 public:
  void add(const Entity& holder, const Entity& held) {
    if (holder.IsNull() || held.IsNull()) return;
    held_by_[holder.get()].push_back(held.get());
    ++holders_[held.get()];
    holders_.try_emplace(holder.get(), 0);
  }

  // An entity is there once for each time that its holders are there; all holders come first.
  double count() {
    std::map<const Standard_Transient*, double> times;
    std::vector<const Standard_Transient*> ready;
    for (const auto& [entity, holders] : holders_) {
      if (holders > 0) continue;
      times[entity] = 1;
      ready.push_back(entity);
    }
    double all = 0;
    while (!ready.empty()) {
      const Standard_Transient* const holder = ready.back();
      ready.pop_back();
      all += times[holder];
      for (const Standard_Transient* const held : held_by_[holder]) {
        times[held] += times[holder];
        if (--holders_[held] == 0) ready.push_back(held);
      }
    }
    return all;
  }

 private:
  std::map<const Standard_Transient*, std::vector<const Standard_Transient*>> held_by_;
  std::map<const Standard_Transient*, int> holders_;  // that were not visited yet
};

}  // namespace

double count_placings(const Handle(Interface_InterfaceModel) & model) {
  Nesting nesting;
  for (Standard_Integer n = 1; n <= model->NbEntities(); ++n) {
    const Entity entity = model->Value(n);
    if (const auto use = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(entity);
        !use.IsNull()) {
      nesting.add(use->RelatingProductDefinition(), use->RelatedProductDefinition());
    } else if (const auto shape = Handle(StepRepr_Representation)::DownCast(entity);
               !shape.IsNull()) {
      for (Standard_Integer i = 1; !shape->Items().IsNull() && i <= shape->NbItems(); ++i) {
        const auto mapped = Handle(StepRepr_MappedItem)::DownCast(shape->ItemsValue(i));
        if (mapped.IsNull() || mapped->MappingSource().IsNull()) continue;
        nesting.add(shape, mapped->MappingSource()->MappedRepresentation());
      }
    } else if (const auto placed = Handle(IGESBasic_SingularSubfigure)::DownCast(entity);
               !placed.IsNull()) {
      nesting.add(placed, placed->Subfigure());
    } else if (const auto figure = Handle(IGESBasic_SubfigureDef)::DownCast(entity);
               !figure.IsNull()) {
      for (Standard_Integer i = 1; i <= figure->NbEntities(); ++i) {
        nesting.add(figure, figure->AssociatedEntity(i));
      }
    } else if (const auto group = Handle(IGESBasic_Group)::DownCast(entity); !group.IsNull()) {
      for (Standard_Integer i = 1; i <= group->NbEntities(); ++i) {
        nesting.add(group, group->Entity(i));
      }
    }
  }
  return nesting.count();
}

}  // namespace forcelayer::mesh
