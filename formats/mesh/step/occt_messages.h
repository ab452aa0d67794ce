// Collects OpenCASCADE's messages about a file while it reads it.
#pragma once

#include <Message_Printer.hxx>
#include <string>

namespace forcelayer::mesh {

// Listens to OpenCASCADE's messenger while it lives; one at a time.
class OcctMessages {
 public:
  OcctMessages();
  ~OcctMessages();
  OcctMessages(const OcctMessages&) = delete;
  OcctMessages& operator=(const OcctMessages&) = delete;

  // ": TEXT", the first failure or else the first warning that it reported; empty where there was
  // none.
  std::string reason() const;

 private:
  Handle(Message_Printer) printer_;
};

}  // namespace forcelayer::mesh
