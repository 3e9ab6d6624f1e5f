#pragma once

#include <Eigen/Core>

// The loops under Eigen's products of matrices of doubles and under its triangular solutions, which each file that
// multiplies would compile anew. Here they are declared; matrix_products.cpp alone compiles them, fully optimised,
// whatever the file that calls them is. Precompiled headers include this (cmake/precompiled/library.h), no other file
// need, and without it everything computes the same. The names are Eigen's own in version 3.4.0: with another, nothing
// is declared and the list is empty.
#if EIGEN_WORLD_VERSION == 3 && EIGEN_MAJOR_VERSION == 4 && EIGEN_MINOR_VERSION == 0

namespace Eigen::internal {
using DoubleProducts = gebp_traits<double, double>;
template <int order>
using DoublesIn = const_blas_data_mapper<double, Index, order>;
using DoublesOut = blas_data_mapper<double, Index, ColMajor, Unaligned, 1>;
}  // namespace Eigen::internal

// NOLINTBEGIN(cppcoreguidelines-macro-usage): one list, declared here and defined in matrix_products.cpp.
#define MBK_PACKED_LEFT(order)                                                                           \
  struct gemm_pack_lhs<double, Index, DoublesIn<order>, DoubleProducts::mr, DoubleProducts::LhsProgress, \
                       DoubleProducts::LhsPacket4Packing, order, false, false>
#define MBK_PACKED_RIGHT(order) \
  struct gemm_pack_rhs<double, Index, DoublesIn<order>, DoubleProducts::nr, order, false, false>
#define MBK_MATRIX_BY_MATRIX(left, right) \
  struct general_matrix_matrix_product<Index, double, left, false, double, right, false, ColMajor, 1>
#define MBK_MATRIX_BY_VECTOR(left, right) \
  struct general_matrix_vector_product<Index, double, DoublesIn<left>, left, false, double, DoublesIn<right>, false, 0>
#define MBK_TRIANGULAR_SOLUTION(mode, order) \
  struct triangular_solve_matrix<double, Index, OnTheLeft, mode, false, order, ColMajor, 1>
#define MBK_MATRIX_PRODUCTS(instantiate)                                                                           \
  instantiate struct gebp_kernel<double, double, Index, DoublesOut, DoubleProducts::mr, DoubleProducts::nr, false, \
                                 false>;                                                                           \
  instantiate struct gemm_pack_rhs<double, Index, DoublesOut, DoubleProducts::nr, ColMajor, false, true>;          \
  instantiate MBK_PACKED_LEFT(ColMajor);                                                                           \
  instantiate MBK_PACKED_LEFT(RowMajor);                                                                           \
  instantiate MBK_PACKED_RIGHT(ColMajor);                                                                          \
  instantiate MBK_PACKED_RIGHT(RowMajor);                                                                          \
  instantiate MBK_MATRIX_BY_MATRIX(ColMajor, ColMajor);                                                            \
  instantiate MBK_MATRIX_BY_MATRIX(ColMajor, RowMajor);                                                            \
  instantiate MBK_MATRIX_BY_MATRIX(RowMajor, ColMajor);                                                            \
  instantiate MBK_MATRIX_BY_VECTOR(ColMajor, ColMajor);                                                            \
  instantiate MBK_MATRIX_BY_VECTOR(ColMajor, RowMajor);                                                            \
  instantiate MBK_MATRIX_BY_VECTOR(RowMajor, ColMajor);                                                            \
  instantiate MBK_MATRIX_BY_VECTOR(RowMajor, RowMajor);                                                            \
  instantiate MBK_TRIANGULAR_SOLUTION(Lower, ColMajor);                                                            \
  instantiate MBK_TRIANGULAR_SOLUTION(Upper, ColMajor);                                                            \
  instantiate MBK_TRIANGULAR_SOLUTION(Lower, RowMajor);                                                            \
  instantiate MBK_TRIANGULAR_SOLUTION(Upper, RowMajor);
// NOLINTEND(cppcoreguidelines-macro-usage)

namespace Eigen::internal {
MBK_MATRIX_PRODUCTS(extern template)
}  // namespace Eigen::internal

#endif
