#include "datasets/lagged_correlation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.h"

namespace sinew {
namespace {

constexpr Eigen::Index kBlock = 4096;  // samples that stay in the cache for all lags

// Means of the known values; 0 if there are none.
double MeanOf(const std::vector<double>& x) {
  double mean = 0;
  double n = 0;
  for (const double v : x) {
    if (std::isfinite(v)) mean += (v - mean) / ++n;
  }
  return mean;
}

// A piece of a series less its mean, 0 where it is unknown or beyond the ends, and what is known of it.
struct Piece {
  Eigen::VectorXd values;
  Eigen::VectorXd squares;
  Eigen::VectorXd known;  // 0 or 1
  bool complete = false;

  // [size] from sample `from` on, which may be negative.
  void Set(const std::vector<double>& x, double mean, Eigen::Index from, Eigen::Index size) {
    values.setZero(size);
    known.setZero(size);
    const auto n = static_cast<Eigen::Index>(x.size());
    for (Eigen::Index i = std::max<Eigen::Index>(0, -from); i < std::min(size, n - from); ++i) {
      const double v = x[static_cast<std::size_t>(from + i)];
      if (!std::isfinite(v)) continue;
      values[i] = v - mean;
      known[i] = 1;
    }
    squares = values.cwiseAbs2();
    complete = known.sum() == static_cast<double>(size);
  }
};

// Sums over the pairs of each lag.
struct PairSums {
  explicit PairSums(Eigen::Index lags) : n(Eigen::VectorXd::Zero(lags)), a(n), b(n), aa(n), bb(n), ab(n) {}
  Eigen::VectorXd n, a, b, aa, bb, ab;
};

// Of samples of b, and of a around them: as many more on both sides as the longest lag.
void AddPiece(const Piece& a, const Piece& b, PairSums& sums) {
  const Eigen::Index size = b.values.size();
  const Eigen::Index lags = sums.n.size();
  // Where nothing is missing the sums of a are those of a moving window, and those of b the same at each lag.
  double of_a = a.values.head(size).sum();
  double of_aa = a.squares.head(size).sum();
  const double of_b = b.values.sum();
  const double of_bb = b.squares.sum();
  for (Eigen::Index k = 0; k < lags; ++k) {  // a begins k samples in: the lag is longest - k
    const Eigen::Index at = lags - 1 - k;
    sums.ab[at] += a.values.segment(k, size).dot(b.values);
    if (a.complete && b.complete) {
      sums.n[at] += static_cast<double>(size);
      sums.a[at] += of_a;
      sums.aa[at] += of_aa;
      sums.b[at] += of_b;
      sums.bb[at] += of_bb;
      if (k + 1 < lags) {
        of_a += a.values[k + size] - a.values[k];
        of_aa += a.squares[k + size] - a.squares[k];
      }
    } else {
      sums.n[at] += a.known.segment(k, size).dot(b.known);
      sums.a[at] += a.values.segment(k, size).dot(b.known);
      sums.aa[at] += a.squares.segment(k, size).dot(b.known);
      sums.b[at] += a.known.segment(k, size).dot(b.values);
      sums.bb[at] += a.known.segment(k, size).dot(b.squares);
    }
  }
}

}  // namespace

std::vector<double> LaggedCorrelations(const std::vector<double>& a, const std::vector<double>& b,
                                       int longest) {
  const Eigen::Index lags = 2 * longest + 1;
  PairSums sums(lags);
  const double mean_a = MeanOf(a);
  const double mean_b = MeanOf(b);
  Piece of_a;
  Piece of_b;
  const auto n = static_cast<Eigen::Index>(b.size());
  for (Eigen::Index from = 0; from < n; from += kBlock) {
    const Eigen::Index size = std::min(kBlock, n - from);
    of_a.Set(a, mean_a, from - longest, size + 2 * longest);
    of_b.Set(b, mean_b, from, size);
    AddPiece(of_a, of_b, sums);
  }
  std::vector<double> correlations(static_cast<std::size_t>(lags), std::numeric_limits<double>::quiet_NaN());
  for (Eigen::Index k = 0; k < lags; ++k) {
    if (sums.n[k] < 2) continue;
    const double aa = sums.aa[k] - sums.a[k] * sums.a[k] / sums.n[k];
    const double bb = sums.bb[k] - sums.b[k] * sums.b[k] / sums.n[k];
    const double ab = sums.ab[k] - sums.a[k] * sums.b[k] / sums.n[k];
    // What rounding leaves of the sums is not variance.
    const double least = sums.n[k] * std::numeric_limits<double>::epsilon();
    if (aa > least * sums.aa[k] && bb > least * sums.bb[k])
      correlations[static_cast<std::size_t>(k)] = ab / std::sqrt(aa * bb);
  }
  return correlations;
}

}  // namespace sinew
