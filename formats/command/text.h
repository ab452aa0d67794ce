// Text with numbers in it.
#pragma once

#include <string>

namespace forcelayer::command {

// What printf() would print, whatever its length.
[[gnu::format(printf, 1, 2)]] std::string text(const char* pattern, ...);

}  // namespace forcelayer::command
