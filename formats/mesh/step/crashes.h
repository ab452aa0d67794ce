// Crashes of OpenCASCADE on damaged files, as failures.
#pragma once

#include <Interface_InterfaceModel.hxx>
#include <csignal>
#include <vector>

namespace forcelayer::mesh {

// While it lives, a crash of OpenCASCADE is a Standard_Failure where OCC_CATCH_SIGNALS expects one:
// it goes on to its next entity, and what is lost is found as other damage is. It has this of its
// own (OSD::SetSignal), but then stops reading the file there and says nothing.
class CrashesAreFailures {
 public:
  CrashesAreFailures();
  ~CrashesAreFailures();
  CrashesAreFailures(const CrashesAreFailures&) = delete;
  CrashesAreFailures& operator=(const CrashesAreFailures&) = delete;

 private:
  struct sigaction before_ {};
  std::vector<char> stack_ = std::vector<char>(1 << 16);  // where the usual one is full
  stack_t stack_before_{};
};

// The first entity of a file that was parsed on which OpenCASCADE crashes when it looks for what
// the entity refers to; null where there is none.
Handle(Standard_Transient) crashing_entity(const Handle(Interface_InterfaceModel) & model);

}  // namespace forcelayer::mesh
