#include "datasets/check/rigid_markers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "datasets/check/marker_paths.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kSegmentFewestMarkers = 6;
constexpr std::size_t kSegmentFewestFrames = 40;
constexpr std::size_t kSegmentFrames = 300;   // that distances are judged on
constexpr double kSegmentScatter_m = 0.006;   // largest robust deviation of a constant distance
constexpr double kSegmentFirm_m = 0.008;      // the same of a distance that a correction must reach
constexpr double kSegmentLeast_m = 0.02;      // shorter distances are no two markers
constexpr double kSegmentKnown = 0.6;         // share of the markers that move with two others
constexpr std::size_t kSegmentPartners = 5;   // that a marker is compared with
constexpr double kSegmentMismatch_m = 0.02;   // per unit of the logarithm of left against right
constexpr double kSegmentAlike = 0.15;        // largest such logarithm after a correction
constexpr double kSegmentSuspect_m = 0.0045;  // misfit from which corrections are tried
constexpr double kSegmentBetter = 0.4;        // misfit after a correction, of that before
constexpr double kSegmentLongestLag_s = 0.4;
constexpr double kSegmentLeastLag_s = 0.03;
constexpr double kSegmentAway_m = 0.03;       // a marker that leaves its segment
constexpr double kSegmentAwayDeviations = 8;  // the same in robust deviations
constexpr double kSegmentAwayUsual = 4;       // the same of the 85th percentile: toes bend at every step
constexpr double kSegmentMostAway = 0.4;      // share of the frames
constexpr std::size_t kSegmentGap = 3;        // [frames] between two spans that are one
constexpr std::size_t kSegmentSpike = 3;      // [frames]

struct Distance {
  double middle = NAN;        // [m]
  double scatter = INFINITY;  // [m] robust deviation
  double wide =
      INFINITY;  // [m] the same of the 80th percentile: feet that stand most of the time differ in the rest
};

template <class Points>
Distance Between(const Points& a, const Path& b, std::size_t stride) {
  std::vector<double> distances;
  distances.reserve(a.size() / stride + 1);
  for (std::size_t i = 0; i < a.size(); i += stride) {
    const double d = (a[i] - b[i]).norm();
    if (std::isfinite(d)) distances.push_back(d);
  }
  if (distances.size() < kSegmentFewestFrames) return {};
  const double middle = Median(distances);
  const double scatter = RobustDeviation(distances);
  for (double& d : distances) d = std::abs(d - middle);
  constexpr double kNormal = 1.28;
  return {middle, scatter, std::max(scatter, Quantile(std::move(distances), 0.8) / kNormal)};
}

// A change of one marker's path that would make it move with others.
struct Correction {
  FindingKind kind = FindingKind::kSign;
  int axis = 0;
  int other = 0;      // of two axes that are exchanged
  double factor = 1;  // of a unit: that the numbers are too large by
  int lag = 0;        // [samples] late
};

class Corrected {
 public:
  Corrected(const Path& path, const Correction& correction) : path_(path), correction_(correction) {}

  [[nodiscard]] std::size_t size() const { return path_.size(); }
  [[nodiscard]] Vec3 operator[](std::size_t i) const {
    const Correction& c = correction_;
    if (c.kind == FindingKind::kLag) {
      const auto at = static_cast<long>(i) + c.lag;
      if (at < 0 || at >= static_cast<long>(size())) return {NAN, NAN, NAN};
      return path_[static_cast<std::size_t>(at)];
    }
    Vec3 p = path_[i];
    if (c.kind == FindingKind::kSign) p[c.axis] = -p[c.axis];
    if (c.kind == FindingKind::kAxis) std::swap(p[c.axis], p[c.other]);
    if (c.kind == FindingKind::kUnit) p[c.axis] /= c.factor;
    return p;
  }

 private:
  const Path& path_;
  const Correction& correction_;
};

class Segments {
 public:
  explicit Segments(const std::vector<Marker>& markers) : markers_(markers) {
    for (const Marker& marker : markers) paths_.emplace_back(marker);
    stride_ = std::max<std::size_t>(1, paths_.front().size() / kSegmentFrames);
    distances_.resize(markers.size());
    for (std::size_t i = 0; i < markers.size(); ++i) distances_[i] = DistancesOf(i, paths_[i]);
  }

  [[nodiscard]] std::size_t size() const { return markers_.size(); }
  [[nodiscard]] const Path& path(std::size_t i) const { return paths_[i]; }
  [[nodiscard]] const Distance& distance(std::size_t i, std::size_t j) const { return distances_[i][j]; }

  // [markers] of marker i, if its path were this one.
  template <class Points>
  [[nodiscard]] std::vector<Distance> DistancesOf(std::size_t i, const Points& path) const {
    std::vector<Distance> all(size());
    for (std::size_t j = 0; j < size(); ++j) {
      if (j != i) all[j] = Between(path, paths_[j], stride_);
    }
    return all;
  }

  // Those that marker i moves with, best first.
  [[nodiscard]] std::vector<std::size_t> Partners(std::size_t i, const std::vector<Distance>& of) const {
    std::vector<std::size_t> partners;
    for (std::size_t j = 0; j < size(); ++j) {
      if (j != i && of[j].scatter <= kSegmentScatter_m && of[j].middle > kSegmentLeast_m)
        partners.push_back(j);
    }
    std::sort(partners.begin(), partners.end(),
              [&](std::size_t a, std::size_t b) { return of[a].scatter < of[b].scatter; });
    if (partners.size() > kSegmentPartners) partners.resize(kSegmentPartners);
    return partners;
  }

  // Second smallest scatter of the distances, most of the frames [m].
  [[nodiscard]] double Scatter(const std::vector<Distance>& of) const {
    std::vector<double> scatter;
    for (const Distance& d : of) {
      if (d.middle > kSegmentLeast_m) scatter.push_back(d.wide);
    }
    if (scatter.size() < 2) return INFINITY;
    std::nth_element(scatter.begin(), scatter.begin() + 1, scatter.end());
    return scatter[1];
  }

  // Median |log| of the distances against those on the other side, of the nearest markers; NaN if there are
  // none.
  [[nodiscard]] double Mismatch(std::size_t i, const std::vector<Distance>& of) const {
    if (markers_[i].mirror < 0) return NAN;
    const auto mirror = static_cast<std::size_t>(markers_[i].mirror);
    std::vector<std::pair<double, double>> logs;  // by the distance on the other side
    for (std::size_t j = 0; j < size(); ++j) {
      if (j == i || markers_[j].mirror < 0) continue;
      const auto other = static_cast<std::size_t>(markers_[j].mirror);
      if (other == mirror || (other == j && mirror == i) || (j == mirror && other == i)) continue;
      const Distance& theirs = distances_[mirror][other];
      if (theirs.scatter > kSegmentScatter_m || !(theirs.middle > kSegmentLeast_m) || !(of[j].middle > 0))
        continue;
      logs.emplace_back(theirs.middle, std::abs(std::log(of[j].middle / theirs.middle)));
    }
    if (logs.size() < 2) return NAN;
    std::sort(logs.begin(), logs.end());
    std::vector<double> near;
    for (std::size_t k = 0; k < std::min(kSegmentPartners, logs.size()); ++k) near.push_back(logs[k].second);
    return Median(near);
  }

  // [m] how badly a marker moves with others.
  [[nodiscard]] double Misfit(std::size_t i, const std::vector<Distance>& of) const {
    const double mismatch = Mismatch(i, of);
    return Scatter(of) + (std::isfinite(mismatch) ? kSegmentMismatch_m * std::min(mismatch, 1.0) : 0);
  }

 private:
  const std::vector<Marker>& markers_;
  std::vector<Path> paths_;
  std::vector<std::vector<Distance>> distances_;
  std::size_t stride_ = 1;
};

std::vector<Correction> Candidates(double step, std::size_t frames) {
  std::vector<Correction> all;
  for (int axis = 0; axis < 3; ++axis) {
    all.push_back({FindingKind::kSign, axis, 0, 1, 0});
    for (int other = axis + 1; other < 3; ++other) all.push_back({FindingKind::kAxis, axis, other, 1, 0});
    for (const double factor : {1000.0, 1e-3}) all.push_back({FindingKind::kUnit, axis, 0, factor, 0});
  }
  const int longest =
      static_cast<int>(std::min(kSegmentLongestLag_s / step, static_cast<double>(frames) / 4));
  const int least = std::max(2, static_cast<int>(std::ceil(kSegmentLeastLag_s / step)));
  const int skip = std::max(1, longest / 40);
  for (int lag = least; lag <= longest; lag += skip) {
    all.push_back({FindingKind::kLag, 0, 0, 1, lag});
    all.push_back({FindingKind::kLag, 0, 0, 1, -lag});
  }
  return all;
}

// The fault of a whole marker, if a correction removes it.
std::optional<Finding> WholeFault(const std::vector<Marker>& markers, const Segments& segments, std::size_t i,
                                  const std::vector<Distance>& as_is) {
  const double before = segments.Misfit(i, as_is);
  if (before < kSegmentSuspect_m) return std::nullopt;
  const Marker& marker = markers[i];
  const TimeSpan whole = marker.axes[0]->Whole();
  const std::size_t frames = marker.axes[0]->size();
  const double step = (whole.to - whole.from) / static_cast<double>(frames - 1);
  const double scatter_before = segments.Scatter(as_is);
  double best = INFINITY;
  std::optional<Correction> chosen;
  std::vector<Distance> distances;
  for (const Correction& c : Candidates(step, frames)) {
    const auto of = segments.DistancesOf(i, Corrected(segments.path(i), c));
    const double scatter = segments.Scatter(of);
    if (scatter > kSegmentFirm_m) continue;
    const double misfit = segments.Misfit(i, of);
    // Where distances were constant before, those on the other side decide; markers are not placed alike to
    // the centimetre.
    const bool moves_now = scatter < kSegmentBetter * scatter_before;
    const bool is_mirrored = misfit < kSegmentBetter * before && !(segments.Mismatch(i, of) > kSegmentAlike);
    if ((!moves_now && !is_mirrored) || misfit >= best) continue;
    best = misfit;
    chosen = c;
    distances = of;
  }
  if (!chosen) return std::nullopt;
  const auto partners = segments.Partners(i, distances);
  const Signal* signal = marker.axes[static_cast<std::size_t>(chosen->axis)];
  if (chosen->kind == FindingKind::kLag) {
    signal = *std::max_element(marker.axes.begin(), marker.axes.end(),
                               [](const Signal* a, const Signal* b) { return RangeOf(*a) < RangeOf(*b); });
  }
  Finding finding = signal->Found(chosen->kind);
  finding.whole = true;
  finding.spans = {whole};
  switch (chosen->kind) {
    case FindingKind::kAxis:
      finding.other = marker.axes[static_cast<std::size_t>(chosen->other)]->channel;
      break;
    case FindingKind::kUnit:
      finding.size = chosen->factor;
      finding.usual = 1;
      break;
    case FindingKind::kLag:
      finding.size = chosen->lag * step;
      finding.other = partners.empty() ? "the markers around it" : markers[partners.front()].name;
      break;
    default:
      finding.size = -1;
      finding.usual = 1;
  }
  return finding;
}

// Frames at which a marker is away from where its partners say, and by how much.
std::vector<double> Away(const Segments& segments, std::size_t i, const std::vector<std::size_t>& partners) {
  std::vector<double> away(segments.path(i).size(), 0);
  for (std::size_t t = 0; t < away.size(); ++t) {
    std::vector<double> off;
    for (const std::size_t j : partners) {
      const double d = (segments.path(i)[t] - segments.path(j)[t]).norm();
      if (std::isfinite(d)) off.push_back(std::abs(d - segments.distance(i, j).middle));
    }
    // With two partners both must be off: one of them may be the wrong one.
    if (off.size() < 2) continue;
    std::sort(off.begin(), off.end());
    away[t] = off[(off.size() - 1) / 2];
  }
  return away;
}

// The coordinate that is furthest from a straight line over the frames first to last.
std::size_t CoordinateOf(const Path& path, std::size_t first, std::size_t last) {
  const std::size_t before = first > 0 ? first - 1 : last + 1;
  const std::size_t after = last + 1 < path.size() ? last + 1 : before;
  std::array<double, 3> off{};
  for (std::size_t t = first; t <= last; ++t) {
    const double share =
        after > before ? static_cast<double>(t - before) / static_cast<double>(after - before) : 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      const double line = path[before][a] + share * (path[after][a] - path[before][a]);
      if (std::isfinite(line)) off[axis] = std::max(off[axis], std::abs(path[t][a] - line));
    }
  }
  return static_cast<std::size_t>(std::max_element(off.begin(), off.end()) - off.begin());
}

std::vector<Finding> LocalFaults(const std::vector<Marker>& markers, const Segments& segments, std::size_t i,
                                 const std::vector<std::size_t>& partners) {
  if (partners.size() < 2) return {};
  std::vector<double> scatter;
  for (const std::size_t j : partners) scatter.push_back(segments.distance(i, j).scatter);
  const double usual = Median(scatter);
  const std::vector<double> away = Away(segments, i, partners);
  const double limit =
      std::max({kSegmentAway_m, kSegmentAwayDeviations * usual, kSegmentAwayUsual * Quantile(away, 0.85)});
  std::vector<Run> spans;
  std::size_t count = 0;
  for (std::size_t t = 0; t < away.size(); ++t) {
    if (!(away[t] > limit)) continue;
    ++count;
    if (!spans.empty() && t - spans.back().last <= kSegmentGap + 1) {
      spans.back().last = t;
      spans.back().value = std::max(spans.back().value, away[t]);
    } else {
      spans.push_back({t, t, away[t]});
    }
  }
  if (spans.empty() || static_cast<double>(count) > kSegmentMostAway * static_cast<double>(away.size()))
    return {};
  std::map<std::pair<std::size_t, FindingKind>, Finding> by_channel;
  for (const Run& span : spans) {
    const std::size_t axis = CoordinateOf(segments.path(i), span.first, span.last);
    const FindingKind kind = span.size() <= kSegmentSpike ? FindingKind::kSpike : FindingKind::kDisplaced;
    const Signal& signal = *markers[i].axes[axis];
    auto [at, is_new] = by_channel.try_emplace({axis, kind}, signal.Found(kind));
    Finding& finding = at->second;
    finding.spans.push_back(signal.Span(span.first, span.last));
    finding.size = std::max(finding.size, span.value);
    finding.usual = usual;
    finding.other = markers[partners[0]].name + " and " + markers[partners[1]].name;
  }
  std::vector<Finding> found;
  for (auto& [key, finding] : by_channel) found.push_back(std::move(finding));
  return found;
}

}  // namespace

std::vector<Finding> FindBrokenSegments(const std::vector<ChannelGroup>& groups) {
  std::vector<Finding> found;
  for (const std::vector<Marker>& markers : MarkerSets(groups)) {
    if (markers.size() < kSegmentFewestMarkers || markers.front().size() < kSegmentFewestFrames) continue;
    const Segments segments(markers);
    const std::size_t n = markers.size();
    std::vector<std::vector<std::size_t>> partners(n);
    std::size_t known = 0;
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<Distance> of(n);
      for (std::size_t j = 0; j < n; ++j) of[j] = segments.distance(i, j);
      partners[i] = segments.Partners(i, of);
      known += partners[i].size() >= 2 ? 1 : 0;
    }
    if (static_cast<double>(known) < kSegmentKnown * static_cast<double>(n)) continue;
    std::vector<bool> wrong(n, false);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<Distance> of(n);
      for (std::size_t j = 0; j < n; ++j) of[j] = segments.distance(i, j);
      auto whole = WholeFault(markers, segments, i, of);
      if (!whole) continue;
      wrong[i] = true;
      found.push_back(std::move(*whole));
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (wrong[i]) continue;
      auto fine = partners[i];
      fine.erase(std::remove_if(fine.begin(), fine.end(), [&](std::size_t j) { return wrong[j]; }),
                 fine.end());
      for (Finding& finding : LocalFaults(markers, segments, i, fine)) found.push_back(std::move(finding));
    }
  }
  return found;
}

}  // namespace sinew
