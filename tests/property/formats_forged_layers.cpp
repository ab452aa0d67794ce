// A forger of files without distances: lean ones, and those of the Chebyshev metric. The audit
// takes a file exactly where a twin takes it that is written from the text of voxmap_format.md, one
// voxel at a time. So what a forger can do there is what the text allows (formats/trust.md).
// FORCELAYER_LONG_TESTS=1 forges 5,000 files, in minutes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <random>
#include <string>

#include "formats/audit/voxmap_audit.h"
#include "tests/support/file_surgery.h"
#include "tests/support/long_tests.h"
#include "tests/support/sanitized.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::testing {
namespace {

using test::Voxel;

constexpr std::int64_t kEdge = 24;  // of the scenes, voxels
constexpr double kVoxelM = 0.001;

std::int64_t index_of(const Voxel& v) { return (v[0] * kEdge + v[1]) * kEdge + v[2]; }

// Calls take(voxel) for all voxels within `reach` of `middle`, until it says no.
template <typename Take>
bool all_within(const Voxel& middle, std::int64_t reach, const Take& take) {
  for (std::int64_t x = middle[0] - reach; x <= middle[0] + reach; ++x) {
    for (std::int64_t y = middle[1] - reach; y <= middle[1] + reach; ++y) {
      for (std::int64_t z = middle[2] - reach; z <= middle[2] + reach; ++z) {
        if (!take(Voxel{x, y, z})) return false;
      }
    }
  }
  return true;
}

// The rules of the text for a file, voxel by voxel.
class Text {
 public:
  explicit Text(const Voxmap& map) : map_(map), h_(map.header()), known_(known_box(h_)) {
    every([&](const Voxel& v) {
      values_[static_cast<std::size_t>(index_of(v))] = map.value(v[0], v[1], v[2]);
      if (at(v) != VoxelValue::kFree) not_free_.push_back(v);
      return true;
    });
  }

  // Empty where all of it is true.
  std::string fault() const {
    if (h_.directory_origin[0] != 0) return "directory";  // the scenes lie in cell 0
    for (const auto check :
         {&Text::counts, &Text::clearances, &Text::layers, &Text::lengths, &Text::width}) {
      if (const std::string found = (this->*check)(); !found.empty()) return found;
    }
    return "";
  }

 private:
  bool is_euclidean() const { return h_.metric == static_cast<std::uint32_t>(Metric::kEuclidean); }
  bool is_known(const Voxel& v) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (v[axis] < known_.low[axis] || v[axis] >= known_.high[axis]) return false;
    }
    return true;
  }
  VoxelValue at(const Voxel& v) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (v[axis] < 0 || v[axis] >= kEdge) return VoxelValue::kFree;
    }
    return values_[static_cast<std::size_t>(index_of(v))];
  }
  bool is(const Voxel& v, VoxelValue value) const { return is_known(v) && at(v) == value; }

  // Calls take(voxel) for those of the scene's box and `margin` around it, until it says no.
  template <typename Take>
  bool every(const Take& take, std::int64_t margin = 0) const {
    for (std::int64_t x = -margin; x < kEdge + margin; ++x) {
      for (std::int64_t y = -margin; y < kEdge + margin; ++y) {
        for (std::int64_t z = -margin; z < kEdge + margin; ++z) {
          if (!take(Voxel{x, y, z})) return false;
        }
      }
    }
    return true;
  }

  // Section 3.
  std::string counts() const {
    std::array<std::uint64_t, 4> counted{};
    Voxel low{kEdge, kEdge, kEdge}, high{};
    bool hides_any = false;
    every([&](const Voxel& v) {
      ++counted[static_cast<std::size_t>(at(v))];
      if (at(v) == VoxelValue::kFree) return true;
      hides_any |= !is_known(v);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], v[axis]);
        high[axis] = std::max(high[axis], v[axis] + 1);
      }
      return true;
    });
    if (hides_any) return "unknown voxels";
    if (h_.interior_voxels != counted[1] || h_.surface_voxels != counted[2] ||
        h_.proximity_voxels != counted[3]) {
      return "counts";
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const bool empty = high[0] == 0;
      if (h_.origin_voxel[axis] != (empty ? 0 : low[axis]) ||
          h_.dims_voxels[axis] !=
              (empty ? 0 : static_cast<std::uint64_t>(high[axis] - low[axis]))) {
        return "tight box";
      }
    }
    return "";
  }

  // Section 5: within c - 1 of a box of clearance c all is free and known.
  std::string clearances() const {
    const VoxmapView& view = map_.view();
    for (std::int64_t x = 0; x < 512; x += 8) {
      for (std::int64_t y = 0; y < 512; y += 8) {
        for (std::int64_t z = 0; z < 512; z += 8) {
          if ((x >= 64 || y >= 64 || z >= 64) && (x % 64 != 0 || y % 64 != 0 || z % 64 != 0)) {
            continue;  // nodes without bricks
          }
          const VoxelLookup found =
              view.lookup(static_cast<std::int32_t>(x), static_cast<std::int32_t>(y),
                          static_cast<std::int32_t>(z));
          const std::int64_t edge = found.edge_voxels;
          if (edge == 1 || found.code != 0 || found.clearance == 0) continue;
          const Voxel low{x & -edge, y & -edge, z & -edge};
          if (low != Voxel{x, y, z}) continue;  // seen before
          const std::int64_t reach = found.clearance - std::int64_t{1};
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if (low[axis] - reach < known_.low[axis] ||
                low[axis] + edge + reach > known_.high[axis]) {
              return "clearance, by a cropped side";
            }
          }
          const bool free = std::none_of(not_free_.begin(), not_free_.end(), [&](const Voxel& v) {
            bool near = true;
            for (std::size_t axis = 0; axis < 3; ++axis) {
              near &= v[axis] >= low[axis] - reach && v[axis] < low[axis] + edge + reach;
            }
            return near;
          });
          if (!free) return "clearance";
        }
      }
    }
    return "";
  }

  // Sections 8 and 10. Voxels beyond a cropped side may be interior or surface.
  std::string layers() const {
    const double ratio = is_euclidean() ? h_.force_depth_m / h_.voxel_size_m : 1;
    const auto n = std::max<std::int64_t>(1, static_cast<std::int64_t>(std::ceil(ratio - 1e-9)));
    const bool any_surface = !is_euclidean() && h_.offset_layers == 0;
    const bool right = every(
        [&](const Voxel& v) {
          if (!is_known(v)) return true;
          const auto near = [&](std::int64_t reach, VoxelValue value) {
            return !all_within(v, reach, [&](const Voxel& w) { return !is(w, value); });
          };
          const auto near_unknown = [&](std::int64_t reach) {
            const Voxel low{v[0] - reach, v[1] - reach, v[2] - reach};
            return !is_known(low) || !is_known({v[0] + reach, v[1] + reach, v[2] + reach});
          };
          switch (at(v)) {
            case VoxelValue::kInterior:
              return true;
            case VoxelValue::kSurface:
              return any_surface || near(n, VoxelValue::kInterior) || near_unknown(n);
            case VoxelValue::kProximity:
              return !near(n, VoxelValue::kInterior) &&
                     (near(1, VoxelValue::kSurface) || near_unknown(1));
            case VoxelValue::kFree:
              return !near(n, VoxelValue::kInterior) && !near(1, VoxelValue::kSurface);
          }
          return false;
        },
        n + 1);
    return right ? "" : "layers";
  }

  std::string lengths() const {
    if (!is_euclidean()) return "";
    const double s = h_.voxel_size_m, k = h_.offset_layers;
    const double expected_m = (k - 1 + 888.0 / 1024) * s + h_.force_depth_m;
    return std::abs(h_.zero_force_m - expected_m) <= 1e-6 * s ? "" : "lengths";
  }

  // Section 13.6.
  std::string width() const {
    const auto k = static_cast<std::int64_t>(h_.offset_layers);
    if (k < 2) return "";
    if (k > 32) return "too many layers";
    std::int64_t cube = k - 1, line = k - 1, reach = k - 1;
    if (is_euclidean()) {
      const double radius = static_cast<double>(k) - 1 + 888.0 / 1024 - 1e-6;
      cube = static_cast<std::int64_t>(std::floor(radius / std::sqrt(3.0) - 0.5));
      line = static_cast<std::int64_t>(std::floor(std::sqrt(radius * radius - 0.5) - 0.5));
      reach = k;
    }
    const auto may_be_interior = [&](const Voxel& v) {
      return !is_known(v) || at(v) == VoxelValue::kInterior;
    };
    const auto is_core = [&](const Voxel& c) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::int64_t t = -line; t <= line; ++t) {
          Voxel v = c;
          v[axis] += t;
          if (!may_be_interior(v)) return false;
        }
      }
      return all_within(c, cube, may_be_interior);
    };
    std::map<Voxel, bool> cores;  // asked for so far
    const bool wide = every([&](const Voxel& v) {
      if (!is(v, VoxelValue::kInterior)) return true;
      return !all_within(v, reach, [&](const Voxel& c) {
        if (!may_be_interior(c)) return true;
        const auto [known, is_new] = cores.try_emplace(c, false);
        if (is_new) known->second = is_core(c);
        return !known->second;
      });
    });
    return wide ? "" : "too narrow for its layers";
  }

  const Voxmap& map_;
  const VoxmapHeader& h_;
  KnownBox known_;
  std::array<VoxelValue, kEdge * kEdge * kEdge> values_{};  // of the scene's box; free outside
  std::vector<Voxel> not_free_;
};

struct Forgery {
  test::VoxelScene scene;
  std::uint32_t cropped_sides = 0;
  std::function<void(VoxmapHeader&)> header = [](VoxmapHeader&) {};
  int raises_clearances_by = 0;
};

// A plate in any direction and a post beside it, with k layers around them.
struct Honest {
  explicit Honest(std::uint64_t seed) : random(seed) {
    std::uniform_real_distribution<double> any(-1, 1);
    const bool euclidean = seed % 2 == 0;
    const auto k = static_cast<std::int64_t>(seed / 2 % 4 + (euclidean ? 1 : 0));
    const std::int64_t n = euclidean && seed % 3 == 0 ? 2 : 1;
    glm::dvec3 z{0, 0, 1};
    if (seed % 5 != 0) z = glm::normalize(glm::dvec3(any(random), any(random), any(random)));
    const glm::dvec3 x = glm::normalize(glm::cross(z, glm::dvec3(0.3, 1, 0.1))),
                     y = glm::cross(z, x);
    const double thickness = 0.4 + static_cast<double>(seed / 8 % 4);
    const auto in_mesh = [&](const Voxel& v, double more) {
      const glm::dvec3 p = glm::dvec3(v[0], v[1], v[2]) + 0.5 - glm::dvec3(kEdge) / 2.0;
      const double a = std::abs(glm::dot(p, x)), b = std::abs(glm::dot(p, y)), c = glm::dot(p, z);
      return (a < 4 + more && b < 5 + more && std::abs(c) < thickness + more) ||
             (a < 0.7 + more && b < 0.7 + more && std::abs(c - 4) < 3 + more);
    };
    if (euclidean) {
      const double radius = static_cast<double>(k) - 1 + 888.0 / 1024;
      std::vector<Voxel> mesh;
      for (std::int64_t i = 0; i < kEdge * kEdge * kEdge; ++i) {
        const Voxel v{i / kEdge / kEdge, i / kEdge % kEdge, i % kEdge};
        if (in_mesh(v, 0)) mesh.push_back(v);
      }
      scene =
          test::offset_scene(kVoxelM, {0, 0, 0}, {kEdge, kEdge, kEdge}, 1, n, [&](const Voxel& v) {
            return std::any_of(mesh.begin(), mesh.end(), [&](const Voxel& m) {
              const glm::dvec3 d(v[0] - m[0], v[1] - m[1], v[2] - m[2]);
              return glm::dot(d, d) < radius * radius;
            });
          });
      scene.metric = Metric::kEuclidean;
      scene.layers = static_cast<std::uint32_t>(k);
      scene.force_depth_voxels = n == 2 ? 1.7 : 1;
    } else {
      scene = test::offset_scene(kVoxelM, {0, 0, 0}, {kEdge, kEdge, kEdge}, k, 1,
                                 [&](const Voxel& v) { return in_mesh(v, 0.3); });
    }
  }

  test::VoxelScene scene;
  std::mt19937_64 random;
};

// The layers around the interior as it is now.
void add_layers(test::VoxelScene& scene, std::int64_t n) {
  const test::VoxelScene before = scene;
  const test::VoxelScene after =
      test::offset_scene(scene.voxel_size_m, scene.min, scene.dims, 1, n,
                         [&](const Voxel& v) { return before.at(v) == VoxelValue::kInterior; });
  scene.values = after.values;
}

const std::map<std::string, std::function<void(Forgery&, std::mt19937_64&)>>& kinds() {
  using Random = std::mt19937_64;
  const auto below = [](Random& random, std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
  };
  // Gives a box a value, or a layer through all of the scene.
  const auto set_box = [below](test::VoxelScene& scene, Random& random, std::int64_t largest,
                               bool plane, std::uint8_t to) {
    Voxel low{}, high{};
    const auto flat = static_cast<std::size_t>(below(random, 3));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = plane && axis != flat ? 0 : 4 + below(random, kEdge - 8);
      high[axis] = plane && axis != flat ? kEdge : low[axis] + 1 + below(random, largest);
      high[axis] = std::min(high[axis], kEdge);
    }
    for (std::int64_t x = low[0]; x < high[0]; ++x) {
      for (std::int64_t y = low[1]; y < high[1]; ++y) {
        for (std::int64_t z = low[2]; z < high[2]; ++z) {
          scene.values[static_cast<std::size_t>(index_of({x, y, z}))] = to;
        }
      }
    }
  };
  const auto force_layers = [](const test::VoxelScene& scene) {
    return static_cast<std::int64_t>(std::ceil(scene.force_depth_voxels - 1e-9));
  };
  static const std::map<std::string, std::function<void(Forgery&, Random&)>> all{
      {"values of a block",
       [=](Forgery& f, Random& r) {
         const auto to = static_cast<std::uint8_t>(below(r, 4));
         set_box(f.scene, r, 1 + below(r, 6), r() % 4 == 0, to);
       }},
      {"a hole in the interior, with its layers",
       [=](Forgery& f, Random& r) {
         set_box(f.scene, r, 1 + below(r, 8), r() % 4 == 0, 0);
         add_layers(f.scene, force_layers(f.scene));
       }},
      {"more interior, with its layers",
       [=](Forgery& f, Random& r) {
         set_box(f.scene, r, 1 + below(r, 8), false, 1);
         add_layers(f.scene, force_layers(f.scene));
       }},
      {"the interior without a layer of its own",
       [=](Forgery& f, Random&) {
         const test::VoxelScene before = f.scene;
         for (std::int64_t i = 0; i < kEdge * kEdge * kEdge; ++i) {
           const Voxel v{i / kEdge / kEdge, i / kEdge % kEdge, i % kEdge};
           const bool deep = all_within(
               v, 1, [&](const Voxel& w) { return before.at(w) == VoxelValue::kInterior; });
           f.scene.values[static_cast<std::size_t>(i)] = deep ? 1 : 0;
         }
         add_layers(f.scene, force_layers(f.scene));
       }},
      {"the number of layers",
       [=](Forgery& f, Random& r) {
         const auto k = static_cast<std::uint32_t>(below(r, 7));
         f.header = [k](VoxmapHeader& h) {
           if (h.metric != 0) {
             h.zero_force_m += (static_cast<double>(k) - h.offset_layers) * h.voxel_size_m;
           }
           h.offset_layers = k;
         };
       }},
      {"many layers",
       [=](Forgery& f, Random& r) {
         const auto k = static_cast<std::uint32_t>(30 + below(r, 5));
         set_box(f.scene, r, 1, false, 1);
         f.header = [k](VoxmapHeader& h) {
           if (h.metric != 0) h.zero_force_m += (double{1} * k - h.offset_layers) * h.voxel_size_m;
           h.offset_layers = k;
         };
       }},
      {"the metric",
       [=](Forgery& f, Random& r) {
         const auto depth = static_cast<double>(1 + below(r, 2));
         f.header = [depth](VoxmapHeader& h) {
           h.metric = 1 - h.metric;
           h.force_depth_m = h.metric == 0 ? 0 : depth * h.voxel_size_m;
           h.zero_force_m = h.metric == 0 ? 0
                                          : (h.offset_layers - 1 + 888.0 / 1024) * h.voxel_size_m +
                                                h.force_depth_m;
         };
       }},
      {"the lengths of the force",
       [=](Forgery& f, Random& r) {
         const double more = 0.1 * static_cast<double>(1 + below(r, 20)) * kVoxelM;
         const auto which = below(r, 3);
         f.header = [=](VoxmapHeader& h) {
           if (h.metric == 0) return;
           if (which != 0) h.zero_force_m += more;
           if (which != 1) h.force_depth_m += more;
         };
       }},
      {"counts",
       [=](Forgery& f, Random& r) {
         const auto which = below(r, 3);
         f.header = [=](VoxmapHeader& h) {
           (which == 0   ? h.interior_voxels
            : which == 1 ? h.surface_voxels
                         : h.proximity_voxels) += 1;
         };
       }},
      {"boxes",
       [=](Forgery& f, Random& r) {
         const auto which = below(r, 3);
         const auto axis = static_cast<std::size_t>(below(r, 3));
         const std::int64_t by = 2 * below(r, 2) - 1;
         f.header = [=](VoxmapHeader& h) {
           if (which == 0) h.origin_voxel[axis] += by;
           if (which == 1) h.dims_voxels[axis] += static_cast<std::uint64_t>(by);
           if (which == 2) h.directory_origin[axis] += 512 * by;
         };
       }},
      {"the valid box and its cropped sides",
       [=](Forgery& f, Random& r) {
         std::array<std::int64_t, 6> by{};
         for (std::int64_t& side : by) side = below(r, 16) - 12;
         f.cropped_sides = static_cast<std::uint32_t>(below(r, 64));
         f.header = [=](VoxmapHeader& h) {
           for (std::size_t axis = 0; axis < 3; ++axis) {
             h.valid_min_voxel[axis] -= by[axis];
             h.valid_max_voxel[axis] += by[axis + 3];
           }
         };
       }},
      {"values at a cropped side",
       [=](Forgery& f, Random& r) {
         f.cropped_sides = 63;
         set_box(f.scene, r, 4, true, static_cast<std::uint8_t>(below(r, 3)));
         // The scene was cut at its sides: what lies there has no layers beyond them.
         add_layers(f.scene, force_layers(f.scene));
       }},
      {"clearances, raised by what a brick can hide and more",
       [=](Forgery& f, Random& r) { f.raises_clearances_by = 1 + static_cast<int>(below(r, 9)); }},
      {"clearances, lowered",
       [=](Forgery& f, Random& r) { f.raises_clearances_by = -1 - static_cast<int>(below(r, 9)); }},
      {"objects beside values alone",
       [=](Forgery& f, Random& r) {
         const auto count = static_cast<std::uint32_t>(below(r, 3));
         f.header = [count](VoxmapHeader& h) { h.object_count = count; };
       }},
  };
  return all;
}

TEST(ForgedLayers, TheAuditTakesWhatTheTextAllows) {
  const std::uint64_t scenes = test::kSanitized ? 2 : test::long_tests() ? 340 : 16;
  std::map<std::string, int> accepted;
  int refused = 0;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    Honest honest(seed);
    for (const auto& [kind, forge] : kinds()) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ": " + kind);
      Forgery forged{.scene = honest.scene};
      forge(forged, honest.random);
      const test::SceneFile file(forged.scene);
      VoxmapContent content = file.content(forged.cropped_sides);
      forged.header(content.header);
      AlignedBytes bytes(voxmap_bytes(content));
      if (forged.raises_clearances_by != 0 &&
          !change_clearance(bytes.bytes(), forged.raises_clearances_by, honest.random)) {
        continue;
      }
      resign(bytes.bytes());
      const auto map =
          Voxmap::from_bytes(bytes.bytes(), "forged.vox", Verify::kStructureAndChecksums);
      if (!map) {
        ++refused;
        continue;  // for its structure
      }
      const std::string fault = Text(*map).fault();
      const Status status = audit_voxmap(*map, "forged.vox");
      EXPECT_EQ(bool{status}, fault.empty())
          << (status ? "taken in spite of: " + fault : to_line(status.error()));
      status ? ++accepted[kind] : ++refused;
    }
  }
  int all = 0;
  for (const auto& [kind, count] : accepted) all += count;
  EXPECT_GT(all, refused / 5);
  EXPECT_GT(refused, all);
  for (const auto& [kind, count] : accepted) RecordProperty(kind.substr(0, 20), count);
}

TEST(ForgedLayers, TheTwinTakesTheTruth) {
  for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 2 : 24); ++seed) {
    Honest honest(seed);
    const Voxmap map = test::make_voxmap(honest.scene);
    EXPECT_EQ(Text(map).fault(), "") << "seed " << seed;
    const Status status = audit_voxmap(map, "honest.vox");
    EXPECT_TRUE(status) << "seed " << seed << ": " << to_line(status.error());
  }
}

// This scene's layers reach the lowest side of the directory: beyond it all is free, also where a
// layer should go on.
TEST(ForgedLayers, NoLayerEndsWithTheDirectory) {
  const Voxmap map = test::make_voxmap(Honest(318).scene);
  EXPECT_EQ(Text(map).fault(), "layers");
  const Status status = audit_voxmap(map, "cut.vox");
  ASSERT_FALSE(status);
  EXPECT_NE(status.error().where.find("-1"), std::string::npos) << to_line(status.error());
}

}  // namespace
}  // namespace forcelayer::testing
