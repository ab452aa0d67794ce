#include "workbench/pairs/options.h"

#include <CLI/CLI.hpp>

#include "formats/command/arguments.h"
#include "formats/command/help.h"

namespace forcelayer::pairs {

OptionParser::OptionParser(CLI::App& app) {
  app.add_option("ASSEMBLY", options_.assembly,
                 "an assembly, a folder of mesh files or a scene manifest")
      ->required();
  app.add_option("--clearance", options_.clearance,
                 "required distance between two parts, such as 1mm, where no rule says otherwise. "
                 "Default: touch, so that parts may touch but not overlap");
  app.add_option("--rules", options_.rules,
                 "a CSV file with the columns part,object,clearance. The first row that names both "
                 "parts counts. Names may have * and ?; a clearance is a length, touch or ignore");
  app.add_option("--units", options_.units, command::kUnitsHelp);
  app.add_option("--json", options_.json, "write a report to this file");
  app.add_flag("--quiet", options_.quiet, "print nothing but errors");
  app.footer(
      "Exit status 0: each pair keeps its rule; 6: a rule is broken, or a pair is not decided.");
  command::arrange_help(
      app, {{"Question", {"--clearance", "--rules"}}, {"Meshes", {"--units"}}},
      "  forcelayer pairs gearbox.glb                               finds overlaps\n"
      "  forcelayer pairs gearbox.glb --clearance 0.5mm --rules rules.csv");
}

Result<Options> OptionParser::finish() const {
  Options options = options_;
  if (!options.clearance.empty()) {
    const auto requirement = parse_requirement(options.clearance);
    if (!requirement) return command::about("--clearance", requirement.error());
    if (requirement->kind == Requirement::Kind::kIgnore) {
      return Error{ErrorCode::kUsage, "", "--clearance", "must be a length or touch",
                   "write pairs to ignore into the file of --rules"};
    }
    options.otherwise = *requirement;
  }
  if (!options.units.empty()) {
    const auto unit_m = command::parse_unit(options.units);
    if (!unit_m) return command::about("--units", unit_m.error());
    options.unit_m = *unit_m;
  }
  return options;
}

}  // namespace forcelayer::pairs
