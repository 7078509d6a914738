#include "identify/uncertainty/covariance.h"

#include <algorithm>
#include <cmath>

#include "identify/statistics/distributions.h"

namespace sinew::uncertainty {
namespace {

// Andrews, Monahan 1992 bound the autoregression, so that recolouring stays finite: 1 / (1 - 0.97) = 33.
constexpr double kLargestCorrelation = 0.97;
constexpr Eigen::Index kCosines = 12;  // of all blocks together, where scores are correlated beyond that
constexpr double kNormal95 = 1.959964;

/// Consecutive rows of one block.
struct Span {
  Eigen::Index first = 0;
  Eigen::Index count = 0;
};

/// Lag-one autocorrelation of each column, over all spans [k].
Vector UnboundedLagOne(const Matrix& series, const std::vector<Span>& spans) {
  Vector correlation = Vector::Zero(series.cols());
  for (Eigen::Index j = 0; j < series.cols(); ++j) {
    double pairs = 0;
    double squares = 0;
    for (const Span& s : spans) {
      if (s.count < 2) continue;
      const auto from = series.col(j).segment(s.first, s.count - 1);
      pairs += from.dot(series.col(j).segment(s.first + 1, s.count - 1));
      squares += from.squaredNorm();
    }
    if (squares > 0) correlation[j] = pairs / squares;
  }
  return correlation;
}

/// The same within the bound.
Vector LagOne(const Matrix& series, const std::vector<Span>& spans) {
  return UnboundedLagOne(series, spans).cwiseMax(-kLargestCorrelation).cwiseMin(kLargestCorrelation);
}

/// Number of lags for the Bartlett kernel over n rows.
Eigen::Index AutomaticLag(const Matrix& series, const std::vector<Span>& spans, double n) {
  const Eigen::ArrayXd rho = LagOne(series, spans).array();
  // Every column counts alike: weights of one over the square of its variance.
  const double numerator = (4 * rho.square() / ((1 - rho).pow(6) * (1 + rho).square())).sum();
  const double denominator = (1 / (1 - rho).pow(4)).sum();
  const double andrews = 1.1447 * std::cbrt(numerator / denominator * n);
  const double newey_west = 4 * std::pow(n / 100, 2.0 / 9);
  return static_cast<Eigen::Index>(std::max(andrews, newey_west));
}

/// Sum over spans of the Bartlett-weighted autocovariances of the rows [k x k], not divided by their number.
Matrix BartlettSum(const Matrix& series, const std::vector<Span>& spans, Eigen::Index lags) {
  Matrix sum = Matrix::Zero(series.cols(), series.cols());
  for (const Span& s : spans) {
    const auto rows = series.middleRows(s.first, s.count);
    sum += rows.transpose() * rows;
    for (Eigen::Index l = 1; l <= std::min(lags, s.count - 1); ++l) {
      const double weight = 1 - static_cast<double>(l) / static_cast<double>(lags + 1);
      const Matrix lagged = rows.bottomRows(s.count - l).transpose() * rows.topRows(s.count - l);
      sum += weight * (lagged + lagged.transpose());
    }
  }
  return sum;
}

/// The series less `correlation` times its own past; the first row of each span is dropped from it.
Matrix Whitened(const Matrix& series, const Vector& correlation, std::vector<Span>& spans) {
  Matrix white = series;
  std::vector<Span> shorter;
  for (const Span& s : spans) {
    if (s.count < 2) continue;
    white.middleRows(s.first + 1, s.count - 1) -=
        series.middleRows(s.first, s.count - 1) * correlation.asDiagonal();
    shorter.push_back({s.first + 1, s.count - 1});
  }
  spans = std::move(shorter);
  return white;
}

Matrix LongRunCovariance(const Matrix& scores, std::vector<Span> spans) {
  const auto n = static_cast<double>(scores.rows());
  const Vector correlation = LagOne(scores, spans);
  const Matrix white = Whitened(scores, correlation, spans);
  double rows = 0;
  for (const Span& s : spans) rows += static_cast<double>(s.count);
  if (rows == 0) return Gram(scores);  // one sample per block: nothing to correlate with
  const Vector recolour = (1 - correlation.array()).inverse();
  const Matrix sum = BartlettSum(white, spans, AutomaticLag(white, spans, rows));
  return n / rows * recolour.asDiagonal() * sum * recolour.asDiagonal();
}

// By the cosines of the lowest frequencies over each span (see the header), scaled by Student's t.
Matrix CosineCovariance(const Matrix& scores, std::vector<Span> spans) {
  spans.erase(std::remove_if(spans.begin(), spans.end(), [](const Span& s) { return s.count == 0; }),
              spans.end());
  const auto trials = static_cast<Eigen::Index>(spans.size());
  const Eigen::Index each = (kCosines + trials - 1) / trials;
  Matrix sum = Matrix::Zero(scores.cols(), scores.cols());
  const auto add = [&](const Vector& component) { sum += component * component.transpose(); };
  for (const Span& s : spans) {
    const auto rows = scores.middleRows(s.first, s.count);
    const auto n = static_cast<double>(s.count);
    // All scores together sum to zero at the minimum, those of one of several trials do not.
    if (trials > 1) add(rows.colwise().sum().transpose() / std::sqrt(n));
    const Vector phase = (Vector::LinSpaced(s.count, 0, n - 1).array() + 0.5) * (EIGEN_PI / n);
    for (Eigen::Index j = 1; j <= each; ++j)
      add(std::sqrt(2 / n) * (rows.transpose() * (static_cast<double>(j) * phase).array().cos().matrix()));
  }
  const auto degrees = static_cast<double>(each * trials + trials - 1);
  const double wider = statistics::StudentTQuantile(0.975, degrees) / kNormal95;
  return sum * (static_cast<double>(scores.rows()) / degrees * wider * wider);
}

// Both variances of each parameter, the larger one: the correlations are those of `a`.
Matrix WithLargerVariances(Matrix a, const Matrix& b) {
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    if (!(a(i, i) > 0 && b(i, i) > a(i, i))) continue;
    const double factor = std::sqrt(b(i, i) / a(i, i));
    a.row(i) *= factor;
    a.col(i) *= factor;
  }
  return a;
}

}  // namespace

Matrix PlainCovariance(const Information& info, const Vector& deviation) {
  const Matrix root = deviation.asDiagonal() * info.columns * info.inverse;
  return Gram(root);
}

Matrix RobustCovariance(const Information& info, const Linearization& at, const Vector& deviation) {
  const Eigen::Index n = at.data_rows;
  const Eigen::Index priors = at.residuals.size() - n;
  std::vector<Span> spans;
  for (const Linearization::Rows& rows : at.blocks) spans.push_back({rows.first, rows.count});

  const Matrix scores = at.residuals.head(n).asDiagonal() * info.columns.topRows(n);
  const double degrees = static_cast<double>(n) - info.leverage.head(n).sum();
  const double correction = static_cast<double>(n) / std::max(degrees, 1.0);
  const Matrix prior_rows = deviation.tail(priors).asDiagonal() * info.columns.bottomRows(priors);
  const auto covariance = [&](const Matrix& long_run) -> Matrix {
    return info.inverse * (correction * long_run + Gram(prior_rows)) * info.inverse;
  };
  const Matrix kernel = covariance(LongRunCovariance(scores, spans));
  // There may be no parameters but known ones.
  if (!(UnboundedLagOne(scores, spans).array() > kLargestCorrelation).any()) return kernel;
  return WithLargerVariances(kernel, covariance(CosineCovariance(scores, spans)));
}

}  // namespace sinew::uncertainty
