// The answer of --version.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace forcelayer::command {

// "NAME 0.1.0 (commit 0123456789ab; FACTS)": `facts` say what this build can do ("reads STEP and
// IGES"). parse_arguments() does it without facts where a command did not.
void set_version(CLI::App& app, const std::string& facts = "");

// The commit that this was built from; empty where that was not known.
const char* commit();

}  // namespace forcelayer::command
