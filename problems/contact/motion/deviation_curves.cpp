#include "problems/contact/motion/deviation_curves.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr int kOrder = 4;  // cubic

// Values and slopes of the four cubic B-splines that are not zero at u in [0, 1] between two knots, over
// knots one apart.
struct LocalSplines {
  std::array<double, kOrder> value;
  std::array<double, kOrder> slope;
};

LocalSplines SplinesAt(double u) {
  const double v = 1 - u;
  return {{v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6,
           u * u * u / 6},
          {-v * v / 2, (9 * u * u - 12 * u) / 6, -(9 * v * v - 12 * v) / 6, u * u / 2}};
}

// Between equidistant knots half a period of the cutoff apart.
int Intervals(double length, double cutoff) {
  return std::max(1, static_cast<int>(std::ceil(2 * cutoff * length - 1e-9)));
}

CurveBasis SplinesAt(const std::vector<double>& times, double from, double to, int intervals,
                     double stretch) {
  const double spacing = (to - from) / intervals;
  const auto rows = static_cast<Eigen::Index>(times.size());
  CurveBasis basis{Matrix::Zero(rows, intervals + kOrder - 1), Matrix::Zero(rows, intervals + kOrder - 1)};
  for (Eigen::Index t = 0; t < rows; ++t) {
    const double time = times[static_cast<std::size_t>(t)];
    const double at = std::clamp((time - from) / spacing, 0.0, static_cast<double>(intervals));
    const int interval = std::min(static_cast<int>(at), intervals - 1);
    const LocalSplines local = SplinesAt(at - interval);
    const bool inside = time >= from && time <= to;
    for (int k = 0; k < kOrder; ++k) {
      basis.value(t, interval + k) = local.value[static_cast<std::size_t>(k)];
      if (inside) basis.rate(t, interval + k) = stretch * local.slope[static_cast<std::size_t>(k)] / spacing;
    }
  }
  return basis;
}

}  // namespace

double CurveSpectrum::Correlation(double lag) const {
  const double s = std::abs(lag) / correlation_time;
  const double of_noise = lag / noise_time;
  return (1 - roughness) * std::exp(-0.5 * s * s) + roughness * (1 + s) * std::exp(-s) +
         noise * std::exp(-0.5 * of_noise * of_noise);
}

bool CurveSpectrum::operator==(const CurveSpectrum& other) const {
  return correlation_time == other.correlation_time && roughness == other.roughness && scale == other.scale &&
         noise == other.noise && noise_time == other.noise_time;
}

DeviationCurves::DeviationCurves(const std::vector<double>& times, double from, double to, double cutoff,
                                 double stretch) {
  constexpr int kGrid = 200;
  const int intervals = Intervals(to - from, cutoff);
  spacing_ = (to - from) / intervals;
  splines_ = SplinesAt(times, from, to, intervals, stretch);
  std::vector<double> grid;
  for (int i = 0; i < kGrid; ++i) grid.push_back(from + (i + 0.5) * (to - from) / kGrid);
  on_grid_ = SplinesAt(grid, from, to, intervals, stretch).value;
}

Matrix DeviationCurves::Root(const CurveSpectrum& spectrum) const {
  const Eigen::Index count = splines_.value.cols();
  Matrix covariance(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j < count; ++j)
      covariance(i, j) = spectrum.Correlation(spacing_ * static_cast<double>(i - j));
  }
  // Without power at high frequencies it is singular but for rounding.
  constexpr double kRidge = 1e-9;
  covariance.diagonal().array() += kRidge;
  const Matrix root = Eigen::LLT<Matrix>(covariance).matrixL();
  // Splines smooth what their weights do; the curve's mean variance is to be that of the prior.
  const double unit =
      std::sqrt((1 + spectrum.noise) * static_cast<double>(on_grid_.rows())) / (on_grid_ * root).norm();
  return spectrum.scale * unit * root;
}

Vector DeviationCurves::SameCurve(const Vector& weights, const CurveSpectrum& from,
                                  const CurveSpectrum& to) const {
  return Root(to).triangularView<Eigen::Lower>().solve(Root(from) * weights);
}

Vector DeviationCurves::Carried(const Vector& weights, const CurveSpectrum& from,
                                const CurveSpectrum& to) const {
  const double loose = 0.01 * to.scale;  // to which the curves agree
  const Matrix root = on_grid_ * Root(to);
  const Vector curve = on_grid_ * (Root(from) * weights);
  Matrix normal = root.transpose() * root;
  normal.diagonal().array() += loose * loose * static_cast<double>(on_grid_.rows());
  return normal.llt().solve(root.transpose() * curve);
}

std::shared_ptr<const CurveBasis> DeviationCurves::With(const CurveSpectrum& spectrum) const {
  constexpr std::size_t kMostKept = 4;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& one) { return one.spectrum == spectrum; });
  if (found != kept_.end()) return found->basis;
  if (kept_.size() == kMostKept) kept_.erase(kept_.begin());
  const Matrix root = Root(spectrum);
  kept_.push_back({spectrum, std::make_shared<const CurveBasis>(
                                 CurveBasis{splines_.value * root, splines_.rate * root})});
  return kept_.back().basis;
}

}  // namespace sinew
