// Open files, exceptions and arrays, for both sources of the module.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/python/pose_batch.h"

namespace forcelayer::python {

namespace py = pybind11;

// An Error on its way to Python, where it becomes forcelayer.Error with the commands' text.
class Failure : public std::runtime_error {
 public:
  explicit Failure(Error error) : std::runtime_error(to_line(error)), code(error.code) {}
  ErrorCode code;
};

template <typename T>
T take(Result<T> result) {
  if (!result) throw Failure(result.error());
  return std::move(*result);
}
inline void check(const Status& status) {
  if (!status) throw Failure(status.error());
}

struct Part : std::enable_shared_from_this<Part> {
  explicit Part(const std::filesystem::path& file);
  std::filesystem::path path;
  Pshell shell;
};

class Scene : public std::enable_shared_from_this<Scene> {
 public:
  explicit Scene(const std::filesystem::path& file);

  // Answers for poses of a part. The batches of the last parts are kept.
  std::shared_ptr<PoseBatch> poses_of(Part& part);

  const std::filesystem::path path;
  const Voxmap map;
  PointBatch points;

 private:
  struct Asked {
    std::weak_ptr<Part> part;
    std::shared_ptr<PoseBatch> batch;  // refers to the part's shell: unusable once the part is gone
  };
  std::vector<Asked> asked_;
};

class Stepper;
struct Moment;
struct Replay;

// Rows of numbers. An array of doubles is read in place; other types are converted.
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

// An argument that must not be None.
inline py::arg given(const char* name) { return py::arg(name).none(false); }

}  // namespace forcelayer::python

namespace pybind11::detail {

// An object of this module: neither None, which pybind11 would hand over as a null pointer, nor one
// that no __init__() has made (Scene.__new__(Scene)), for which it would make memory without
// content.
template <typename T>
struct MadeCaster : type_caster_base<T> {
  bool load(handle source, bool convert) {
    const type_info* const type = get_type_info(typeid(T));
    if (!PyObject_TypeCheck(source.ptr(), type->type) || !reinterpret_cast<instance*>(source.ptr())
                                                              ->get_value_and_holder(type)
                                                              .holder_constructed()) {
      return false;
    }
    return type_caster_base<T>::load(source, convert);
  }
};
template <>
struct type_caster<forcelayer::python::Scene> : MadeCaster<forcelayer::python::Scene> {};
template <>
struct type_caster<forcelayer::python::Part> : MadeCaster<forcelayer::python::Part> {};
template <>
struct type_caster<forcelayer::python::Stepper> : MadeCaster<forcelayer::python::Stepper> {};
template <>
struct type_caster<forcelayer::python::Moment> : MadeCaster<forcelayer::python::Moment> {};
template <>
struct type_caster<forcelayer::python::Replay> : MadeCaster<forcelayer::python::Replay> {};

}  // namespace pybind11::detail

// As for other arrays, without the empty one that is made for an argument before it is read.
template <>
struct pybind11::detail::type_caster<forcelayer::python::Doubles> {
  using Array = forcelayer::python::Doubles;
  static constexpr auto name = handle_type_name<Array>::name;
  template <typename T>
  using cast_op_type = movable_cast_op_type<T>;
  bool load(handle source, bool convert) {
    if (source.is_none() || (!convert && !Array::check_(source))) return false;
    const auto any = pybind11::array::ensure(source);
    if (!any) return false;
    if (any.dtype().kind() == 'c') throw type_error("complex numbers are not valid coordinates");
    if (isinstance<pybind11::array>(source) && hasattr(source, "mask")) {
      throw type_error("the array is masked: give the .data of the array, or fill the array first");
    }
    array = Array::ensure(any);
    return static_cast<bool>(*array);
  }
  operator Array*() { return &*array; }
  operator Array&() { return *array; }
  operator Array&&() && { return std::move(*array); }
  std::optional<Array> array;
};

namespace forcelayer::python {

// The rows of an array of shape (n, kColumns), or (kColumns,) for one. Throws Failure, kUsage.
template <std::size_t kColumns>
std::span<const std::array<double, kColumns>> rows_of(const Doubles& array, const char* name) {
  const bool one = array.ndim() == 1 && array.shape(0) == kColumns;
  if (!one && !(array.ndim() == 2 && array.shape(1) == kColumns)) {
    std::string shape;
    for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
      shape += (axis == 0 ? "" : ", ") + std::to_string(array.shape(axis));
    }
    throw Failure({ErrorCode::kUsage, "", name, "has the shape (" + shape + ")",
                   "give an array of shape (n, " + std::to_string(kColumns) + ")"});
  }
  const auto* rows = reinterpret_cast<const std::array<double, kColumns>*>(array.data());
  return {rows, one ? 1 : static_cast<std::size_t>(array.shape(0))};
}

// The only row of an array of shape (kColumns,).
template <std::size_t kColumns>
const std::array<double, kColumns>& row_of(const Doubles& array, const char* name) {
  if (array.ndim() == 1) return rows_of<kColumns>(array, name)[0];
  throw Failure({ErrorCode::kUsage, "", name, "is not a single row",
                 "give " + std::to_string(kColumns) + " numbers"});
}

// `count` rows to be filled in. The padding between their fields is zero, so equal rows have equal
// bytes.
template <typename Row>
py::array_t<Row> empty_rows(std::size_t count) {
  py::array_t<Row> rows(static_cast<py::ssize_t>(count));
  std::memset(static_cast<void*>(rows.mutable_data()), 0, count * sizeof(Row));
  return rows;
}

// A pose, its quaternion made unit. Throws Failure, kUsage.
Pose pose_of(const std::array<double, 7>& numbers, const std::string& name);

// Whether nobody pressed Ctrl-C. For work that has released the interpreter lock: takes it to ask.
bool nobody_interrupts();
// Throws where the work stopped: Ctrl-C's exception, or Failure where `done` is the number of a row
// that is no pose or point.
void check_done(std::int64_t done, const char* name, const char* what);
inline constexpr const char* kNoPose =
    " is not a pose: give finite x, y, z (m) and a nonzero quaternion";

void bind_simulation(py::module_& module);

}  // namespace forcelayer::python
