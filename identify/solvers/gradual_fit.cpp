#include "identify/solvers/gradual_fit.h"

#include "identify/solvers/local_fit.h"

namespace sinew::solvers {
namespace {

class Share final : public RowTransform {
 public:
  explicit Share(double share) : share_(share) {}
  void Apply(int /*train_block*/, Eigen::Ref<Matrix> rows) const override { rows *= share_; }
  void AddTo(Digest& digest) const override { digest.Add(share_); }

 private:
  double share_;
};

}  // namespace

Vector FitGradually(LeastSquares& fit, const Vector& start, const std::vector<double>& shares,
                    long evaluations) {
  constexpr double kRough = 1e-3;  // relative change of the cost at which a search on the way ends
  Vector x = start;
  for (const double share : shares) {
    const Share scaled(share);
    fit.set_transform(&scaled);
    LocalFit search(fit);
    const auto outcome = search.Minimize(x, -1, {0, kRough}, evaluations);
    fit.set_transform(nullptr);
    if (outcome.failure.empty()) x = outcome.x;
  }
  return x;
}

}  // namespace sinew::solvers
