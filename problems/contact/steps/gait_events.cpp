#include "problems/contact/steps/gait_events.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "models/dynamometer/smooth_angle.h"
#include "problems/contact/motion/trial_motion.h"
#include "problems/whole_body_dynamics.h"

namespace sinew {
namespace {

// The horizontal direction in which the feet point, in the mean over half a second before and after [T].
std::vector<Vec3> Ahead(const std::vector<double>& time, const std::vector<std::vector<BodyMotion>>& motions,
                        std::size_t feet) {
  constexpr double kAround = 0.5;  // [s]
  std::vector<Vec3> sums{Vec3::Zero()};
  for (const std::vector<BodyMotion>& at_instant : motions) {
    Vec3 sum = sums.back();
    for (std::size_t f = 0; f < feet; ++f) {
      Vec3 pointing = at_instant[f].rotation * Vec3::UnitX();
      pointing.y() = 0;
      sum += pointing;
    }
    sums.push_back(sum);
  }
  std::vector<Vec3> ahead;
  for (const double t : time) {
    const auto first = std::lower_bound(time.begin(), time.end(), t - kAround) - time.begin();
    const auto last = std::upper_bound(time.begin(), time.end(), t + kAround) - time.begin();
    const Vec3 mean = sums[static_cast<std::size_t>(last)] - sums[static_cast<std::size_t>(first)];
    ahead.push_back(mean.norm() > 0 ? Vec3(mean.normalized()) : Vec3::UnitX());
  }
  return ahead;
}

// Where the parabola through three samples is extreme.
double Refined(const std::vector<double>& time, const std::vector<double>& values, std::size_t i) {
  const double left = values[i] - values[i - 1];
  const double right = values[i] - values[i + 1];
  const double curvature = left + right;
  const double shift = curvature != 0 ? std::clamp(0.5 * (left - right) / curvature, -0.5, 0.5) : 0;
  return time[i] + shift * (shift > 0 ? time[i + 1] - time[i] : time[i] - time[i - 1]);
}

// Times of the maxima of sign * values on whose both sides it falls by a third of its range.
std::vector<double> Extremes(const std::vector<double>& time, const std::vector<double>& values,
                             double sign) {
  constexpr double kFalls = 1.0 / 3;
  constexpr double kLeastRange = 0.03;  // [m]: smaller motion of a foot is no step, of a small robot either
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double range = *high - *low;
  std::vector<double> found;
  if (!(range > kLeastRange)) return found;
  std::size_t highest = 0;
  std::size_t lowest = 0;
  bool rises = false;  // the last extreme that is certain was a minimum
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double value = sign * values[i];
    if (value > sign * values[highest]) highest = i;
    if (value < sign * values[lowest]) lowest = i;
    if (rises && value < sign * values[highest] - kFalls * range) {
      found.push_back(Refined(time, values, highest));
      rises = false;
      lowest = i;
    } else if (!rises && value > sign * values[lowest] + kFalls * range) {
      rises = true;
      highest = i;
    }
  }
  return found;
}

}  // namespace

Result<FootTracks> TracksOf(const Trial& trial, const ContactModel& model, const BodyTree& tree,
                            const ContactSettings& settings) {
  SINEW_ASSIGN(const TrialMotion recorded, FitTrialMotion(trial, model.multibody));
  SINEW_ASSIGN(const double rate, FrameRate(recorded));
  FootTracks tracks;
  tracks.time = recorded.time;
  const std::size_t regions = settings.regions.size();
  std::vector<int> bodies = model.bodies;
  bodies.push_back(tree.Root(model.bodies.front()));
  SINEW_ASSIGN(const auto motions, model.multibody.BodyMotions(recorded.time, recorded.trajectory, bodies));
  const std::vector<Vec3> ahead = Ahead(recorded.time, motions, regions);
  for (const std::string& plate : settings.Plates()) {
    FootTrack& track = tracks.feet[plate];
    for (std::size_t t = 0; t < motions.size(); ++t) {
      double heel = std::numeric_limits<double>::infinity();
      double toe = -heel;
      for (std::size_t r = 0; r < regions; ++r) {
        const ContactRegionSettings& of = settings.regions[r];
        if (of.plate != plate) continue;
        const BodyMotion& body = motions[t][r];
        for (const int face : of.region.SpringFaceIndices()) {
          const Vec3 spring =
              body.position +
              body.rotation * (of.region.position + of.region.rotation * of.region.mesh.Centre(face));
          const double at = ahead[t].dot(spring - motions[t].back().position);
          heel = std::min(heel, at);
          toe = std::max(toe, at);
        }
      }
      track.heel.push_back(heel);
      track.toe.push_back(toe);
    }
    for (std::vector<double>* values : {&track.heel, &track.toe}) {
      SINEW_ASSIGN(SmoothAngle smooth, SmoothedAngle(*values, rate, kWalkingCutoff));
      *values = std::move(smooth.values);
    }
  }
  return tracks;
}

GaitEvents EventsOf(const FootTracks& tracks, const std::string& plate) {
  const FootTrack& track = tracks.feet.at(plate);
  return {Extremes(tracks.time, track.heel, 1), Extremes(tracks.time, track.toe, -1)};
}

}  // namespace sinew
