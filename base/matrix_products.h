// The loops of Eigen behind products of matrices of double, which every file that multiplies two matrices
// would compile again: here they are declared only, and compiled once in matrix_products.cpp.
#pragma once

#include <Eigen/Core>

// The block sizes are those of SSE2, the compiler's default for x86-64. With other instructions (a user's
// -march=native) Eigen has other sizes, and each file compiles its own.
#if defined(EIGEN_VECTORIZE_SSE2) && !defined(EIGEN_VECTORIZE_AVX)
#define SINEW_MATRIX_PRODUCTS_COMPILED_ONCE

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // of Packet2d
namespace Eigen::internal {                            // NOLINT(readability-identifier-naming): Eigen's

extern template struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor, 0, 1>, 4,
                                   4>;
extern template struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>, 4, 2,
                                     Packet2d, ColMajor>;
extern template struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>, 4,
                                     ColMajor>;
extern template struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, RowMajor>, 4, 2,
                                     Packet2d, RowMajor>;
extern template struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, RowMajor>, 4,
                                     RowMajor>;
extern template struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, ColMajor>, ColMajor, false, double,
    const_blas_data_mapper<double, Index, RowMajor>, false>;
extern template struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, ColMajor>, ColMajor, false, double,
    const_blas_data_mapper<double, Index, ColMajor>, false>;
extern template struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, RowMajor>, RowMajor, false, double,
    const_blas_data_mapper<double, Index, ColMajor>, false>;
extern template struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, RowMajor>, RowMajor, false, double,
    const_blas_data_mapper<double, Index, RowMajor>, false, BuiltIn>;
extern template void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&, Index&, Index&,
                                                                                     Index);
extern template void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&, Index&, Index&,
                                                                                     Index);

}  // namespace Eigen::internal
#pragma GCC diagnostic pop

#endif
