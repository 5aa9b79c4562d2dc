// Between numpy's arrays and those of the library. Rows of numpy are columns here, so that (n, 3) of C order
// and 3 × n of Eigen are the same bytes.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "lobe/types.h"

namespace lobe::python {

namespace py = pybind11;

// Copies of what a caller gives. All throw InputError, at `place`, for another shape or for what is not
// numbers.
Mat3X<double> columns3(const py::handle& array, const std::string& place);   // (n, 3)
Eigen::MatrixXi integers(const py::handle& array, const std::string& place,  // (n, columns), transposed
                         int columns);
// Indices below `count`: whole numbers, or a mask of `count` booleans.
std::vector<Index> indices(const py::handle& array, const std::string& place, Index count);
Vec3d vector3(const py::handle& array, const std::string& place);

// A view that nobody can write to, of memory that `owner` keeps.
template <class T>
py::array read_only(const T* data, std::vector<py::ssize_t> shape, const py::handle& owner) {
  py::array view(py::dtype::of<T>(), std::move(shape), data, owner);
  py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return view;
}
template <class Real>
py::array read_only(const Mat3X<Real>& columns, const py::handle& owner) {  // (n, 3)
  return read_only(columns.data(), {columns.cols(), 3}, owner);
}
// A copy that belongs to the caller.
template <class Real>
py::array copied(const Mat3X<Real>& columns) {  // (n, 3)
  return py::array(py::dtype::of<Real>(), {columns.cols(), py::ssize_t{3}}, columns.data());
}
inline py::array copied(const Vec3d& v) {
  return py::array(py::dtype::of<double>(), {py::ssize_t{3}}, v.data());
}

}  // namespace lobe::python
