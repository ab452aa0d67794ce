#include "pointshell/part/pieces.h"

namespace forcelayer::part {

void for_each_tile_batch(const Part& part, double longest_edge_m,
                         const std::function<bool(std::span<const Piece>)>& take) {
  constexpr std::size_t kTilesPerBatch = 1 << 16;
  std::vector<Piece> stack, tiles;
  tiles.reserve(kTilesPerBatch);
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    stack.push_back(triangle_piece(part, t));
    while (!stack.empty()) {
      const Piece piece = stack.back();
      stack.pop_back();
      const LongestEdge longest = longest_edge(piece);
      if (longest.length_squared > longest_edge_m * longest_edge_m) {
        const auto halves = bisected(piece, longest.from);
        stack.insert(stack.end(), {halves[1], halves[0]});
        continue;
      }
      tiles.push_back(piece);
      if (tiles.size() < kTilesPerBatch) continue;
      if (!take(tiles)) return;
      tiles.clear();
    }
  }
  if (!tiles.empty()) take(tiles);
}

}  // namespace forcelayer::part
