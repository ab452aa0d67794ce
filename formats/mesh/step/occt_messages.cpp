#include "formats/mesh/step/occt_messages.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <TCollection_AsciiString.hxx>

#include "formats/mesh/reader.h"

namespace forcelayer::mesh {
namespace {

class KeepsTheWorst : public Message_Printer {
 public:
  const std::string& worst() const { return worst_; }

 protected:
  void send(const TCollection_AsciiString& text, const Message_Gravity gravity) const override {
    if (gravity < Message_Warning || (!worst_.empty() && gravity <= gravity_)) return;
    worst_ = text.ToCString();
    gravity_ = gravity;
  }

 private:
  mutable std::string worst_;
  mutable Message_Gravity gravity_ = Message_Trace;
};

// On one line, without asterisks, and without spaces at the ends or twice.
std::string one_line(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const bool is_space = static_cast<unsigned char>(c) <= ' ' || c == '*';
    if (is_space && (line.empty() || line.back() == ' ')) continue;
    line += is_space ? ' ' : c;
  }
  while (line.ends_with(' ')) line.pop_back();
  return line;
}

}  // namespace

OcctMessages::OcctMessages() : printer_(new KeepsTheWorst) {
  Message::DefaultMessenger()->AddPrinter(printer_);
}

OcctMessages::~OcctMessages() { Message::DefaultMessenger()->RemovePrinter(printer_); }

std::string OcctMessages::reason() const {
  constexpr std::size_t kLongest = 200;
  const std::string line = one_line(static_cast<const KeepsTheWorst&>(*printer_).worst());
  return line.empty() ? "" : ": " + line.substr(0, kLongest);
}

}  // namespace forcelayer::mesh
