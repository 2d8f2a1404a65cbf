// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "partpose/core/depth_image.hpp"
#include "partpose/core/error.hpp"
#include "partpose/core/pose.hpp"
#include "partpose/core/progress.hpp"

#include <nanobind/eigen/dense.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstring>
#include <span>

/// How NumPy arrays, poses and callbacks cross the border. Wrong arrays give an Error that says what would be right,
/// not a list of signatures.
namespace partpose::python {

namespace nb = nanobind;
using namespace nb::literals;

using AnyArray = nb::ndarray<nb::ro, nb::device::cpu>;

/// "float64 of shape (480, 640)".
std::string what_array_it_is(const AnyArray& array);

/// N x 3 numbers: seen in place when they are contiguous 32-bit floats, copied otherwise.
class Points {
 public:
  explicit Points(AnyArray array);
  std::span<const Eigen::Vector3f> span() const { return view_; }
  std::vector<Eigen::Vector3f> copy() const { return {view_.begin(), view_.end()}; }

 private:
  AnyArray array_;
  std::vector<Eigen::Vector3f> copy_;
  std::span<const Eigen::Vector3f> view_;
};

/// N numbers as 32-bit floats, in the same way.
class Floats {
 public:
  explicit Floats(AnyArray array);
  std::span<const float> span() const { return view_; }

 private:
  AnyArray array_;
  std::vector<float> copy_;
  std::span<const float> view_;
};

/// Height x width numbers, uint16 or floating point.
struct DepthPixels {
  AnyArray array;
  /// In mm; NaN and infinity become 0, no value. Throws Error for negative depths.
  DepthImage image(double depth_scale_mm) const;
};

/// Throws Error unless the matrix is a rigid motion.
Eigen::Isometry3d checked_pose(const Eigen::Matrix4d& matrix);

/// A Python callable that long work calls, or None.
struct Callback {
  std::shared_ptr<nb::object> function;  ///< always there
  bool wanted = false;                   ///< it is not None
};

/// An array that owns what the vector held.
template <typename Scalar>
nb::ndarray<nb::numpy, Scalar, nb::shape<-1>> array_of(std::vector<Scalar> values) {
  auto* kept = new std::vector<Scalar>(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<Scalar>*>(p); });
  return {kept->data(), {kept->size()}, owner};
}
template <typename Scalar, int Columns>
auto rows_of(std::vector<Eigen::Matrix<Scalar, Columns, 1>> values) {
  using Values = std::vector<Eigen::Matrix<Scalar, Columns, 1>>;
  auto* kept = new Values(std::move(values));
  const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<Values*>(p); });
  return nb::ndarray<nb::numpy, Scalar, nb::shape<-1, Columns>>(reinterpret_cast<Scalar*>(kept->data()),
                                                                {kept->size(), std::size_t{Columns}}, owner);
}

/// Read-only views of what `owner` holds; they keep it alive.
using PointsView = nb::ndarray<nb::numpy, const float, nb::shape<-1, 3>>;
using FloatsView = nb::ndarray<nb::numpy, const float, nb::shape<-1>>;
using ImageView = nb::ndarray<nb::numpy, const float, nb::shape<-1, -1>>;
PointsView view_of(const std::vector<Eigen::Vector3f>& points, nb::handle owner);
FloatsView view_of(std::span<const float> values, nb::handle owner);

}  // namespace partpose::python

namespace nanobind::detail {

/// Poses are 4 x 4 float64 arrays.
template <>
struct type_caster<Eigen::Isometry3d> {
  using Matrix = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  using Inner = make_caster<Matrix>;
  static constexpr auto Name = Inner::Name;
  template <typename T>
  using Cast = Eigen::Isometry3d;
  template <typename T>
  static constexpr bool can_cast() {
    return true;
  }
  bool from_python(handle source, uint8_t flags, cleanup_list* cleanup) noexcept {
    return inner.from_python(source, flags, cleanup);
  }
  static handle from_cpp(const Eigen::Isometry3d& pose, rv_policy, cleanup_list* cleanup) noexcept {
    return Inner::from_cpp(Matrix(pose.matrix()), rv_policy::move, cleanup);
  }
  explicit operator Eigen::Isometry3d() { return partpose::python::checked_pose(inner.value); }
  Inner inner;
};

template <typename T>
struct array_argument_caster {
  template <typename>
  using Cast = T;
  template <typename>
  static constexpr bool can_cast() {
    return true;
  }
  bool from_python(handle source, uint8_t flags, cleanup_list* cleanup) noexcept {
    return inner.from_python(source, flags, cleanup);
  }
  explicit operator T() { return T{inner.value}; }
  make_caster<partpose::python::AnyArray> inner;
};
template <>
struct type_caster<partpose::python::Points> : array_argument_caster<partpose::python::Points> {
  static constexpr auto Name =
      const_name("typing.Annotated[numpy.typing.NDArray[numpy.floating[typing.Any]], dict(shape=(None, 3))]");
};
template <>
struct type_caster<partpose::python::Floats> : array_argument_caster<partpose::python::Floats> {
  static constexpr auto Name =
      const_name("typing.Annotated[numpy.typing.NDArray[numpy.floating[typing.Any]], dict(shape=(None,))]");
};
template <>
struct type_caster<partpose::python::DepthPixels> : array_argument_caster<partpose::python::DepthPixels> {
  static constexpr auto Name = const_name(
      "typing.Annotated[numpy.typing.NDArray[numpy.uint16 | numpy.float32 | numpy.float64], dict(shape=(None, None))]");
};

template <>
struct type_caster<partpose::python::Callback> {
  NB_TYPE_CASTER(partpose::python::Callback, const_name("collections.abc.Callable[[str, int, int], object]"))
  bool from_python(handle source, uint8_t, cleanup_list*) noexcept {
    if (!source.is_none() && !PyCallable_Check(source.ptr())) return false;
    value.function = std::shared_ptr<object>(new object(borrow<object>(source)), [](object* p) {
      gil_scoped_acquire gil;
      delete p;
    });
    value.wanted = !source.is_none();
    return true;
  }
};

}  // namespace nanobind::detail
