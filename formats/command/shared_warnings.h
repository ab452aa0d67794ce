// The warnings of a program and of those that it starts, for one reader: each is printed once.
#pragma once

#include <string>

namespace forcelayer::command {

// From here on this program, and those that it starts, print a warning that one of them has printed
// no more. Where the system gives no memory for that, they print all.
void share_warnings();

// Whether none of them has printed this warning: from now on, one has. True where none are shared.
bool is_new_warning(const std::string& text);

}  // namespace forcelayer::command
