// Text and bytes as a page has them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace forcelayer::study {

// Printable text in which no character has a meaning for HTML.
std::string html(std::string_view plain);

std::string base64(std::span<const std::byte> bytes);

}  // namespace forcelayer::study
