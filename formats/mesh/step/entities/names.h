// Names in a STEP or IGES file that are not valid UTF-8.
#pragma once

#include <Interface_InterfaceModel.hxx>
#include <optional>
#include <string>
#include <string_view>

namespace forcelayer::mesh {

bool is_utf8(std::string_view text);

// A name whose letters are the bytes of a name in UTF-8: that name. Others stay as they are.
std::string without_bytes_as_letters(const std::string& name);

// How OpenCASCADE read the bytes beyond ASCII.
enum class BytesReadAs { kThemselves, kLatin1 };

// Makes the names of products, occurrences and shapes UTF-8: each that is valid UTF-8 in the file
// stays so, each other is read as Latin-1. OpenCASCADE would take letters for parts of others. A
// line where a name was read as Latin-1.
std::optional<std::string> settle_names(const Handle(Interface_InterfaceModel) & model,
                                        BytesReadAs read_as);

}  // namespace forcelayer::mesh
