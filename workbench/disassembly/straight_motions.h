// Straight motions of the parts of an assembly, as they are installed, out of it: which part blocks
// which, for each direction. Each pair is proven once, whatever other parts there are.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "formats/path/path_file.h"
#include "workbench/disassembly/blocking_graph.h"
#include "workbench/disassembly/part_shapes.h"

namespace forcelayer::disassembly {

class StraightMotions {
 public:
  // `shapes` outlive this. Six directions are known from the beginning: those of the axes.
  explicit StraightMotions(const PartShapes& shapes);
  static constexpr std::size_t kAxisDirections = 6;

  // Directions along the part's own features, and along those of parts that it is installed at:
  // normals of flat sides, and lines in which two of them meet. Those of the axes are not among
  // them. For one thread at a time; feature_directions() are those that were added.
  void add_feature_directions(std::size_t part);
  const Parts& feature_directions(std::size_t part) const { return features_[part]; }
  const glm::dvec3& direction(std::size_t number) const { return directions_[number]; }

  // Whether the part passes an object, by a proof. This and all below for many threads, but not
  // while directions are added.
  PairOutcome outcome(std::size_t part, std::size_t direction, std::size_t object);
  // The same of all of these: first what is quickly seen to be in the way. `others` may have the
  // part itself, which does not count.
  bool is_free(std::size_t part, std::size_t direction, const Parts& others);
  // Whether one of these is quickly seen to be in the way, or was found to be by a proof.
  bool is_any_seen(std::size_t part, std::size_t direction, const Parts& others);
  // Those of these that are in the way, as far as is quickly seen or was found by a proof.
  Parts seen_blockers(std::size_t part, std::size_t direction, const Parts& others);

  // How far some parts go along a direction until they are outside of the box around others, and
  // stay so however far they go on. In the second, they are displaced before.
  double length_m(const Parts& parts, std::size_t direction, const Parts& others) const {
    return length_m(parts, glm::dvec3(0), directions_[direction], others);
  }
  double length_m(const Parts& parts, const glm::dvec3& displaced_m, const glm::dvec3& direction,
                  const Parts& others) const;

 private:
  std::vector<PathRow> rows_out(std::size_t direction) const;
  bool is_seen(std::size_t part, std::size_t direction, std::size_t object);
  std::size_t add(const glm::dvec3& direction);
  double length_m(const glm::dvec3& direction, const mesh::Box& moved, const mesh::Box& rest) const;

  Parts by_gap(std::size_t part, const Parts& others) const;

  const PartShapes& shapes_;
  std::vector<glm::dvec3> directions_;
  std::vector<Parts> features_;  // [parts]
  std::mutex known_lock_;        // of the next two
  std::vector<std::map<std::pair<std::size_t, std::size_t>, PairOutcome>> proven_;  // [parts]
  std::vector<std::map<std::pair<std::size_t, std::size_t>, bool>> blocks_;  // [parts] as seen
};

// Rows of a path that goes from one displacement from the installed pose to the next, at a tenth of
// a meter in a second. It begins installed.
std::vector<PathRow> rows_through(std::span<const glm::dvec3> shifts_m);

}  // namespace forcelayer::disassembly
