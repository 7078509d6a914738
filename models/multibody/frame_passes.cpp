#include "models/multibody/frame_passes.h"

#include <algorithm>

#include "models/multibody/equal_poses.h"
#include "models/multibody/first_pose.h"

namespace sinew {
namespace {

constexpr std::size_t kBlock = 40;  // frames of which the worst one is searched again

class Passes {
 public:
  Passes(MarkerFit& fit, const MultibodyModel& model, const MarkerTrajectories& markers,
         const IkOptions& options)
      : fit_(fit), model_(model), markers_(markers), options_(options), random_(options.seed) {
    double most = 0;
    for (std::size_t i = 0; i < markers.positions.size(); ++i) {
      const double weight = fit.PresentWeight(markers.positions[i]);
      if (weight <= 0) continue;
      if (weight > most) anchor_ = solved_.size();
      most = std::max(most, weight);
      solved_.push_back(i);
    }
    poses_.resize(solved_.size());
    redone_.assign(solved_.size(), false);
    from_previous_.assign(solved_.size(), false);
    from_next_.assign(solved_.size(), false);
  }

  FramePoses Run() {
    FramePoses result;
    result.of_frame.resize(markers_.times.size());
    ReportProgress(markers_.times.size() - solved_.size());
    if (solved_.empty()) return result;
    SetFrame(anchor_);
    const FirstPose first = FindFirstPose(fit_, model_, options_, random_);
    poses_[anchor_] = first.solution;
    ReportProgress(1);
    for (std::size_t i = anchor_ + 1; i < solved_.size(); ++i) FollowNeighbour(i, i - 1);
    for (std::size_t i = anchor_; i-- > 0;) FollowNeighbour(i, i + 1);
    // What was reached in one direction is now tried in the other.
    for (std::size_t i = 0; i < anchor_; ++i) from_previous_[i + 1] = true;
    for (std::size_t i = anchor_; i + 1 < solved_.size(); ++i) from_next_[i] = true;
    Settle();
    // A wrong minimum that was entered on the way may hold to the end.
    if (Escape(solved_.size() - 1)) Settle();
    for (std::size_t from = 0; from < solved_.size(); from += kBlock) {
      if (Escape(Worst(from, std::min(from + kBlock, solved_.size())))) Settle();
    }
    MakeContinuous();
    if (EscapeAtJumps()) MakeContinuous();
    result.starts = first.starts;
    result.agreeing_starts = first.agreeing;
    for (std::size_t i = 0; i < solved_.size(); ++i) {
      if (redone_[i]) result.redone.push_back(static_cast<int>(solved_[i]));
      result.of_frame[solved_[i]] = std::move(poses_[i]);
    }
    return result;
  }

 private:
  void SetFrame(std::size_t i) { fit_.SetFrame(markers_.positions[solved_[i]]); }

  void ReportProgress(std::size_t frames) {
    for (std::size_t i = 0; i < frames; ++i) {
      ++done_;
      if (options_.progress) options_.progress(done_, static_cast<int>(markers_.times.size()));
    }
  }

  [[nodiscard]] MarkerFit::Search FullSearch() const {
    MarkerFit::Search search;
    search.accuracy = options_.accuracy;
    search.max_iterations = options_.max_iterations;
    return search;
  }

  void FollowNeighbour(std::size_t i, std::size_t neighbour) {
    SetFrame(i);
    poses_[i] = SolveAcrossEnds(fit_, model_, poses_[neighbour].values, FullSearch());
    ReportProgress(1);
  }

  // A search that comes near the pose that the frame has would end there, and stops.
  void TryFrom(std::size_t i, std::size_t neighbour) {
    const std::vector<Vector> known{poses_[i].values};
    MarkerFit::Search search = FullSearch();
    search.known = &known;
    SetFrame(i);
    const MarkerFit::Solution found = SolveAcrossEnds(fit_, model_, poses_[neighbour].values, search);
    if (found.joined < 0) Replace(i, found);
  }

  bool Replace(std::size_t i, const MarkerFit::Solution& found) {
    if (!IsLower(found.cost, poses_[i].cost, options_)) return false;
    poses_[i] = found;
    redone_[i] = true;
    if (i > 0) from_next_[i - 1] = true;
    if (i + 1 < solved_.size()) from_previous_[i + 1] = true;
    return true;
  }

  // Ends because every replacement lowers a cost by a share of it.
  void Settle() {
    for (bool again = true; again;) {
      for (std::size_t i = solved_.size(); i-- > 0;) {
        if (!from_next_[i]) continue;
        from_next_[i] = false;
        TryFrom(i, i + 1);
      }
      for (std::size_t i = 0; i < solved_.size(); ++i) {
        if (!from_previous_[i]) continue;
        from_previous_[i] = false;
        TryFrom(i, i - 1);
      }
      again = std::find(from_next_.begin(), from_next_.end(), true) != from_next_.end();
    }
  }

  [[nodiscard]] bool Jumps(std::size_t i, std::size_t neighbour, double limit) const {
    const auto& free = fit_.free_coordinates();
    return std::any_of(free.begin(), free.end(), [&](int c) {
      return IsFreeAngle(model_, c) && std::abs(poses_[i].values[c] - poses_[neighbour].values[c]) > limit;
    });
  }

  // A frame that was redone from its other side may describe the same placement by other angles.
  void Continue(std::size_t i, std::size_t neighbour) {
    constexpr double kJump = 1.5;  // [rad]; the angles of another description differ by half a turn or more
    if (!Jumps(i, neighbour, kJump)) return;
    SetFrame(i);
    poses_[i] = Continued(fit_, model_, options_, std::move(poses_[i]), poses_[neighbour].values);
  }

  void MakeContinuous() {
    for (std::size_t i = anchor_ + 1; i < solved_.size(); ++i) Continue(i, i - 1);
    for (std::size_t i = anchor_; i-- > 0;) Continue(i, i + 1);
  }

  // A few frames between markers that were swapped and markers that were lost are reached from neither side,
  // and are not the worst of their block. The pose jumps where they begin.
  bool EscapeAtJumps() {
    constexpr double kJump = 0.5;  // [rad]; 50 rad/s at 100 Hz
    std::vector<std::size_t> beside;
    for (std::size_t i = 1; i < solved_.size(); ++i) {
      if (!Jumps(i, i - 1, kJump)) continue;
      if (beside.empty() || beside.back() != i - 1) beside.push_back(i - 1);
      beside.push_back(i);
    }
    bool any = false;
    for (const std::size_t i : beside) {
      if (!Escape(i)) continue;
      Settle();
      any = true;
    }
    return any;
  }

  [[nodiscard]] std::size_t Worst(std::size_t from, std::size_t to) const {
    std::size_t worst = from;
    for (std::size_t i = from; i < to; ++i) worst = poses_[i].cost > poses_[worst].cost ? i : worst;
    return worst;
  }

  // Of each of up to eight parts of the recording the pose of the lowest cost: what a person's limbs did at
  // another time is a likelier start than random angles.
  [[nodiscard]] std::vector<Vector> GoodPoses() const {
    constexpr std::size_t kMostParts = 8;
    const std::size_t size = std::max(kBlock, (solved_.size() + kMostParts - 1) / kMostParts);
    std::vector<Vector> good;
    for (std::size_t from = 0; from < solved_.size(); from += size) {
      std::size_t best = from;
      for (std::size_t i = from; i < std::min(from + size, solved_.size()); ++i)
        if (poses_[i].cost < poses_[best].cost) best = i;
      good.push_back(poses_[best].values);
    }
    return good;
  }

  bool Escape(std::size_t i) {
    SetFrame(i);
    return Replace(i, FindLowerPose(fit_, model_, options_, poses_[i], GoodPoses(), random_));
  }

  MarkerFit& fit_;
  const MultibodyModel& model_;
  const MarkerTrajectories& markers_;
  const IkOptions& options_;
  Random random_;
  std::vector<std::size_t> solved_;  // frames with markers; all other indices count these
  std::size_t anchor_ = 0;
  std::vector<MarkerFit::Solution> poses_;
  std::vector<bool> redone_;
  std::vector<bool> from_previous_;  // whether the frame is still to be tried from that neighbour
  std::vector<bool> from_next_;
  int done_ = 0;
};

}  // namespace

FramePoses SolveFrames(MarkerFit& fit, const MultibodyModel& model, const MarkerTrajectories& markers,
                       const IkOptions& options) {
  return Passes(fit, model, markers, options).Run();
}

}  // namespace sinew
