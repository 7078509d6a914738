#include "base/matrix_products.h"

#ifdef SINEW_MATRIX_PRODUCTS_COMPILED_ONCE

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"  // of Packet2d
namespace Eigen::internal {                            // NOLINT(readability-identifier-naming): Eigen's

template struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor, 0, 1>, 4, 4>;
template struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>, 4, 2, Packet2d,
                              ColMajor>;
template struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>, 4, ColMajor>;
template struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, RowMajor>, 4, 2, Packet2d,
                              RowMajor>;
template struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, RowMajor>, 4, RowMajor>;
template struct general_matrix_vector_product<Index, double, const_blas_data_mapper<double, Index, ColMajor>,
                                              ColMajor, false, double,
                                              const_blas_data_mapper<double, Index, RowMajor>, false>;
template struct general_matrix_vector_product<Index, double, const_blas_data_mapper<double, Index, ColMajor>,
                                              ColMajor, false, double,
                                              const_blas_data_mapper<double, Index, ColMajor>, false>;
template struct general_matrix_vector_product<Index, double, const_blas_data_mapper<double, Index, RowMajor>,
                                              RowMajor, false, double,
                                              const_blas_data_mapper<double, Index, ColMajor>, false>;
template struct general_matrix_vector_product<
    Index, double, const_blas_data_mapper<double, Index, RowMajor>, RowMajor, false, double,
    const_blas_data_mapper<double, Index, RowMajor>, false, BuiltIn>;
template void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&, Index&, Index&, Index);
template void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&, Index&, Index&, Index);

}  // namespace Eigen::internal
#pragma GCC diagnostic pop

#endif
