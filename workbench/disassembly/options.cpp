#include "workbench/disassembly/options.h"

#include <CLI/CLI.hpp>

#include "formats/command/arguments.h"
#include "formats/command/help.h"

namespace forcelayer::disassembly {

OptionParser::OptionParser(CLI::App& app) {
  app.add_option("ASSEMBLY", options_.assembly,
                 "an assembly, a folder of mesh files or a scene manifest")
      ->required();
  app.add_option("-o,--output", options_.folder, "folder for sequence.json and the paths")
      ->required();
  app.add_option("--target", options_.target,
                 "a part or node to take out. Only the parts that must leave first are taken away. "
                 "Default: take the whole assembly apart");
  app.add_option("--clearance", options_.clearance,
                 "required distance between the exact surfaces, default 1mm");
  app.add_option("--rules", options_.rules,
                 "a CSV file with the columns part,object,clearance, as in forcelayer pairs. Where "
                 "no row names two parts, --clearance counts");
  app.add_option("--time", options_.time, "time limit of the whole command; default: none");
  app.add_option("--units", options_.units, command::kUnitsHelp);
  app.add_option("--json", options_.json, "write a report to this file");
  app.add_flag("--quiet", options_.quiet, "print nothing but errors");
  app.footer(
      "'34 mm or more along +z': after 34 mm, no part that is left is in the way any more.\n"
      "The same command continues an earlier one. It keeps the steps whose parts did not change.\n"
      "Exit status 0: all parts, or the target, come out; 6: something is left; 7: not "
      "without force.");
  command::arrange_help(
      app,
      {{"Question", {"--target", "--clearance", "--rules", "--time"}},
       {"Meshes", {"--units"}},
       {"Output", {"--output"}}},
      "  forcelayer disassemble gearbox.glb -o apart                takes all parts away\n"
      "  forcelayer disassemble gearbox.glb --target Cover -o cover");
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  const auto clearance_m = command::parse_length(options.clearance);
  if (!clearance_m) return command::about("--clearance", clearance_m.error());
  if (*clearance_m < 0) {
    return Error{ErrorCode::kUsage, "", "--clearance", "must not be negative", ""};
  }
  options.required_m = *clearance_m;
  if (!options.time.empty()) {
    const auto time_s = command::parse_duration(options.time);
    if (!time_s) return command::about("--time", time_s.error());
    options.max_s = *time_s;
  }
  if (!options.units.empty()) {
    const auto unit_m = command::parse_unit(options.units);
    if (!unit_m) return command::about("--units", unit_m.error());
    options.unit_m = *unit_m;
  }
  return options;
}

}  // namespace forcelayer::disassembly
