#include "formats/command/version.h"

namespace forcelayer::command {

const char* commit() { return FORCELAYER_COMMIT; }

}  // namespace forcelayer::command
