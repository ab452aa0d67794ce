// Generated puzzles: a part among obstacles that it touches nowhere, and from which it comes out by
// turns and slides alone.
#pragma once

#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::bench {

struct Puzzle {
  std::string name;
  mesh::Mesh scene;      // world, m
  mesh::Mesh part;       // part axes, m
  Pose world_from_part;  // where it starts
  double slack_m = 0;    // half of what its narrowest passage is wider than the part there
};

// All of them: a peg with a bend in a plate, a bracket behind a beam, a bolt through three plates,
// and two linked pieces of an alpha puzzle at three scales of its gap.
std::vector<Puzzle> puzzles();

}  // namespace forcelayer::bench
