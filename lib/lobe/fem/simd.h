// The thin vector layer: Pack<Real> holds as many values as one register of the instruction set this unit is
// compiled for. Eigen's fixed-size matrices take it as a scalar, so that every formula of this folder is
// written once, for float, double and packs of either.
#pragma once

#include <Eigen/Core>
#include <experimental/simd>

namespace lobe {

template <class Real>
using Pack = std::experimental::native_simd<Real>;

}  // namespace lobe

namespace Eigen {

template <class Scalar, class Abi>
struct NumTraits<std::experimental::simd<Scalar, Abi>>
    : GenericNumTraits<std::experimental::simd<Scalar, Abi>> {
  using Real = std::experimental::simd<Scalar, Abi>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};

}  // namespace Eigen
