// Results that a caller must check: a value, or an error with a fixed code and its place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace forcelayer {

// Fixed numbers; the hundreds are the exit status of the commands (0 done, see exit_status()).
enum class ErrorCode : int {
  kInternal = 100,          // a bug in this program
  kFileNotFound = 101,      // missing, or a folder where a file is wanted
  kReadFailed = 102,        // the system refused or broke off a read
  kWriteFailed = 103,       // the system refused or broke off a write
  kOutOfMemory = 104,       // the system has too little memory for the job
  kUsage = 200,             // wrong command line
  kMeshUnreadable = 300,    // a mesh file that cannot be parsed
  kMeshIncomplete = 301,    // fewer vertices or faces than the file announces
  kMeshEmpty = 302,         // no triangles
  kMeshUnsupported = 303,   // a format or feature that this build does not read
  kSceneInvalid = 304,      // a manifest, node name, seed or transform that makes no sense
  kBakeTooLarge = 305,      // more voxels than the format's directory can hold
  kNotThisFormat = 400,     // wrong magic
  kWrongEndianness = 401,   // written on a big-endian machine
  kUnknownVersion = 402,    // a newer major version
  kUnknownFeature = 403,    // a required feature flag that this reader does not know
  kTruncated = 404,         // shorter than it says
  kTrailingBytes = 405,     // longer than it says
  kChecksumMismatch = 406,  // damaged
  kFieldInvalid = 407,      // a header field out of its range
  kSectionInvalid = 408,    // a section missing, misplaced, misaligned or of the wrong size
  kEntryInvalid = 409,      // a tree entry, block or point out of its range
  kFilesDoNotMatch = 410,   // a scene and a part that cannot be used together
  kDeviceNotFound = 500,
  kDeviceFailed = 501,
  kDeviceRefused = 502,  // present but unsafe or not as declared
  kAnswerIsNo = 600,     // checked as asked, and the answer is no
  kNeedsForce = 700,  // the same, and the answer is yes, but the installed part overlaps something
};

// The exit status of a command that ends with this error: 1 internal or I/O, 2 usage, 3 mesh or
// scene, 4 baked file, 5 device, 6 the answer is no, 7 the answer is yes with an overlap.
constexpr int exit_status(ErrorCode code) { return static_cast<int>(code) / 100; }

// Its members are no inline functions: hundreds of places make one, and hold its code then.
struct Error {
  Error();
  Error(ErrorCode code, std::string_view file, std::string_view where, std::string_view what,
        std::string_view mend);
  Error(const Error& other);
  Error(Error&& other) noexcept;
  Error& operator=(const Error& other);
  Error& operator=(Error&& other) noexcept;
  ~Error();

  ErrorCode code = ErrorCode::kInternal;
  std::string file;   // path as the user gave it; may be empty
  std::string where;  // section, byte, line, key, object ...; may be empty
  std::string what;   // what is wrong
  std::string mend;   // how to mend it; may be empty
};

// The text as it may stand on a terminal: as \xNN the bytes of control characters (C0, C1), of line
// ends and directions of Unicode, and of what is no UTF-8.
std::string escaped(std::string_view text);

// How many bytes the first character of a text takes that is not empty; 0 where it is no UTF-8.
std::size_t utf8_bytes(std::string_view text);

// "FILE: WHERE: WHAT; MEND" on one line, escaped.
std::string to_line(const Error& error);

// A value or an Error.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}      // NOLINT(implicit)
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(implicit)

  bool ok() const { return content_.index() == 0; }
  explicit operator bool() const { return ok(); }
  T& value() & { return std::get<0>(content_); }
  const T& value() const& { return std::get<0>(content_); }
  T&& value() && { return std::get<0>(std::move(content_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Error> content_;
};

// Done, or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)), ok_(false) {}  // NOLINT(implicit)

  bool ok() const { return ok_; }
  explicit operator bool() const { return ok_; }
  const Error& error() const { return error_; }

 private:
  Error error_;
  bool ok_ = true;
};

using Status = Result<void>;

}  // namespace forcelayer
