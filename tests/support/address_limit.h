// A ceiling on what a piece of code may take, for tests of files that announce more than they hold.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>

namespace forcelayer::test {

// While it lives, the process may map `bytes` more than it had: what asks for more meets bad_alloc.
// Sanitizers hold terabytes of addresses: there it limits nothing.
class AddressLimit {
 public:
  explicit AddressLimit(std::uint64_t bytes) {
    getrlimit(RLIMIT_AS, &before_);
    std::uint64_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const std::uint64_t page_bytes = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
    constexpr std::uint64_t kSanitizers = std::uint64_t{1} << 40;
    if (pages * page_bytes > kSanitizers) return;
    rlimit limited = before_;
    limited.rlim_cur = pages * page_bytes + bytes;
    setrlimit(RLIMIT_AS, &limited);
  }
  AddressLimit(const AddressLimit&) = delete;
  AddressLimit& operator=(const AddressLimit&) = delete;
  ~AddressLimit() { setrlimit(RLIMIT_AS, &before_); }

 private:
  rlimit before_{};
};

}  // namespace forcelayer::test
