#include "problems/nms/excitation/search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>

#include "problems/nms/excitation/free_muscle.h"

namespace sinew {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kHalfway = 0.5;
constexpr double kNoForce = 1e-6;  // of the greatest isometric force

bool IsAmong(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The free muscles of a trial in one frame.
class MusclesOfFrame final : public FrameMuscles {
 public:
  [[nodiscard]] Result<ForceAt> Force(int muscle, double excitation) const override {
    return muscles[static_cast<std::size_t>(muscle)]->Force(excitation);
  }
  std::vector<std::unique_ptr<FreeMuscle>> muscles;
};

class TrialSearch {
 public:
  TrialSearch(const NmsProblem& problem, const Vector& parameters, const NmsMode& mode,
              const FreeMuscles& free, std::size_t trial, const FrameWatcher& watch)
      : problem_(problem),
        data_(problem.data()),
        mode_(mode),
        trial_index_(trial),
        trial_(data_.trials[trial]),
        watch_(watch),
        parts_(problem.PartsAt(parameters, trial)),
        count_(data_.muscles.size()) {
    for (const std::string& muscle : data_.muscles) {
      synthesised_.push_back(IsAmong(free.synthesised, muscle));
      free_.push_back(synthesised_.back() || IsAmong(free.adjusted, muscle));
    }
  }

  Result<FoundExcitations> Run() {
    const auto begun = std::chrono::steady_clock::now();
    SINEW_TRY(Prepare());
    for (std::size_t i = 0; i < trial_.time.size(); ++i) SINEW_TRY(Search(i));
    out_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    return std::move(out_);
  }

  /// What to excite a free muscle with; the times at which it is sent.
  [[nodiscard]] bool is_free(std::size_t muscle) const { return free_[muscle]; }
  [[nodiscard]] const ActingExcitations& acting(std::size_t muscle) const { return acting_[muscle]; }

 private:
  Status Prepare() {
    out_.trial = trial_.name;
    out_.time = trial_.time;
    const auto frames = static_cast<Eigen::Index>(trial_.time.size());
    out_.objective.setZero(frames);
    out_.gap.setZero(frames);
    out_.slack.assign(count_, 0);
    traces_.resize(count_);
    acting_.resize(count_);
    for (std::size_t m = 0; m < count_; ++m) {
      // Of a free muscle the trace is the motion of its fibre, which with a rigid tendon no excitation moves.
      const bool wanted = !free_[m] || problem_.settings().model.tendon == TendonMode::kRigid;
      const Status status = wanted ? ComputeMuscleForce(problem_.curves(), problem_.settings().model,
                                                        parts_.slots[m], trial_.muscles[m], traces_[m])
                                   : Status();
      if (!status) return Fail("{}: {}", data_.muscles[m], status.error().message);
      acting_[m] = ActAtFrames(problem_.settings().model, parts_.slots[m], trial_.muscles[m]);
      const double* first = acting_[m].value.data() + acting_[m].frames_from;
      out_.excitation.emplace_back(Eigen::Map<const Vector>(first, frames));
      out_.measured.push_back(synthesised_[m] ? Vector() : out_.excitation.back());
      if (!free_[m]) continue;
      index_.push_back(m);
      muscles_.muscles.push_back(std::make_unique<FreeMuscle>(problem_.curves(), problem_.settings().model,
                                                              parts_.slots[m], trial_.muscles[m], acting_[m],
                                                              traces_[m]));
    }
    return PrepareJoints();
  }

  // The moments to follow, less those that the free muscles do not make.
  Status PrepareJoints() {
    const std::size_t joints = data_.joint_muscles.size();
    for (std::size_t j = 0; j < joints; ++j) {
      const Block& block = data_.layout[static_cast<std::size_t>(trial_.first_block) + j];
      Vector moment = Vector::Constant(static_cast<Eigen::Index>(trial_.time.size()), kNone);
      const std::string& joint = problem_.settings().joints[j];
      const bool asked = IsAmong(mode_.joints, joint);
      if (asked && block.measured.empty()) return Fail("the moment of '{}' is not measured", joint);
      if (mode_.joints.empty() || asked) {
        for (std::size_t k = 0; k < block.measured.size(); ++k) moment[block.sample[k]] = block.measured[k];
      }
      moment -= parts_.beyond[j];
      for (std::size_t k = 0; k < data_.joint_muscles[j].size(); ++k) {
        const auto m = static_cast<std::size_t>(data_.joint_muscles[j][k]);
        if (free_[m]) continue;
        moment -= parts_.arms[j][k].cwiseProduct(
            Eigen::Map<const Vector>(traces_[m].tendon_force.data(), moment.size()));
      }
      moments_.push_back(std::move(moment));
    }
    return {};
  }

  void Place(std::size_t i) {
    const auto n = static_cast<Eigen::Index>(index_.size());
    const auto joints = static_cast<Eigen::Index>(moments_.size());
    frame_.weights = mode_.weights;
    frame_.moment.setZero(joints);
    frame_.arms.setZero(joints, n);
    frame_.measured.setConstant(n, kNone);
    bool followed = false;
    const auto at = static_cast<Eigen::Index>(i);
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
      const auto j = static_cast<std::size_t>(joint);
      if (std::isnan(moments_[j][at])) continue;
      followed = true;
      frame_.moment[joint] = moments_[j][at];
      for (std::size_t k = 0; k < data_.joint_muscles[j].size(); ++k) {
        const auto m = static_cast<std::size_t>(data_.joint_muscles[j][k]);
        if (!free_[m]) continue;
        const auto place = std::find(index_.begin(), index_.end(), m) - index_.begin();
        frame_.arms(joint, place) = parts_.arms[j][k][at];
      }
    }
    out_.followed += followed ? 1 : 0;
    for (Eigen::Index k = 0; k < n; ++k) {
      const std::size_t m = index_[static_cast<std::size_t>(k)];
      if (!synthesised_[m]) frame_.measured[k] = out_.measured[m][at];
    }
  }

  // From the measured excitations, from those of the frame before, and from none at all. A fibre may need
  // much excitation before a slack tendon transmits force: then halfway too.
  [[nodiscard]] std::vector<Vector> Starts() const {
    std::vector<Vector> starts{frame_.measured.array().isNaN().select(0, frame_.measured)};
    if (last_.size() == starts[0].size()) starts.push_back(last_);
    if (starts[0].any()) starts.emplace_back(Vector::Zero(starts[0].size()));
    if (problem_.settings().model.tendon == TendonMode::kElastic)
      starts.emplace_back(Vector::Constant(starts[0].size(), kHalfway));
    return starts;
  }

  Status CountSlack() {
    if (problem_.settings().model.tendon != TendonMode::kElastic) return {};
    for (std::size_t k = 0; k < index_.size(); ++k) {
      const auto& numbers = parts_.slots[index_[k]];
      SINEW_ASSIGN(const ForceAt least, muscles_.Force(static_cast<int>(k), 0));
      SINEW_ASSIGN(const ForceAt most, muscles_.Force(static_cast<int>(k), 1));
      if (most.force - least.force < kNoForce * numbers[kIsometricForce] * numbers[kStrength])
        ++out_.slack[index_[k]];
    }
    return {};
  }

  // Solves a frame and passes its excitations on.
  Status Search(std::size_t i) {
    Place(i);
    const auto n = static_cast<Eigen::Index>(index_.size());
    const auto found = SearchFrame(frame_, muscles_, Starts());
    const Status counted = CountSlack();
    if (!found || !counted) {
      return Fail("t = {:.4g} s: {}", trial_.time[i],
                  found ? counted.error().message : found.error().message);
    }
    const FrameSolution& best = *found;
    out_.unsettled += best.converged ? 0 : 1;
    if (watch_) watch_(trial_index_, i, frame_, muscles_, best);
    last_ = best.excitation;
    double objective = best.objective;
    const auto at = static_cast<Eigen::Index>(i);
    for (std::size_t m = 0; m < count_; ++m) {
      if (!free_[m]) objective += mode_.weights.beta * out_.excitation[m][at] * out_.excitation[m][at];
    }
    out_.objective[at] = objective;
    out_.gap[at] = best.gap;
    for (Eigen::Index k = 0; k < n; ++k) {
      const std::size_t m = index_[static_cast<std::size_t>(k)];
      const auto force = muscles_.muscles[static_cast<std::size_t>(k)]->Choose(last_[k]);
      if (!force)
        return Fail("{}: t = {:.4g} s: {}", data_.muscles[m], trial_.time[i], force.error().message);
      out_.excitation[m][at] = last_[k];
      acting_[m].value[acting_[m].frames_from + i] = last_[k];
    }
    return {};
  }

  const NmsProblem& problem_;
  const NmsData& data_;
  const NmsMode& mode_;
  std::size_t trial_index_;
  const NmsTrial& trial_;
  const FrameWatcher& watch_;
  NmsParts parts_;
  std::size_t count_;
  std::vector<bool> free_;
  std::vector<bool> synthesised_;
  std::vector<std::size_t> index_;  // [free muscles] into the muscles
  std::vector<MuscleTrace<double>> traces_;
  std::vector<ActingExcitations> acting_;
  std::vector<Vector> moments_;  // [joints] [N, N m]; NaN: not followed
  MusclesOfFrame muscles_;
  ExcitationFrame frame_;
  Vector last_;
  FoundExcitations out_;
};

Status CheckModel(const NmsProblem& problem, const Vector& parameters) {
  if (problem.settings().model.tendon == TendonMode::kEquilibrium) {
    return Fail(
        "tendon: equilibrium takes the fibre's velocity from later frames too, so no excitation can be found "
        "frame by frame: expected tendon: rigid or elastic");
  }
  for (std::size_t t = 0; t < problem.data().trials.size(); ++t) {
    const NmsParts parts = problem.PartsAt(parameters, t);
    for (std::size_t m = 0; m < parts.slots.size(); ++m) {
      for (int slot = kEmgGain; slot <= kCrossTalk; ++slot) {
        if (parts.slots[m][static_cast<std::size_t>(slot)] == 0) continue;
        return Fail(
            "muscle '{}': an effect on its measured excitation is not at 0: only the open loop has it",
            problem.data().muscles[m]);
      }
      if (parts.slots[m][kTendonCompliance] == 0) continue;
      return Fail("muscle '{}': its tendon_compliance is not at 0: expected tendon: elastic in its place",
                  problem.data().muscles[m]);
    }
  }
  return {};
}

}  // namespace

Result<std::vector<FoundExcitations>> FindExcitations(NmsProblem& problem, const Vector& parameters,
                                                      const NmsMode& mode, const FreeMuscles& free,
                                                      const FrameWatcher& watch) {
  SINEW_TRY(CheckModel(problem, parameters));
  std::vector<FoundExcitations> all;
  for (std::size_t t = 0; t < problem.data().trials.size(); ++t) {
    TrialSearch search(problem, parameters, mode, free, t, watch);
    auto found = search.Run();
    if (!found) return Fail("trial '{}': {}", problem.data().trials[t].name, found.error().message);
    all.push_back(std::move(*found));
    for (std::size_t m = 0; m < problem.data().muscles.size(); ++m) {
      if (search.is_free(m)) problem.Excite(t, m, search.acting(m).time, search.acting(m).value);
    }
  }
  return all;
}

}  // namespace sinew
