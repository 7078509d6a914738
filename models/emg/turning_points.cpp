#include "models/emg/turning_points.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kMedianOfNormal = 0.6744897501960817;   // of |x|, standard deviations
constexpr double kFourthDifference = 8.366600265340756;  // sqrt(1 + 16 + 36 + 16 + 1)
constexpr double kShallowest = 0.05;                     // of the swing
constexpr double kDeepest = 0.2;
constexpr double kNoiseInDepth = 6;
constexpr std::size_t kMinSamplesPerTurn = 8;
constexpr double kNearest = 0.49;

// A curve that is turned over where it has a lowest point.
class Peak {
 public:
  Peak(const std::vector<double>& time, const std::vector<double>& angle, bool highest, std::size_t before,
       std::size_t sample, std::size_t after)
      : time_(time),
        angle_(angle),
        sign_(highest ? 1 : -1),
        before_(before),
        sample_(sample),
        after_(after),
        top_(Height(sample)) {}

  [[nodiscard]] TurningPoint Locate(double noise) {
    // Of n samples of equal height the highest lies sqrt(2 ln n) - 0.5 standard deviations above, to 0.1.
    Widen(top_ - 8 * noise);
    std::size_t level = 0;
    for (std::size_t k = left_; k <= right_; ++k) level += Height(k) >= top_ - 4 * noise ? 1 : 0;
    const double count = static_cast<double>(std::max<std::size_t>(level, 1));
    top_ -= noise * std::max(0.0, std::sqrt(2 * std::log(count)) - 0.5);

    TurningPoint point;
    point.highest = sign_ > 0;
    point.sample = sample_;
    point.angle = sign_ * top_;
    point.time_s = point.from_s = point.to_s = time_[sample_];
    const double swing = top_ - std::max(Height(before_), Height(after_));
    if (!(swing > 0)) return point;  // noise is all there is
    double depth = std::clamp(kNoiseInDepth * noise, kShallowest * swing, kDeepest * swing);
    for (; depth < kDeepest * swing; depth = std::min(2 * depth, kDeepest * swing)) {
      Widen(top_ - depth);
      if (right_ - left_ > kMinSamplesPerTurn) break;
    }
    Widen(top_ - 2 * depth - 2 * noise);
    const double shallow = Centroid(top_ - depth);
    const double deep = Centroid(top_ - 2 * depth);

    point.from_s = time_[left_];
    point.to_s = time_[right_];
    point.time_s = time_[sample_] + 2 * shallow - deep;
    if (!std::isfinite(point.time_s)) point.time_s = time_[sample_];  // angles near the largest number
    // Nearer to its own extreme sample than to its neighbours': times keep their order.
    const auto toward = [this](std::size_t other) {
      return time_[sample_] + kNearest * (time_[other] - time_[sample_]);
    };
    point.time_s = std::clamp(point.time_s, std::max(point.from_s, toward(before_)),
                              std::min(point.to_s, toward(after_)));
    return point;
  }

 private:
  [[nodiscard]] double Height(std::size_t k) const { return sign_ * angle_[k]; }

  // To the first samples below the level on both sides.
  void Widen(double level) {
    left_ = right_ = sample_;
    while (left_ > before_ && Height(left_) >= level) --left_;
    while (right_ < after_ && Height(right_) >= level) ++right_;
  }

  // Of the area above the level, after the extreme sample's time.
  [[nodiscard]] double Centroid(double level) const {
    double area = 0;
    double moment = 0;
    for (std::size_t k = left_; k < right_; ++k) {
      double from = time_[k] - time_[sample_];
      double to = time_[k + 1] - time_[sample_];
      double first = Height(k) - level;
      double last = Height(k + 1) - level;
      if (first <= 0 && last <= 0) continue;
      const double crossing = from + (to - from) * first / (first - last);
      if (first < 0) {
        from = crossing;
        first = 0;
      } else if (last < 0) {
        to = crossing;
        last = 0;
      }
      const double piece = 0.5 * (to - from) * (first + last);
      area += piece;
      moment += piece * from + (to - from) * (to - from) * (first + 2 * last) / 6;
    }
    return area > 0 ? moment / area : 0;
  }

  const std::vector<double>& time_;
  const std::vector<double>& angle_;
  double sign_;
  std::size_t before_;  // the turning points beside it, or the recording's ends
  std::size_t sample_;
  std::size_t after_;
  double top_;
  std::size_t left_ = 0;
  std::size_t right_ = 0;
};

}  // namespace

double NoiseOfAngle(const std::vector<double>& angle) {
  if (angle.size() < 5) return 0;
  std::vector<double> differences;
  differences.reserve(angle.size());
  for (std::size_t k = 2; k + 2 < angle.size(); ++k) {
    const double d = angle[k - 2] - 4 * angle[k - 1] + 6 * angle[k] - 4 * angle[k + 1] + angle[k + 2];
    differences.push_back(std::isfinite(d) ? std::abs(d) : 0);
  }
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return *middle / (kMedianOfNormal * kFourthDifference);
}

std::vector<std::size_t> FindExtremeSamples(const std::vector<double>& angle, double swing) {
  std::vector<std::size_t> extremes;
  std::size_t highest = 0;  // since the last extreme sample
  std::size_t lowest = 0;
  // A swing may vanish beside angles that are far larger: they must differ as well.
  const auto is_swing = [swing](double low, double high) { return low < high && high - low >= swing; };
  int direction = 0;  // of the motion; 0 until it is known
  for (std::size_t k = 1; k < angle.size(); ++k) {
    if (angle[k] > angle[highest]) highest = k;
    if (angle[k] < angle[lowest]) lowest = k;
    if (direction >= 0 && is_swing(angle[k], angle[highest])) {
      extremes.push_back(highest);
      direction = -1;
      lowest = k;
    } else if (direction <= 0 && is_swing(angle[lowest], angle[k])) {
      extremes.push_back(lowest);
      direction = 1;
      highest = k;
    }
  }
  if (direction != 0) extremes.push_back(direction > 0 ? highest : lowest);
  return extremes;
}

std::vector<TurningPoint> FindTurningPoints(const std::vector<double>& time, const std::vector<double>& angle,
                                            double swing, double noise) {
  const std::vector<std::size_t> extremes = FindExtremeSamples(angle, swing);
  std::vector<TurningPoint> points;
  points.reserve(extremes.size());
  for (std::size_t i = 1; i + 1 < extremes.size(); ++i) {
    const bool highest = angle[extremes[i]] > angle[extremes[i - 1]];
    points.push_back(Peak(time, angle, highest, extremes[i - 1], extremes[i], extremes[i + 1]).Locate(noise));
  }
  return points;
}

}  // namespace sinew
