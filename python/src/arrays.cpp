#include "arrays.h"

#include <algorithm>
#include <cmath>

#include "lobe/error.h"

namespace lobe::python {
namespace {

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) text += (i ? ", " : "") + std::to_string(array.shape(i));
  return text + ")";
}

py::array array_of(const py::handle& value, const std::string& place) {
  py::array array = py::array::ensure(py::reinterpret_borrow<py::object>(value));
  if (!array) {
    PyErr_Clear();
    throw InputError(place, "not an array");
  }
  return array;
}

py::array_t<double, py::array::c_style | py::array::forcecast> numbers(const py::array& array,
                                                                       const std::string& place) {
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    throw InputError(place,
                     "an array of " + std::string(py::str(array.dtype())) + ", must be of real numbers");
  return array;
}

}  // namespace

Mat3X<double> columns3(const py::handle& value, const std::string& place) {
  const py::array array = array_of(value, place);
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw InputError(place, "an array of shape " + shape_of(array) + ", must be (n, 3)");
  const auto of = numbers(array, place);
  return Eigen::Map<const Mat3X<double>>(of.data(), 3, of.shape(0));
}

Eigen::MatrixXi integers(const py::handle& value, const std::string& place, int columns) {
  const py::array array = array_of(value, place);
  if (array.ndim() != 2 || array.shape(1) != columns)
    throw InputError(
        place, "an array of shape " + shape_of(array) + ", must be (n, " + std::to_string(columns) + ")");
  if (const char kind = array.dtype().kind(); kind != 'i' && kind != 'u')
    throw InputError(place,
                     "an array of " + std::string(py::str(array.dtype())) + ", must be of whole numbers");
  const py::array_t<long long, py::array::c_style | py::array::forcecast> of = array;
  Eigen::MatrixXi result(columns, of.shape(0));
  for (py::ssize_t i = 0; i < of.size(); ++i) {
    const long long index = of.data()[i];
    if (index < 0 || index > std::numeric_limits<Index>::max())
      throw InputError(place,
                       std::to_string(index) + " in row " + std::to_string(i / columns) + " is no index");
    result(i) = static_cast<int>(index);
  }
  return result;
}

std::vector<Index> indices(const py::handle& value, const std::string& place, Index count) {
  const py::array array = array_of(value, place);
  std::vector<Index> result;
  if (array.ndim() != 1) throw InputError(place, "an array of shape " + shape_of(array) + ", must be (n,)");
  if (array.dtype().kind() == 'b') {
    if (array.shape(0) != count)
      throw InputError(
          place, "a mask of " + std::to_string(array.shape(0)) + ", must be of " + std::to_string(count));
    const py::array_t<bool, py::array::c_style | py::array::forcecast> mask = array;
    for (Index i = 0; i < count; ++i)
      if (mask.data()[i]) result.push_back(i);
    return result;
  }
  if (array.shape(0) == 0) return result;
  const char kind = array.dtype().kind();
  if (kind != 'i' && kind != 'u')
    throw InputError(place, "an array of " + std::string(py::str(array.dtype())) +
                                ", must be of whole numbers or a mask of booleans");
  const py::array_t<long long, py::array::c_style | py::array::forcecast> of = array;
  for (py::ssize_t i = 0; i < of.size(); ++i) {
    const long long index = of.data()[i];
    if (index < 0 || index >= count)
      throw InputError(place, std::to_string(index) + ", must be 0 … " + std::to_string(count - 1));
    result.push_back(static_cast<Index>(index));
  }
  return result;
}

Vec3d vector3(const py::handle& value, const std::string& place) {
  const py::array array = array_of(value, place);
  if (array.ndim() != 1 || array.shape(0) != 3)
    throw InputError(place, "an array of shape " + shape_of(array) + ", must be three numbers");
  const auto of = numbers(array, place);
  const Vec3d v(of.data()[0], of.data()[1], of.data()[2]);
  if (!v.allFinite()) throw InputError(place, "must be finite");
  return v;
}

}  // namespace lobe::python
