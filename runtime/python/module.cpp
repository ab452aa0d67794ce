// `import forcelayer`: scenes, parts, and questions to them. Every docstring is a doctest.
#include "runtime/python/files.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "formats/path/path_file.h"
#include "runtime/clearance/path_check.h"
#include "runtime/run/baked_files.h"

namespace forcelayer::python {

Scene::Scene(const std::filesystem::path& file)
    : path(file), map(take(open_scene(file))), points(map) {}

std::shared_ptr<PoseBatch> Scene::poses_of(Part& part) {
  constexpr std::size_t kKept = 4;
  std::erase_if(asked_, [](const Asked& asked) { return asked.part.expired(); });
  for (const Asked& asked : asked_) {
    if (asked.part.lock().get() == &part) return asked.batch;
  }
  std::shared_ptr<PoseBatch> made = take(PoseBatch::create(map, part.shell));
  if (asked_.size() == kKept) asked_.erase(asked_.begin());
  asked_.push_back({part.weak_from_this(), made});
  return made;
}

Part::Part(const std::filesystem::path& file) : path(file), shell(take(open_part(file))) {}

Pose pose_of(const std::array<double, 7>& n, const std::string& name) {
  const glm::dquat q(n[3], n[4], n[5], n[6]);
  const double length = glm::length(q), sum = n[0] + n[1] + n[2];
  if (!std::isfinite(sum) || !std::isfinite(length) || !(length > 0)) {
    throw Failure({ErrorCode::kUsage, "", name, "is not a pose",
                   "give finite x, y, z (m) and a nonzero quaternion"});
  }
  return {{n[0], n[1], n[2]}, q / length};
}

bool nobody_interrupts() {
  const py::gil_scoped_acquire python;
  return PyErr_CheckSignals() == 0;
}

void check_done(std::int64_t done, const char* name, const char* what) {
  if (done == kAllDone) return;
  if (done == kStopped) throw py::error_already_set();
  throw Failure({ErrorCode::kUsage, "", name, "row " + std::to_string(done) + what, ""});
}

namespace {

template <typename Answer, typename Ask>
py::array ask_poses(Scene& scene, Part& part, const Doubles& poses, const Ask& ask) {
  const auto rows = rows_of<7>(poses, "poses");
  const std::shared_ptr<PoseBatch> batch = scene.poses_of(part);
  auto answers = empty_rows<Answer>(rows.size());
  const std::span<Answer> out(answers.mutable_data(), rows.size());
  std::int64_t done = kAllDone;
  {
    const py::gil_scoped_release other_threads;
    done = ask(*batch, rows, out);
  }
  check_done(done, "poses", kNoPose);
  return answers;
}

// A read-only view of the file's own numbers.
template <typename T>
py::array view_of(const Part& part, std::vector<py::ssize_t> shape,
                  std::vector<py::ssize_t> strides, const T* first) {
  py::array view(py::dtype::of<T>(), std::move(shape), std::move(strides), first,
                 py::cast(part, py::return_value_policy::reference));  // the object that has it
  view.attr("flags").attr("writeable") = false;
  return view;
}

// Three columns of floats as an array of shape (points, 3). They lie one behind the other in the
// file, at equal distances.
py::array columns_of(const Part& part, const float* x, const float* y, const float* z) {
  const auto points = static_cast<py::ssize_t>(part.shell.view().point_count);
  const auto apart = reinterpret_cast<const char*>(y) - reinterpret_cast<const char*>(x);
  const auto next = reinterpret_cast<const char*>(z) - reinterpret_cast<const char*>(y);
  if (apart != next) {  // a writer of another kind: sections may stand in any order
    py::array_t<float> copy({points, py::ssize_t{3}});
    auto at = copy.mutable_unchecked<2>();
    for (py::ssize_t i = 0; i < points; ++i) at(i, 0) = x[i], at(i, 1) = y[i], at(i, 2) = z[i];
    return copy;
  }
  return view_of(part, {points, 3}, {sizeof(float), apart}, x);
}

py::array_t<double> vector_of(const std::array<double, 3>& v) {
  return py::array_t<double>(3, v.data());
}

std::vector<std::string> object_names(const Scene& scene) {
  std::vector<std::string> names{""};
  for (std::uint32_t n = 1; n <= scene.map.header().object_count; ++n) {
    names.emplace_back(scene.map.object_name(n));
  }
  return names;
}

// The numbers of objects by their names; throws Failure for an unknown name.
clearance::LeftOut numbers_of(const Scene& scene, const std::vector<std::string>& names) {
  clearance::LeftOut left_out(scene.map.header().object_count + std::size_t{1});
  for (const std::string& name : names) {
    bool found = false;
    for (std::uint32_t n = 1; n <= scene.map.header().object_count; ++n) {
      if (scene.map.object_name(n) != name) continue;
      left_out[n] = 1;
      found = true;
    }
    if (!found) {
      throw Failure({ErrorCode::kUsage, scene.path.string(), "allow",
                     "has no object '" + name + "'", "see Scene.objects"});
    }
  }
  return left_out;
}

// `clearance_m`: proven for more than this moment, where it is of more.
py::dict dict_of(const Scene& scene, const clearance::CheckedMoment& moment, double clearance_m) {
  py::dict d;
  d["clearance_m"] = clearance_m;
  d["at_most_m"] =
      std::isfinite(moment.max_m) ? py::object(py::float_(moment.max_m)) : py::object(py::none());
  d["t_s"] = moment.time_s;
  d["object"] = moment.object == 0 ? py::object(py::none())
                                   : py::str(std::string(scene.map.object_name(moment.object)));
  d["point_m"] = std::array<double, 3>{moment.point_m.x, moment.point_m.y, moment.point_m.z};
  return d;
}

py::dict dict_of(const Scene& scene, const clearance::CheckResult& result, double required_m) {
  py::dict d;
  d["verdict"] = result.clear() ? "clear" : "not clear";
  d["required_clearance_m"] = required_m;
  d["clearance_m"] = result.clearance_m;
  d["min_clearance"] = result.at_least
                           ? py::object(py::none())
                           : py::object(dict_of(scene, result.smallest, result.clearance_m));
  py::list violations;
  for (const clearance::Violation& violation : result.violations) {
    py::dict v;
    v["from_s"] = violation.from_s;
    v["to_s"] = violation.to_s;
    v["clearance_m"] = violation.clearance_m;
    v["pushed_into_seat"] = violation.pushed_into_seat;
    v["seat_not_settled"] = violation.unsettled_seat;
    v["object_inside"] = violation.object_inside;
    v["worst"] = dict_of(scene, violation.worst, violation.clearance_m);
    violations.append(v);
  }
  d["violations"] = violations;
  py::list seated;
  for (const clearance::SeatedStretch& stretch : result.seated) {
    py::dict s;
    s["from_s"] = stretch.from_s;
    s["to_s"] = stretch.to_s;
    s["travel_m"] = stretch.travel_m;
    s["clearance_m"] = stretch.clearance_m;
    s["nearest"] = dict_of(scene, stretch.nearest, stretch.clearance_m);
    seated.append(s);
  }
  d["seated"] = seated;
  auto curve = empty_rows<clearance::CurvePiece>(result.curve.size());
  std::copy(result.curve.begin(), result.curve.end(), curve.mutable_data());
  d["curve"] = curve;
  return d;
}

py::dict check_path(const Scene& scene, const Part& part, const Doubles& t_s, const Doubles& poses,
                    double required_m, const std::vector<std::string>& allow,
                    const std::optional<Doubles>& world_from_seat, unsigned threads,
                    bool felt_seat) {
  const auto numbers = rows_of<7>(poses, "poses");
  if (t_s.ndim() != 1 || static_cast<std::size_t>(t_s.shape(0)) != numbers.size() ||
      numbers.empty()) {
    throw Failure({ErrorCode::kUsage, "", "t_s",
                   "is empty, or its length differs from the length of poses",
                   "give a time for each pose"});
  }
  std::vector<PathRow> rows;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string row = "row " + std::to_string(i);
    const Pose pose = pose_of(numbers[i], "poses: " + row);
    const double time_s = t_s.data()[i];
    if (!std::isfinite(time_s) || (i > 0 && !(time_s > rows.back().time_s))) {
      throw Failure({ErrorCode::kUsage, "", "t_s", row + " is not later than the row before", ""});
    }
    const glm::dvec3& p = pose.position_m;
    const glm::dquat& q = pose.orientation;
    rows.push_back({time_s, {p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}});
  }
  if (!(required_m >= 0)) {
    throw Failure({ErrorCode::kUsage, "", "clearance_m", "must not be negative", ""});
  }
  clearance::CheckRequest request{required_m, thread_count(threads), numbers_of(scene, allow), {}};
  request.felt_seat_is_enough = felt_seat;
  if (world_from_seat) {
    request.world_from_seat =
        pose_of(row_of<7>(*world_from_seat, "world_from_seat"), "world_from_seat");
  }
  clearance::CheckResult result;
  {
    const py::gil_scoped_release other_threads;
    const clearance::CenterPath path(rows, part.shell);
    result = take(clearance::check_path(scene.map, part.shell, path, request));
  }
  return dict_of(scene, result, required_m);
}

void bind_scene(py::module_& module) {
  py::class_<Scene, std::shared_ptr<Scene>>(module, "Scene", R"(A baked scene: a `.vox` file.

The whole file is checked when it is opened, its checksums too.

>>> scene = forcelayer.Scene("bay.vox")
>>> scene
forcelayer.Scene('bay.vox')
>>> scene.voxel_size_m
0.005
>>> forcelayer.Scene("nowhere.vox")
Traceback (most recent call last):
forcelayer.Error: nowhere.vox: no such file; check the path
)")
      .def(py::init<const std::filesystem::path&>(), given("path"))
      .def("__repr__",
           [](const Scene& s) {
             return "forcelayer.Scene(" + std::string(py::repr(py::str(s.path.string()))) + ")";
           })
      .def_readonly("path", &Scene::path, R"(The path of the file, as it was given.

>>> forcelayer.Scene("bay.vox").path.name
'bay.vox'
)")
      .def_property_readonly(
          "voxel_size_m", [](const Scene& s) { return s.map.voxel_size_m(); },
          R"(Edge of a voxel, meters.

>>> forcelayer.Scene("bay.vox").voxel_size_m
0.005
)")
      .def_property_readonly(
          "origin_voxel", [](const Scene& s) { return s.map.header().origin_voxel; },
          R"(Low corner of the box of voxels that are not free, in voxels from the world's origin.

>>> len(forcelayer.Scene("bay.vox").origin_voxel)
3
)")
      .def_property_readonly(
          "dims_voxels", [](const Scene& s) { return s.map.header().dims_voxels; },
          R"(Size, in voxels, of the bounding box of voxels that are not free.

>>> min(forcelayer.Scene("bay.vox").dims_voxels) > 0
True
)")
      .def_property_readonly(
          "stores_distances", [](const Scene& s) { return s.map.distances() != nullptr; },
          R"(Whether distances are stored. Without them no clearance is known.

>>> forcelayer.Scene("bay.vox").stores_distances
True
)")
      .def_property_readonly(
          "objects", &object_names,
          R"(Names of the scene's objects by their number; number 0 means no object.

>>> scene = forcelayer.Scene("bay.vox")
>>> scene.objects[0], len(scene.objects) > 1
('', True)
)")
      .def_property_readonly(
          "provenance", [](const Scene& s) { return std::string(s.map.provenance()); },
          R"(The inputs and options of the bake, as the text of a JSON object.

>>> import json
>>> json.loads(forcelayer.Scene("bay.vox").provenance)["voxel_size_m"]
0.005
)")
      .def(
          "sample",
          [](Scene& scene, const Doubles& points_m, unsigned threads) -> py::array {
            const auto rows = rows_of<3>(points_m, "points_m");
            auto answers = empty_rows<PointAnswer>(rows.size());
            const std::span<PointAnswer> out(answers.mutable_data(), rows.size());
            std::int64_t done = kAllDone;
            {
              const py::gil_scoped_release other_threads;
              done = scene.points.sample(rows, threads, out, nobody_interrupts);
            }
            check_done(done, "points_m", " is not finite");
            return answers;
          },
          given("points_m"), py::kw_only(), given("threads") = 0,
          R"(Samples the scene at points of the world, shape (n, 3), meters.

Returns a structured array with a row for each point:

    value             value of the voxel: 0 free, 1 interior, 2 surface (the force layer), 3 proximity
    known             False for a point beyond a side at which the scene was cropped
    distance_m        distance from the meshes, interpolated between stored distances; negative inside;
                      NaN where none is stored
    min_distance_m    lower bound of the distance from the meshes; 0 where none is proven
    gradient          gradient of the distance, away from the meshes, in world axes; NaN where no
                      distance is stored
    object            number of the nearest object, see `objects`; 0 where none is known

`threads`: 0 means all cores. Other Python threads run meanwhile.

>>> scene = forcelayer.Scene("bay.vox")
>>> scene.sample([[9.0, 9.0, 9.0]])["value"]  # far away all is free
array([0], dtype=uint8)
>>> scene.sample([[9.0, 9.0]])
Traceback (most recent call last):
forcelayer.Error: points_m: has the shape (1, 2); give an array of shape (n, 3)
)")
      .def(
          "query",
          [](Scene& scene, Part& part, const Doubles& poses, unsigned threads) {
            return ask_poses<PointCounts>(
                scene, part, poses, [threads](PoseBatch& batch, auto rows, auto out) {
                  return batch.count(rows, threads, out, nobody_interrupts);
                });
          },
          given("part"), given("poses"), py::kw_only(), given("threads") = 0,
          R"(Counts the points of the part by the value of their voxel, at each pose.

`poses`: shape (n, 7), world_from_part as x y z (meters) and a quaternion qw qx qy qz, which is
made unit. Returns a structured array with a row for each pose:

    interior, surface, proximity   points in voxels of value 1, 2 and 3
    outside_map                    True: a point lies beyond a side at which the scene was cropped

`threads`: 0 means all cores. Other Python threads run meanwhile.

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> far, seated = [9, 9, 9, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0, 0]
>>> counts = scene.query(part, [far, seated])
>>> counts["interior"][0] + counts["surface"][0] + counts["proximity"][0]
0
)")
      .def(
          "clearance",
          [](Scene& scene, Part& part, const Doubles& poses, unsigned threads) {
            return ask_poses<ClearanceAnswer>(
                scene, part, poses, [threads](PoseBatch& batch, auto rows, auto out) {
                  return batch.clearance(rows, threads, out, nobody_interrupts);
                });
          },
          given("part"), given("poses"), py::kw_only(), given("threads") = 0,
          R"(Proves a clearance between the exact surfaces of part and scene, at each pose.

The clearance is proven from the two files, as the runtime proves it for every frame. It holds at
these poses only, not between them. `poses`: as for query(). Returns a structured array with a row
for each pose:

    clearance_m       a lower bound, meters; NaN where nothing is known
    measured          False: no point is within reach of the stored distances, so the clearance may
                      be much larger
    nearest_object    number of the object nearest to `nearest_point_m`, see `objects`; 0: not known
    nearest_point_m   the nearest shell point, world; NaN where not measured
    interior, surface, proximity, outside_map   as for query(). If the scene has a standoff, the
                      points are counted by distance, not by voxel value

`threads`: 0 means all cores. Other Python threads run meanwhile.

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> answer = scene.clearance(part, [9, 9, 9, 1, 0, 0, 0])[0]
>>> bool(answer["measured"]), bool(answer["clearance_m"] > 0.01)
(False, True)
>>> scene.clearance(part, [0, 0, 0, 0, 0, 0, 0])
Traceback (most recent call last):
forcelayer.Error: poses: row 0 is not a pose: give finite x, y, z (m) and a nonzero quaternion
)")
      .def("check", &check_path, given("part"), given("t_s"), given("poses"),
           given("clearance_m") = 0.001, py::kw_only(), given("allow") = std::vector<std::string>{},
           py::arg("world_from_seat") = py::none(), given("threads") = 0,
           given("felt_seat") = false,
           R"(Checks, as `voxcheck` does, whether the part keeps a clearance along a path.

`t_s`: times, ascending, one for each pose. Between poses the centroid moves in a straight line and
the part turns, both at constant speed; the answer covers this motion, too. `allow`: names of objects
that may be near. `world_from_seat`: the pose in which the part is installed. While the part is in
its seat, the shell points can miss features narrower than twice the covering radius. So a path with
a seat gets the verdict "not clear", unless `felt_seat` is true. Then the seat is accepted if no
shell point goes deeper into an object than when installed. Returns a dict:

    verdict           "clear" or "not clear"
    clearance_m       proven along the whole path, in meters; objects of the seat do not count while
                      the part is in the seat
    min_clearance     where this clearance occurs: clearance_m, at_most_m (upper bound of the exact
                      clearance; None: not known), t_s, object, point_m; None if nothing is near
    violations        a list of dicts: from_s, to_s, clearance_m (proven between them), worst (as
                      min_clearance), pushed_into_seat (the part goes deeper into its seat than
                      when installed), seat_not_settled (shell points may miss what blocks the
                      part), object_inside (the part contains this object from the beginning on)
    seated            a list of dicts, one for each stretch in which only objects of the seat are
                      nearer than required: from_s, to_s, travel_m (in the stretch, no point
                      moves farther than this), clearance_m (proven for the stretch), nearest (as
                      min_clearance)
    curve             a structured array: from_s, to_s, clearance_m (to all objects, also in the seat)

`threads`: 0 means all cores; no answer depends on it. Other Python threads run meanwhile.

>>> scene, part = forcelayer.Scene("bay.vox"), forcelayer.Part("part.pshell")
>>> frames = forcelayer.replay(scene, part, "run.flr").frames
>>> answer = scene.check(part, frames["t_s"], frames["world_from_part"], 0.005)
>>> answer["verdict"], answer["violations"], answer["clearance_m"] > 0.005
('clear', [], True)
>>> scene.check(part, frames["t_s"], frames["world_from_part"], 0.0127)["violations"][0]["worst"]["object"]
'structure/bay_structure/floor/floor_beam_left'
)");
}

void bind_part(py::module_& module) {
  py::class_<Part, std::shared_ptr<Part>>(module, "Part", R"(A baked part: a `.pshell` file.

The whole file is checked when it is opened, its checksums too.

>>> part = forcelayer.Part("part.pshell")
>>> part
forcelayer.Part('part.pshell')
>>> part.points_m.shape == (part.point_count, 3)
True
)")
      .def(py::init<const std::filesystem::path&>(), given("path"))
      .def("__repr__",
           [](const Part& p) {
             return "forcelayer.Part(" + std::string(py::repr(py::str(p.path.string()))) + ")";
           })
      .def_readonly("path", &Part::path, R"(The path of the file, as it was given.

>>> forcelayer.Part("part.pshell").path.name
'part.pshell'
)")
      .def_property_readonly(
          "point_count", [](const Part& p) { return p.shell.view().point_count; },
          R"(Number of shell points.

>>> forcelayer.Part("part.pshell").point_count > 100
True
)")
      .def_property_readonly(
          "points_m",
          [](const Part& p) {
            const PshellView& v = p.shell.view();
            return columns_of(p, v.x, v.y, v.z);
          },
          R"(The shell points relative to `center_m`, in the part's axes: shape (n, 3), meters.

A view of the file, no copy; it cannot be written to.

>>> points = forcelayer.Part("part.pshell").points_m
>>> points.dtype, points.flags.owndata, points.flags.writeable
(dtype('float32'), False, False)
)")
      .def_property_readonly(
          "normals",
          [](const Part& p) {
            const PshellView& v = p.shell.view();
            return columns_of(p, v.nx, v.ny, v.nz);
          },
          R"(Inward unit normals of the points, shape (n, 3): a view of the file.

>>> bool(abs((forcelayer.Part("part.pshell").normals ** 2).sum(axis=1) - 1).max() < 1e-5)
True
)")
      .def_property_readonly(
          "areas_m2",
          [](const Part& p) {
            const PshellView& v = p.shell.view();
            return view_of(p, {static_cast<py::ssize_t>(v.point_count)}, {sizeof(float)},
                           v.weight_m2);
          },
          R"(Area that each point represents, m2, shape (n,): a view of the file.

>>> part = forcelayer.Part("part.pshell")
>>> bool(abs(part.areas_m2.sum() / part.area_m2 - 1) < 0.01)
True
)")
      .def_property_readonly(
          "center_m", [](const Part& p) { return vector_of(p.shell.header().center_m); },
          R"(The centroid, in the frame of the part's mesh.

>>> forcelayer.Part("part.pshell").center_m.shape
(3,)
)")
      .def_property_readonly(
          "area_m2", [](const Part& p) { return p.shell.header().area_m2; },
          R"(Area of the part's surface.

>>> forcelayer.Part("part.pshell").area_m2 > 0
True
)")
      .def_property_readonly(
          "covering_radius_m", [](const Part& p) { return p.shell.header().covering_radius_m; },
          R"(Proven: every point of the part's surface is at most this far from a shell point.

>>> forcelayer.Part("part.pshell").covering_radius_m < 0.005
True
)")
      .def_property_readonly(
          "bounding_radius_m", [](const Part& p) { return p.shell.header().bounding_radius_m; },
          R"(Radius of the sphere around `center_m` that contains all points.

>>> forcelayer.Part("part.pshell").bounding_radius_m > 0.01
True
)")
      .def_property_readonly(
          "provenance", [](const Part& p) { return std::string(p.shell.provenance()); },
          R"(The inputs and options of the bake, as the text of a JSON object.

>>> forcelayer.Part("part.pshell").provenance.startswith("{")
True
)");
}

// forcelayer.Error, with the text that a command prints behind its name.
void bind_error(py::module_& module) {
  static PyObject* const type = PyErr_NewExceptionWithDoc(
      "forcelayer.Error",
      R"(The error that a command would print: what is wrong, where, and how to fix it.

`code` is the error's number. `exit_status` is the exit status of a command that ends with this
error.

>>> try:
...     forcelayer.Part("bay.vox")
... except forcelayer.Error as error:
...     print(error.code, error.exit_status)
400 4
)",
      PyExc_Exception, nullptr);
  module.attr("Error") = py::handle(type);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Failure& failure) {
      const py::object error = py::handle(type)(failure.what());
      error.attr("code") = static_cast<int>(failure.code);
      error.attr("exit_status") = exit_status(failure.code);
      PyErr_SetObject(type, error.ptr());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_forcelayer, module) {
  PYBIND11_NUMPY_DTYPE(PointAnswer, value, known, distance_m, min_distance_m, gradient, object);
  PYBIND11_NUMPY_DTYPE(PointCounts, interior, surface, proximity, outside_map);
  PYBIND11_NUMPY_DTYPE(clearance::CurvePiece, from_s, to_s, clearance_m);
  PYBIND11_NUMPY_DTYPE(ClearanceAnswer, clearance_m, measured, nearest_object, nearest_point_m,
                       interior, surface, proximity, outside_map);
  module.attr("__version__") = FORCELAYER_VERSION;
  bind_error(module);
  bind_part(module);
  bind_scene(module);
  bind_simulation(module);
}

}  // namespace forcelayer::python
