// Checks of header fields; the first field that fails becomes the error. Internal to formats/.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "formats/result.h"

namespace forcelayer {

class FieldChecks {
 public:
  explicit FieldChecks(std::string_view file_name) : file_name_(file_name) {}

  // The header field `field` at byte `offset` must satisfy `holds`; else it `is_wrong`.
  void require(bool holds, std::size_t offset, const char* field, const char* is_wrong) {
    if (holds || !status_) return;
    status_ = Error{ErrorCode::kFieldInvalid, std::string(file_name_),
                    "header byte " + std::to_string(offset) + " (" + field + ")", is_wrong,
                    "bake or copy it again"};
  }

  const Status& status() const { return status_; }

 private:
  std::string_view file_name_;
  Status status_;
};

inline bool is_finite_not_negative(double number) { return std::isfinite(number) && number >= 0; }

}  // namespace forcelayer
