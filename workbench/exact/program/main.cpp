// voxcheck-exact: started by voxcheck --exact. It reads a request from the standard input and
// writes its answer to the standard output, errors too.
#include <cstdio>
#include <exception>
#include <iostream>
#include <iterator>
#include <string>

#include "formats/mesh/sandbox/sandbox.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "workbench/exact/exact_check.h"
#include "workbench/exact/map/clearance_map.h"

namespace {

forcelayer::Result<forcelayer::voxcheck::ExactAnswer> answer_to(const std::string& text) {
  using namespace forcelayer;
  try {
    const auto request = voxcheck::exact_request(text);
    if (!request) return request.error();
    return request->map.empty() ? exact::check_exactly(*request) : exact::write_map(*request);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kOutOfMemory, "", "--exact", "not enough memory", ""};
  } catch (const std::exception& e) {
    return Error{ErrorCode::kInternal, "", "--exact", e.what(), ""};
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = forcelayer::mesh::run_as_sandbox(argc, argv)) return *status;
  if (argc > 1) {
    std::fputs("voxcheck-exact: this program can only be started by voxcheck --exact\n", stderr);
    return 2;
  }
  const std::string text{std::istreambuf_iterator<char>(std::cin), {}};
  std::cout << forcelayer::voxcheck::text_of(answer_to(text)) << std::flush;
  return std::cout ? 0 : 1;
}
