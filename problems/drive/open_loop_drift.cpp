#include "problems/drive/open_loop_drift.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/decompositions.h"
#include "base/text.h"

namespace sinew {
namespace {

constexpr int kQuarters = 4;
constexpr int kOrder = 3;
constexpr double kLeastShare = 0.5;
constexpr double kLeastGrowth = 10;
constexpr double kLeastOfNoise = 5;
constexpr double kLeastOfSpread = 1e-3;

double MeanSquareDifference(const Vector& values) {
  const Eigen::Index n = values.size();
  return (values.tail(n - 1) - values.head(n - 1)).squaredNorm() / static_cast<double>(n - 1);
}

// Squared sum of the part of a residual that is a polynomial in time.
double OfPolynomial(const Vector& time, const Vector& residual) {
  const double middle = 0.5 * (time[0] + time[time.size() - 1]);
  const double half = std::max(0.5 * (time[time.size() - 1] - time[0]), 1e-300);
  Matrix basis(time.size(), kOrder + 1);
  basis.col(0).setOnes();
  for (int k = 1; k <= kOrder; ++k) basis.col(k) = basis.col(k - 1).array() * (time.array() - middle) / half;
  return (OrthonormalBasis(Eigen::ColPivHouseholderQR<Matrix>(basis)).transpose() * residual).squaredNorm();
}

bool Grows(const Vector& residual) {
  std::array<double, kQuarters> squares{};
  const Eigen::Index n = residual.size();
  for (Eigen::Index i = 0; i < n; ++i)
    squares[static_cast<std::size_t>(i * kQuarters / n)] += residual[i] * residual[i];
  const bool every_quarter =
      std::adjacent_find(squares.begin(), squares.end(), std::greater_equal<>()) == squares.end();
  return every_quarter && squares.back() >= kLeastGrowth * squares.front();
}

}  // namespace

std::optional<Warning> OpenLoopDrift(const DriveData& data, const std::vector<Vector>& predicted) {
  if (data.command.input != DriveInput::kTorque) return {};
  std::vector<std::string> trials;
  double drift = 0;
  double all = 0;
  bool grows = false;
  for (std::size_t b = 0; b < data.layout.size(); ++b) {
    const Block& block = data.layout[b];
    const auto n = static_cast<Eigen::Index>(block.measured.size());
    if (block.role == BlockRole::kPredicted || data.blocks[b].channel != 0 || n < 10 * kQuarters) continue;
    const Eigen::Map<const Vector> measured(block.measured.data(), n);
    Vector time(n);
    Vector residual(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const int at = block.sample[static_cast<std::size_t>(i)];
      time[i] = block.prediction_time[static_cast<std::size_t>(at)];
      residual[i] = predicted[b][at] - measured[i];
    }
    const double square = residual.squaredNorm();
    const double noise = 0.5 * MeanSquareDifference(residual);  // more than that where errors are not smooth
    const double spread = (measured.array() - measured.mean()).square().mean();
    all += square;
    const double least =
        std::max(kLeastOfNoise * kLeastOfNoise * noise, kLeastOfSpread * kLeastOfSpread * spread);
    if (!(square > least * static_cast<double>(n))) continue;
    const double polynomial = OfPolynomial(time, residual);
    const bool here = Grows(residual);
    if (polynomial < kLeastShare * square && !here) continue;
    drift += here ? square : polynomial;
    grows = grows || here;
    trials.push_back(block.trial);
  }
  if (trials.empty() || (drift < kLeastShare * all && !grows)) return {};
  constexpr std::size_t kShown = 4;
  std::vector<std::string> shown(
      trials.begin(), trials.begin() + static_cast<std::ptrdiff_t>(std::min(trials.size(), kShown)));
  if (trials.size() > kShown) shown.push_back(fmt::format("{} more", trials.size() - kShown));
  const char* input = data.traits.rotary ? "torque" : "force";
  return Warning{
      WarningKind::kOther, trials, std::vector<double>(trials.size(), drift / all),
      fmt::format(
          "open loop on {0}: nothing feeds the position back, so that small errors of the {0} add up in it. "
          "{1:.0f} % of the squared error are such a drift (trial{2} {3}); shorter trials (sinew data "
          "split), the reference and "
          "the controller in place of the {0}, the effect {0}.offset, or a stated noise level of the {0} "
          "(sigma) "
          "help",
          input, 100 * drift / all, trials.size() == 1 ? "" : "s", Join(shown, ", "))};
}

}  // namespace sinew
