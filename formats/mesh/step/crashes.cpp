#include "formats/mesh/step/crashes.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_GeneralLib.hxx>
#include <Interface_GeneralModule.hxx>
#include <Interface_Protocol.hxx>
#include <Standard_ErrorHandler.hxx>
#include <Standard_Failure.hxx>

namespace forcelayer::mesh {
namespace {

// A second crash where nothing expects a failure ends the process.
void on_crash(int) {
  if (Standard_ErrorHandler::IsInTryBlock()) Standard_Failure::NewInstance("it crashed")->Jump();
  ::signal(SIGSEGV, SIG_DFL);
}

bool crashes(const Handle(Interface_InterfaceModel) & model, const Interface_GeneralLib& library,
             const Handle(Standard_Transient) & entity) {
  try {
    OCC_CATCH_SIGNALS
    Handle(Interface_GeneralModule) module;
    Standard_Integer kind = 0;
    Interface_EntityIterator parts;
    if (library.Select(entity, module, kind)) module->FillShared(model, kind, entity, parts);
    return false;
  } catch (const Standard_Failure&) {
    return true;
  }
}

}  // namespace

CrashesAreFailures::CrashesAreFailures() {
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = SA_NODEFER | SA_ONSTACK;
  stack_t stack{stack_.data(), 0, stack_.size()};
  ::sigaltstack(&stack, &stack_before_);
  ::sigaction(SIGSEGV, &action, &before_);
}

CrashesAreFailures::~CrashesAreFailures() {
  ::sigaction(SIGSEGV, &before_, nullptr);
  ::sigaltstack(&stack_before_, nullptr);
}

Handle(Standard_Transient) crashing_entity(const Handle(Interface_InterfaceModel) & model) {
  if (model.IsNull()) return {};
  const Interface_GeneralLib library(model->Protocol());
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    if (crashes(model, library, model->Value(i))) return model->Value(i);
  }
  return {};
}

}  // namespace forcelayer::mesh
