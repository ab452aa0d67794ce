// Text with numbers in it.
#pragma once

#include <string>

namespace forcelayer::command {

// The text that printf() would print, of any length.
[[gnu::format(printf, 1, 2)]] std::string text(const char* pattern, ...);

}  // namespace forcelayer::command
