#include "problems/contact/steps/load_estimate.h"

#include <Eigen/Cholesky>
#include <set>

namespace sinew {

LoadEstimate EstimateLoad(const std::vector<LoadRow>& rows, std::size_t instants) {
  constexpr Eigen::Index kSize = 6;
  LoadEstimate estimate{std::vector<ContactLoad>(instants, ContactLoad::Zero()),
                        std::vector<Eigen::Matrix<double, 6, 6>>(instants)};
  for (auto& covariance : estimate.covariance) covariance.setZero();
  std::vector<Eigen::Index> place(instants, -1);
  std::set<int> known;
  for (const LoadRow& row : rows) {
    for (const LoadRow::Term& term : row.terms) known.insert(term.instant);
  }
  Eigen::Index next = 0;
  for (const int instant : known) {
    place[static_cast<std::size_t>(instant)] = next;
    next += kSize;
  }
  const Eigen::Index unknowns = next;
  Matrix normal = Matrix::Zero(unknowns, unknowns);
  Vector right = Vector::Zero(unknowns);
  for (const LoadRow& row : rows) {
    for (const LoadRow::Term& a : row.terms) {
      const Eigen::Index at = place[static_cast<std::size_t>(a.instant)];
      const ContactLoad scaled = a.factors / (row.deviation * row.deviation);
      right.segment<kSize>(at) += row.measured * scaled;
      for (const LoadRow::Term& b : row.terms)
        normal.block<kSize, kSize>(at, place[static_cast<std::size_t>(b.instant)]) +=
            scaled * b.factors.transpose();
    }
  }
  const Eigen::LLT<Matrix> factor(normal);
  const Vector load = factor.solve(right);
  const Matrix covariance = factor.solve(Matrix::Identity(unknowns, unknowns));
  for (const int instant : known) {
    const auto t = static_cast<std::size_t>(instant);
    estimate.load[t] = load.segment<kSize>(place[t]);
    estimate.covariance[t] = covariance.block<kSize, kSize>(place[t], place[t]);
  }
  return estimate;
}

}  // namespace sinew
