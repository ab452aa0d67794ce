#include "runtime/devices/hid/hid_report_descriptor.h"

#include <algorithm>
#include <string>

namespace forcelayer::devices {
namespace {

constexpr std::uint32_t kMaxReportBits = 8 * 4096;  // Linux takes no longer reports either
constexpr std::size_t kMaxUsages = 4096, kMaxStack = 64, kMaxFields = 4096;
constexpr std::uint8_t kLongItem = 0xfe;
constexpr std::uint32_t kApplication = 1;              // collection type
constexpr std::uint32_t kConstant = 1, kVariable = 2;  // bits of Input, Output, Feature

// Items of HID 1.11, 6.2.2: type in bits 2 and 3, tag above.
enum Item : std::uint8_t {
  kInputItem = 0x80,
  kOutputItem = 0x90,
  kFeatureItem = 0xb0,
  kCollection = 0xa0,
  kEndCollection = 0xc0,
  kUsagePage = 0x04,
  kLogicalMin = 0x14,
  kLogicalMax = 0x24,
  kReportSize = 0x74,
  kReportId = 0x84,
  kReportCount = 0x94,
  kPush = 0xa4,
  kPop = 0xb4,
  kUsage = 0x08,
  kUsageMin = 0x18,
  kUsageMax = 0x28,
};

struct Globals {
  std::uint32_t usage_page = 0, report_size = 0, report_count = 0;
  std::int64_t logical_min = 0, logical_max = 0;
  std::uint8_t report_id = 0;
};

struct Locals {
  std::vector<std::uint32_t> usages;
  std::uint32_t usage_min = 0;
};

class Parser {
 public:
  explicit Parser(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  Result<HidReportDescriptor> run() {
    while (at_ < bytes_.size()) {
      item_at_ = at_;
      if (const char* wrong = next_item()) return error(wrong);
    }
    if (!collections_.empty()) return error("a collection does not end");
    return std::move(descriptor_);
  }

 private:
  Error error(const char* what) const {
    return {ErrorCode::kDeviceRefused, "", "report descriptor, byte " + std::to_string(item_at_),
            what, ""};
  }

  // Each of these returns null, or the flaw.
  const char* next_item() {
    const std::uint8_t prefix = bytes_[at_++];
    if (prefix == kLongItem) return skip_long_item();
    const std::size_t size = (prefix & 3) == 3 ? 4 : prefix & 3;
    if (bytes_.size() - at_ < size) return "the descriptor ends within an item";
    std::uint32_t data = 0;
    for (std::size_t i = 0; i < size; ++i) data |= std::uint32_t{bytes_[at_ + i]} << (8 * i);
    at_ += size;
    return item(prefix & 0xfc, data, size);
  }

  const char* skip_long_item() {
    if (bytes_.size() - at_ < 2) return "the descriptor ends within an item";
    const std::size_t size = bytes_[at_];
    at_ += 2;
    if (bytes_.size() - at_ < size) return "the descriptor ends within an item";
    at_ += size;
    return nullptr;
  }

  static std::int64_t sign_extended(std::uint32_t data, std::size_t size) {
    if (size == 1) return static_cast<std::int8_t>(data);
    if (size == 2) return static_cast<std::int16_t>(data);
    return static_cast<std::int32_t>(data);
  }

  const char* item(std::uint8_t tag, std::uint32_t data, std::size_t size) {
    switch (tag) {
      case kUsagePage:
        globals_.usage_page = data & 0xffff;
        return nullptr;
      case kLogicalMin:
        globals_.logical_min = sign_extended(data, size);
        return nullptr;
      case kLogicalMax:
        // Unsigned where the minimum is not negative: 25 FF after 15 00 means 255.
        globals_.logical_max =
            globals_.logical_min < 0 ? sign_extended(data, size) : std::int64_t{data};
        return nullptr;
      case kReportSize:
        globals_.report_size = data;
        return nullptr;
      case kReportCount:
        globals_.report_count = data;
        return nullptr;
      case kReportId:
        if (data == 0 || data > 255) return "a report id is out of range";
        globals_.report_id = static_cast<std::uint8_t>(data);
        return nullptr;
      case kPush:
        if (stack_.size() == kMaxStack) return "too many nested items";
        stack_.push_back(globals_);
        return nullptr;
      case kPop:
        if (stack_.empty()) return "a Pop has no Push before it";
        globals_ = stack_.back();
        stack_.pop_back();
        return nullptr;
      default:
        return local_or_main(tag, data, size);
    }
  }

  // A usage of four bytes carries its own page.
  std::uint32_t full_usage(std::uint32_t data, std::size_t size) const {
    return size == 4 ? data : hid_usage(globals_.usage_page, data);
  }

  const char* local_or_main(std::uint8_t tag, std::uint32_t data, std::size_t size) {
    switch (tag) {
      case kUsage:
        if (locals_.usages.size() == kMaxUsages) return "too many usages";
        locals_.usages.push_back(full_usage(data, size));
        return nullptr;
      case kUsageMin:
        locals_.usage_min = full_usage(data, size);
        return nullptr;
      case kUsageMax:
        return usage_range(full_usage(data, size));
      case kCollection:
        return open_collection(data);
      case kEndCollection:
        if (collections_.empty()) return "a collection ends without a beginning";
        collections_.pop_back();
        locals_ = {};
        return nullptr;
      case kInputItem:
        return add_fields(HidReportKind::kInput, data);
      case kOutputItem:
        return add_fields(HidReportKind::kOutput, data);
      case kFeatureItem:
        return add_fields(HidReportKind::kFeature, data);
      default:
        return nullptr;  // units, physical ranges, strings: not needed
    }
  }

  const char* usage_range(std::uint32_t last) {
    if (last < locals_.usage_min) return "a usage range ends before its beginning";
    const std::uint32_t after_first = last - locals_.usage_min;
    if (after_first >= kMaxUsages - locals_.usages.size()) return "too many usages";
    for (std::uint32_t n = 0; n <= after_first; ++n)
      locals_.usages.push_back(locals_.usage_min + n);
    return nullptr;
  }

  const char* open_collection(std::uint32_t type) {
    if (collections_.size() == kMaxStack) return "too many nested items";
    std::uint32_t application = collections_.empty() ? 0 : collections_.back();
    if (type == kApplication) {
      application = locals_.usages.empty() ? 0 : locals_.usages.front();
      descriptor_.applications.push_back(application);
    }
    collections_.push_back(application);
    locals_ = {};
    return nullptr;
  }

  HidReportSize& report(HidReportKind kind) {
    for (HidReportSize& known : descriptor_.reports) {
      if (known.kind == kind && known.report_id == globals_.report_id) return known;
    }
    descriptor_.reports.push_back({kind, globals_.report_id, 0});
    return descriptor_.reports.back();
  }

  const char* add_fields(HidReportKind kind, std::uint32_t flags) {
    const std::uint64_t bits = std::uint64_t{globals_.report_size} * globals_.report_count;
    HidReportSize& size = report(kind);
    if (bits > kMaxReportBits - size.bits) return "a report is too long";
    if ((flags & kConstant) == 0 && (flags & kVariable) != 0 && !locals_.usages.empty()) {
      if (globals_.report_size == 0 || globals_.report_size > 32)
        return "the size of a field is not 1 to 32 bits";
      if (globals_.report_count > kMaxFields - descriptor_.fields.size()) return "too many fields";
      for (std::uint32_t i = 0; i < globals_.report_count; ++i) {
        const std::size_t usage = std::min<std::size_t>(i, locals_.usages.size() - 1);
        descriptor_.fields.push_back(
            {kind, globals_.report_id, size.bits + i * globals_.report_size, globals_.report_size,
             locals_.usages[usage], collections_.empty() ? 0 : collections_.back(),
             globals_.logical_min, globals_.logical_max});
      }
    }
    size.bits += static_cast<std::uint32_t>(bits);
    locals_ = {};
    return nullptr;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0, item_at_ = 0;
  Globals globals_;
  Locals locals_;
  std::vector<Globals> stack_;
  std::vector<std::uint32_t> collections_;  // the application that each stands in
  HidReportDescriptor descriptor_;
};

}  // namespace

bool HidReportDescriptor::numbered() const {
  return std::any_of(reports.begin(), reports.end(),
                     [](const HidReportSize& report) { return report.report_id != 0; });
}

Result<HidReportDescriptor> parse_hid_report_descriptor(std::span<const std::uint8_t> bytes) {
  return Parser(bytes).run();
}

bool read_hid_field(const HidField& field, bool numbered, std::span<const std::uint8_t> report,
                    std::int64_t& value) noexcept {
  if (numbered) {
    if (report.empty() || report[0] != field.report_id) return false;
    report = report.subspan(1);
  }
  if (std::uint64_t{field.bit_offset} + field.bit_size > report.size() * std::uint64_t{8}) {
    return false;
  }
  std::uint64_t bits = 0;
  for (std::uint32_t i = 0; i < field.bit_size; ++i) {
    const std::uint32_t bit = field.bit_offset + i;
    bits |= std::uint64_t{(report[bit / 8] >> (bit % 8)) & 1u} << i;
  }
  value = static_cast<std::int64_t>(bits);
  if (field.logical_min < 0 && (bits >> (field.bit_size - 1) & 1) != 0) {
    value -= std::int64_t{1} << field.bit_size;
  }
  return true;
}

}  // namespace forcelayer::devices
