// SHA-256 of a file, as `sha256sum` prints it: what a user holds a file against that a hand relies
// on. Checksums inside a file tell damage; they are no defense against someone who writes the file.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/file/mapped_file.h"
#include "formats/result.h"

namespace forcelayer::digest {

// 64 lower-case hexadecimal digits.
std::string sha256_of(std::span<const std::byte> bytes);

// The same of a file that is kept open, read in small pieces, so that the process's memory does not
// grow.
Result<std::string> sha256_of(const MappedFile& file);

// Digests as typed: 64 hexadecimal digits each, with commas or white space between them. Errors:
// kUsage.
Result<std::vector<std::string>> parse_digests(std::string_view text);

// Whether the file's digest is one of `expected`; without any, every file passes unread. `name` is
// the file's, for errors: kChecksumMismatch.
Status check_expected(const MappedFile& file, std::span<const std::string> expected,
                      std::string_view name);

}  // namespace forcelayer::digest
