#include "formats/mesh/step/entities/names.h"

#include <IGESBasic_Name.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESData_IGESEntity.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionRelationship.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <TCollection_HAsciiString.hxx>
#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include "formats/mesh/reader.h"
#include "formats/result.h"

namespace forcelayer::mesh {
namespace {

using Text = Handle(TCollection_HAsciiString);

constexpr unsigned char kAscii = 0x80;  // the first byte beyond it

bool is_ascii(std::string_view text) {
  return std::none_of(text.begin(), text.end(),
                      [](char c) { return static_cast<unsigned char>(c) >= kAscii; });
}

std::string utf8_from_latin_1(std::string_view text) {
  std::string utf8;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (code < kAscii) {
      utf8 += letter;
    } else {
      utf8 += static_cast<char>(0xc0 | (code >> 6));
      utf8 += static_cast<char>(kAscii | (code & 0x3f));
    }
  }
  return utf8;
}

// Nothing where a letter is not in Latin-1.
std::optional<std::string> latin_1_from_utf8(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto code = static_cast<unsigned char>(text[i]);
    if (code < kAscii) {
      bytes += text[i];
      continue;
    }
    if ((code != 0xc2 && code != 0xc3) || i + 1 == text.size()) return std::nullopt;
    bytes += static_cast<char>((code & 3) << 6 | (static_cast<unsigned char>(text[++i]) & 0x3f));
  }
  return bytes;
}

std::vector<Text> names_of(const Handle(Standard_Transient) & entity) {
  if (const auto product = Handle(StepBasic_Product)::DownCast(entity); !product.IsNull()) {
    return {product->Id(), product->Name()};
  }
  if (const auto use = Handle(StepBasic_ProductDefinitionRelationship)::DownCast(entity);
      !use.IsNull()) {
    return {use->Id(), use->Name()};
  }
  if (const auto product = Handle(StepBasic_ProductDefinition)::DownCast(entity);
      !product.IsNull()) {
    return {product->Id()};
  }
  if (const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity); !item.IsNull()) {
    return {item->Name()};
  }
  if (const auto shape = Handle(StepRepr_Representation)::DownCast(entity); !shape.IsNull()) {
    return {shape->Name()};
  }
  if (const auto name = Handle(IGESBasic_Name)::DownCast(entity); !name.IsNull()) {
    return {name->Value()};
  }
  const auto labelled = Handle(IGESData_IGESEntity)::DownCast(entity);
  return labelled.IsNull() ? std::vector<Text>{} : std::vector<Text>{labelled->ShortLabel()};
}

// OpenCASCADE takes its bytes for letters: those of Latin-1.
Text name_of_subfigure(const Handle(Standard_Transient) & entity) {
  const auto figure = Handle(IGESBasic_SubfigureDef)::DownCast(entity);
  return figure.IsNull() ? Text() : figure->Name();
}

// The name in UTF-8, and whether that took it for Latin-1.
std::pair<std::string, bool> settled(const std::string& name, BytesReadAs read_as) {
  if (read_as == BytesReadAs::kThemselves) {
    if (is_utf8(name)) return {name, false};
    return {utf8_from_latin_1(name), true};
  }
  const std::optional<std::string> bytes = latin_1_from_utf8(name);
  if (bytes && is_utf8(*bytes)) return {*bytes, false};
  return {name, bytes.has_value()};
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    if (static_cast<unsigned char>(text.front()) < kAscii) {
      text.remove_prefix(1);
      continue;
    }
    const std::size_t bytes = utf8_bytes(text);
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

std::string without_bytes_as_letters(const std::string& name) {
  const std::optional<std::string> bytes = latin_1_from_utf8(name);
  return bytes && is_utf8(*bytes) ? *bytes : name;
}

std::optional<std::string> settle_names(const Handle(Interface_InterfaceModel) & model,
                                        BytesReadAs read_as) {
  std::string odd;  // the first
  std::set<const TCollection_HAsciiString*> done;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Text figure = name_of_subfigure(model->Value(i));
    if (!figure.IsNull() && odd.empty() && !is_utf8(figure->ToCString())) {
      odd = utf8_from_latin_1(figure->ToCString());
    }
    for (const Text& name : names_of(model->Value(i))) {
      if (name.IsNull() || is_ascii(name->ToCString()) || !done.insert(name.get()).second) continue;
      const auto [text, is_latin_1] = settled(name->ToCString(), read_as);
      name->Clear();
      name->AssignCat(text.c_str());
      if (is_latin_1 && odd.empty()) odd = text;
    }
  }
  if (odd.empty()) return std::nullopt;
  return "names such as " + in_quotes(odd) + " are not valid UTF-8: they are read as Latin-1";
}

}  // namespace forcelayer::mesh
