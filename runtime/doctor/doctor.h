// voxrun doctor: finds what on this machine disturbs a 1 kHz loop, and how to mend it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::doctor {

enum class Verdict {
  kGood,    // nothing to do
  kChange,  // a real-time user should change this
  kNote,    // worth knowing; nothing to do
};

struct Finding {
  std::string what;  // the thing looked at
  Verdict verdict = Verdict::kNote;
  std::string seen;
  std::string mend;  // for kChange
};

// Looks at everything. `root` is where the file system of the machine begins ("/"; a test has its
// own). Measures the clock for `clock_s` seconds, at the priority that the loop would get; 0: not.
std::vector<Finding> examine_machine(const std::filesystem::path& root, double clock_s);

// The lines that voxrun doctor prints.
std::string findings_text(const std::vector<Finding>& findings);

struct DoctorOptions {
  std::string json;
  double clock_s = 2;
  bool quiet = false;
};

// Examines, prints, and writes the report where one is wanted.
Status run_doctor(const DoctorOptions& options);

}  // namespace forcelayer::doctor
