#include "problems/contact/motion/foot_markers.h"

#include <algorithm>
#include <cmath>

#include "problems/contact/load/plate_samples.h"

namespace sinew {

FootMarkers FootMarkers::Part(std::size_t first, std::size_t last) const {
  FootMarkers part = *this;
  for (Marker& marker : part.markers)
    marker.measured = {marker.measured.begin() + static_cast<std::ptrdiff_t>(first),
                       marker.measured.begin() + static_cast<std::ptrdiff_t>(last)};
  return part;
}

FootMarkers MeasuredMarkers(const Trial& trial, const OsimModel& model, const MultibodyModel& multibody,
                            const FootMotion& foot, const std::vector<double>& times) {
  FootMarkers found;
  for (const OsimMarker& marker : model.markers) {
    const auto body = multibody.BodyIndex(marker.body);
    if (!body) continue;
    const auto of_foot = std::find(foot.indices.begin(), foot.indices.end(), *body);
    if (of_foot == foot.indices.end()) continue;
    const auto x = trial.Find(marker.name + "_x");
    const auto y = trial.Find(marker.name + "_y");
    const auto z = trial.Find(marker.name + "_z");
    if (!x || !y || !z) continue;
    FootMarkers::Marker measured{
        marker.name, static_cast<std::size_t>(of_foot - foot.indices.begin()), marker.location, {}};
    for (const double t : times) {
      measured.measured.emplace_back(ValueAt(*x.grid, *x.channel, t), ValueAt(*y.grid, *y.channel, t),
                                     ValueAt(*z.grid, *z.channel, t));
    }
    found.markers.push_back(std::move(measured));
  }
  return found;
}

MarkerAccuracy AccuracyOf(const FootMarkers& markers, const FootMotion& foot) {
  MarkerAccuracy accuracy;
  double squares = 0;
  double samples = 0;
  double distances = 0;
  for (std::size_t t = 0; t < foot.centre.size(); ++t) {
    Vec3 centre = Vec3::Zero();
    std::vector<Vec3> placed;
    for (const FootMarkers::Marker& marker : markers.markers) {
      const BodyMotion& body = foot.bodies[marker.body].motion[t];
      const Vec3 residual = FootMarkers::Residual(marker, body, t);
      if (!residual.allFinite()) continue;
      squares += residual.squaredNorm();
      samples += 1;
      placed.emplace_back(body.position + body.rotation * marker.location);
      centre += placed.back();
    }
    if (placed.empty()) continue;
    centre /= static_cast<double>(placed.size());
    for (const Vec3& place : placed) distances += (place - centre).squaredNorm();
  }
  accuracy.markers = static_cast<int>(markers.markers.size());
  if (samples == 0) return accuracy;
  accuracy.residual = std::sqrt(squares / samples);
  accuracy.position = accuracy.residual / std::sqrt(3.0);
  const double spread = std::sqrt(distances / samples);
  if (spread > 0) accuracy.rotation = accuracy.position / spread;
  return accuracy;
}

}  // namespace sinew
