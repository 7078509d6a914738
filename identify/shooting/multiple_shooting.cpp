#include "identify/shooting/multiple_shooting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/decompositions.h"

namespace sinew::shooting {
namespace {

constexpr double kFirstPenalty = 1;     // a gap that a window's samples just resolve costs as much as noise
constexpr double kPenaltyGrowth = 100;  // from one round to the next
constexpr int kRounds = 7;
constexpr int kMaxIterations = 30;  // of a round
constexpr double kEnough = 1e-3;    // relative decrease at which a round ends
constexpr double kAlmost = 1e-8;    // the same of the last round
constexpr double kRounding = 1e-9;  // of what a typical state predicts
constexpr double kHeld = 1e10;      // weight of a component that does not change
constexpr double kFirstDamping = 1e-3;
constexpr double kSmallDamping = 1e-5;  // too small to hide what could still be gained
constexpr double kMinDamping = 1e-12;
constexpr double kMaxDamping = 1e8;

// Where a parameter lies in the search, which steps by ratios where its scale is logarithmic.
double Forth(const Parameter& p, double value) {
  return p.scale == Scale::kLog ? std::log(value) : value;
}
double Back(const Parameter& p, double place) {
  return std::clamp(p.scale == Scale::kLog ? std::exp(place) : place, p.lower, p.upper);
}

// What is left of a window when its state is eliminated: its state from the next window's and the parameters.
struct Eliminated {
  Matrix own;     // [n x n] upper triangular
  Matrix next;    // [n x n]
  Matrix shared;  // [n x p]
  Vector right;   // [n]
};

Window WindowOf(const Arc& arc, std::size_t w);

class Search {
 public:
  Search(const Model& model, const std::vector<Arc>& arcs, const std::vector<Parameter>& all,
         const std::vector<int>& free, const Vector& parameters, std::vector<Matrix> states)
      : model_(model),
        arcs_(arcs),
        all_(all),
        free_(free),
        n_(model.states()),
        p_(static_cast<Eigen::Index>(free.size())) {
    solution_.parameters = parameters;
    solution_.states = std::move(states);
    for (const Arc& arc : arcs) {
      shots_.emplace_back(arc.windows());
      trial_shots_.emplace_back(arc.windows());
      eliminated_.emplace_back(arc.windows());
    }
  }

  Result<Solution> Run() {
    SINEW_TRY(ShootAll(solution_, true, shots_));
    SetUnit();
    // Without continuity first: it tells the noise and what the model cannot follow over one window.
    for (int round = -1; round < kRounds; ++round) {
      if (round <= 0) SetUnit();
      penalty_ = round < 0 ? 0 : kFirstPenalty * std::pow(kPenaltyGrowth, round);
      SINEW_TRY(Descend(round + 1 == kRounds ? kAlmost : kEnough));
      if (round < 0) solution_.free_misfit = Misfits();
    }
    solution_.cost = ResidualCost(shots_);
    solution_.largest_gap = LargestGap();
    solution_.misfit = Misfits();
    double rows = 0;
    for (const auto& arc : shots_) {
      for (const Shot& shot : arc) rows += static_cast<double>(shot.residual.size());
    }
    solution_.residual_rms = std::sqrt(2 * solution_.cost / std::max(rows, 1.0));
    return std::move(solution_);
  }

 private:
  using Shots = std::vector<std::vector<Shot>>;

  Status ShootAll(const Solution& at, bool derivatives, Shots& shots) const {
    for (std::size_t a = 0; a < shots.size(); ++a) {
      for (std::size_t w = 0; w < shots[a].size(); ++w)
        SINEW_TRY(model_.Shoot(WindowOf(arcs_[a], w), at.parameters,
                               at.states[a].col(static_cast<Eigen::Index>(w)), free_, derivatives,
                               shots[a][w]));
    }
    return {};
  }

  [[nodiscard]] static double ResidualCost(const Shots& shots) {
    double cost = 0;
    for (const auto& arc : shots) {
      for (const Shot& shot : arc) cost += 0.5 * shot.residual.squaredNorm();
    }
    return cost;
  }

  // The noise of a residual, and a square root of the metric of gaps.
  void SetUnit() {
    double sum = 0;
    double rows = 0;
    double windows = 0;
    double typical = 0;
    Matrix information = Matrix::Zero(n_, n_);
    for (const auto& arc : shots_) {
      for (const Shot& shot : arc) {
        sum += shot.residual.squaredNorm();
        rows += static_cast<double>(shot.residual.size());
        typical += (shot.by_state * model_.TypicalState()).squaredNorm();
        information += shot.by_state.transpose() * shot.by_state;
        ++windows;
      }
    }
    // Exact data have no noise; rounding is a floor.
    const double floor = kRounding * kRounding * typical / std::max(rows, 1.0);
    unit_ = std::sqrt(std::max({sum / std::max(rows, 1.0), floor, 1e-200}));
    information /= windows * unit_ * unit_;
    information.diagonal() += model_.TypicalState().cwiseAbs2().cwiseInverse();
    const Vector scale = information.diagonal().cwiseSqrt();
    Matrix unit = scale.cwiseInverse().asDiagonal() * information * scale.cwiseInverse().asDiagonal();
    unit.diagonal().array() += 1e-12;
    const Eigen::LLT<Matrix> factor(unit);
    metric_ = factor.matrixU();
    metric_ = metric_ * scale.asDiagonal();
  }

  [[nodiscard]] std::vector<double> Misfits() const {
    std::vector<double> misfits;
    for (const auto& arc : shots_) {
      double sum = 0;
      double typical = 0;
      for (const Shot& shot : arc) {
        sum += shot.residual.squaredNorm();
        typical += (shot.by_state * model_.TypicalState()).squaredNorm();
      }
      misfits.push_back(typical > 0 ? std::sqrt(sum / typical) : 0);
    }
    return misfits;
  }

  [[nodiscard]] Vector Gap(const Solution& at, const Shots& shots, std::size_t a, std::size_t w) const {
    return metric_ * (shots[a][w].end - at.states[a].col(static_cast<Eigen::Index>(w) + 1));
  }

  [[nodiscard]] double LargestGap() const {
    double largest = 0;
    for (std::size_t a = 0; a < shots_.size(); ++a) {
      for (std::size_t w = 0; w + 1 < shots_[a].size(); ++w)
        largest = std::max(largest, Gap(solution_, shots_, a, w).norm());
    }
    return largest;
  }

  // Half the sum of squares of residuals and gaps, in units of the noise.
  [[nodiscard]] double Cost(const Solution& at, const Shots& shots) const {
    double cost = ResidualCost(shots) / (unit_ * unit_);
    for (std::size_t a = 0; a < shots.size(); ++a) {
      for (std::size_t w = 0; w + 1 < shots[a].size(); ++w)
        cost += 0.5 * penalty_ * Gap(at, shots, a, w).squaredNorm();
    }
    return cost;
  }

  // d parameter / d place in the search.
  [[nodiscard]] double Slope(Eigen::Index k) const {
    const int index = free_[static_cast<std::size_t>(k)];
    return all_[static_cast<std::size_t>(index)].scale == Scale::kLog ? solution_.parameters[index] : 1;
  }

  Status Descend(double enough) {
    double damping = kFirstDamping;
    double cost = Cost(solution_, shots_);
    for (int iteration = 0; iteration < kMaxIterations && damping <= kMaxDamping; ++iteration) {
      Solution next = Stepped(damping);
      bool better = bool(ShootAll(next, false, trial_shots_));
      const double reached = better ? Cost(next, trial_shots_) : 0;
      better = better && reached < cost;
      if (!better) {
        damping = std::max(8 * damping, 1e-6);
        continue;
      }
      const double gained = (cost - reached) / cost;
      solution_ = std::move(next);
      SINEW_TRY(ShootAll(solution_, true, shots_));
      cost = reached;
      damping = std::max(0.1 * damping, kMinDamping);
      if (gained < enough && damping <= kSmallDamping) break;
    }
    return {};
  }

  // One step with that damping.
  [[nodiscard]] Solution Stepped(double damping) {
    Vector slopes(p_);
    for (Eigen::Index k = 0; k < p_; ++k) slopes[k] = Slope(k);
    std::vector<Matrix> of_parameters;
    Vector lengths = Vector::Zero(p_);
    for (std::size_t a = 0; a < shots_.size(); ++a)
      of_parameters.push_back(Eliminate(a, damping, slopes, lengths));
    Eigen::Index rows = p_;
    for (const Matrix& m : of_parameters) rows += m.rows();
    Matrix whole = Matrix::Zero(rows, p_ + 1);
    Eigen::Index row = 0;
    for (const Matrix& m : of_parameters) {
      whole.middleRows(row, m.rows()) = m;
      row += m.rows();
    }
    Vector shared = Vector::Zero(p_);
    if (p_ > 0) {
      const Vector scale = lengths.cwiseSqrt().cwiseMax(1e-150);
      Matrix left = whole.leftCols(p_) * scale.cwiseInverse().asDiagonal();
      for (Eigen::Index k = 0; k < p_; ++k) left(row + k, k) = std::sqrt(damping);
      const Vector right = whole.col(p_);
      shared = Eigen::ColPivHouseholderQR<Matrix>(left).solve(right).cwiseQuotient(scale);
    }
    Solution next = solution_;
    for (Eigen::Index k = 0; k < p_; ++k) {
      const int index = free_[static_cast<std::size_t>(k)];
      const Parameter& p = all_[static_cast<std::size_t>(index)];
      next.parameters[index] = Back(p, Forth(p, solution_.parameters[index]) + shared[k]);
      shared[k] = Forth(p, next.parameters[index]) - Forth(p, solution_.parameters[index]);
    }
    for (std::size_t a = 0; a < shots_.size(); ++a) {
      Vector later = Vector::Zero(n_);
      for (std::size_t w = shots_[a].size(); w-- > 0;) {
        const Eliminated& e = eliminated_[a][w];
        Vector right = e.right - e.shared * shared;
        if (w + 1 < shots_[a].size()) right -= e.next * later;
        later = e.own.triangularView<Eigen::Upper>().solve(right);
        next.states[a].col(static_cast<Eigen::Index>(w)) += later;
      }
    }
    return next;
  }

  // Eliminates the states of an arc from first to last. @return rows [. x p + 1] that only the parameters
  // enter. @param lengths gets the squared columns of the parameters, before elimination
  Matrix Eliminate(std::size_t a, double damping, const Vector& slopes, Vector& lengths) {
    Matrix carried(0, n_ + p_ + 1);
    const double root = std::sqrt(penalty_);
    for (std::size_t w = 0; w < shots_[a].size(); ++w) {
      const Shot& shot = shots_[a][w];
      const bool last = w + 1 == shots_[a].size();
      const bool joined = !last && penalty_ > 0;
      const Eigen::Index m = shot.residual.size();
      const Eigen::Index gaps = joined ? n_ : 0;
      const Eigen::Index columns = 2 * n_ + p_ + 1;  // own state, next state, parameters, right side
      std::vector<Eigen::Index> known;               // components that do not change
      for (Eigen::Index i = 0; w == 0 && arcs_[a].begins.front() == 0 && i < n_; ++i) {
        if (model_.IsKnown(arcs_[a].trial, static_cast<int>(i))) known.push_back(i);
      }
      Matrix rows =
          Matrix::Zero(carried.rows() + m + gaps + n_ + static_cast<Eigen::Index>(known.size()), columns);
      rows.topLeftCorner(carried.rows(), n_) = carried.leftCols(n_);
      rows.block(0, 2 * n_, carried.rows(), p_ + 1) = carried.rightCols(p_ + 1);
      Eigen::Index at = carried.rows();
      rows.block(at, 0, m, n_) = shot.by_state / unit_;
      rows.block(at, 2 * n_, m, p_) = shot.by_parameter * slopes.asDiagonal() / unit_;
      rows.block(at, columns - 1, m, 1) = -shot.residual / unit_;
      // Without the gaps: their weight grows, and damping in their units would stop the search.
      lengths += rows.block(at, 2 * n_, m, p_).colwise().squaredNorm().transpose();
      at += m;
      if (joined) {
        const Matrix weight = root * metric_;
        rows.block(at, 0, n_, n_) = weight * shot.end_by_state;
        rows.block(at, n_, n_, n_) = -weight;
        rows.block(at, 2 * n_, n_, p_) = weight * shot.end_by_parameter * slopes.asDiagonal();
        rows.block(at, columns - 1, n_, 1) = -root * Gap(solution_, shots_, a, w);
        at += n_;
      }
      // Damping of the state in the metric of the gaps: finite where the window says nothing about it.
      rows.block(at, 0, n_, n_) = std::sqrt(damping) * metric_;
      at += n_;
      for (const Eigen::Index i : known) rows(at++, i) = kHeld * (rows.col(i).norm() + metric_.norm());
      const Eigen::HouseholderQR<Matrix> qr(rows);
      const Matrix& packed = qr.matrixQR();
      Matrix upper = packed.topRows(std::min(packed.rows(), columns));
      for (Eigen::Index c = 0; c < columns; ++c) {
        for (Eigen::Index r = c + 1; r < upper.rows(); ++r) upper(r, c) = 0;
      }
      Eliminated& e = eliminated_[a][w];
      e.own = upper.topLeftCorner(n_, n_);
      e.next = upper.block(0, n_, n_, n_);
      e.shared = upper.block(0, 2 * n_, n_, p_);
      e.right = upper.block(0, columns - 1, n_, 1);
      // The last of these rows is what no step changes, and is not needed.
      const Eigen::Index left = std::max<Eigen::Index>(0, std::min(upper.rows(), columns - 1) - n_);
      carried = upper.block(n_, n_, left, n_ + p_ + 1);
    }
    // After the last window the columns of its successor are zero.
    return carried.rightCols(p_ + 1);
  }

  const Model& model_;
  const std::vector<Arc>& arcs_;
  const std::vector<Parameter>& all_;
  const std::vector<int>& free_;
  Eigen::Index n_;
  Eigen::Index p_;
  Solution solution_;
  Shots shots_;
  Shots trial_shots_;
  std::vector<std::vector<Eliminated>> eliminated_;
  double unit_ = 1;
  double penalty_ = 0;
  Matrix metric_;
};

Window WindowOf(const Arc& arc, std::size_t w) {
  return {arc.trial, arc.begins[w], arc.EndOf(w), !arc.IsLast(w)};
}

// The state at a window's begin from its own samples, held to a guess by a little.
Vector Corrected(const Model& model, const Window& window, const Vector& parameters, Vector guess,
                 Shot& shot) {
  constexpr int kIterations = 4;
  constexpr double kTrust = 0.05;  // in the guess: deviation of a sample, of what a typical state predicts
  const Vector typical = model.TypicalState();
  const Vector before = guess;
  double cost = std::numeric_limits<double>::infinity();
  double unit = 0;
  Vector best = guess;
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    if (!model.Shoot(window, parameters, guess, {}, true, shot)) break;
    const Matrix slopes = shot.by_state * typical.asDiagonal();
    if (iteration == 0)
      unit = kTrust * std::max(slopes.norm() / std::sqrt(std::max(1.0, double(slopes.rows()))), 1e-150);
    const Vector off = (guess - before).cwiseQuotient(typical);
    const double reached = shot.residual.squaredNorm() / (unit * unit) + off.squaredNorm();
    if (!(reached < cost)) break;
    cost = reached;
    best = guess;
    Matrix rows(slopes.rows() + slopes.cols(), slopes.cols());
    rows << slopes / unit, Matrix::Identity(slopes.cols(), slopes.cols());
    Vector right(rows.rows());
    right << -shot.residual / unit, -off;
    const Eigen::ColPivHouseholderQR<Matrix> qr(rows);
    guess += typical.cwiseProduct(Vector(qr.solve(right)));
  }
  return best;
}

}  // namespace

void Shot::Prepare(Eigen::Index m, Eigen::Index n, Eigen::Index p, bool joined, bool derivatives) {
  residual.resize(m);
  end.resize(joined ? n : 0);
  if (!derivatives) return;
  by_state.setZero(m, n);
  by_parameter.setZero(m, p);
  end_by_state.setZero(joined ? n : 0, n);
  end_by_parameter.setZero(joined ? n : 0, p);
}

bool Shot::IsFinite() const {
  return residual.allFinite() && end.allFinite() && by_state.allFinite() && by_parameter.allFinite() &&
         end_by_state.allFinite() && end_by_parameter.allFinite();
}

Result<Solution> Solve(const Model& model, const std::vector<Arc>& arcs, const std::vector<Parameter>& all,
                       const std::vector<int>& free, const Vector& parameters) {
  SINEW_ASSIGN(auto states, TrackedStates(model, arcs, parameters));
  return Search(model, arcs, all, free, parameters, std::move(states)).Run();
}

Result<std::vector<Matrix>> TrackedStates(const Model& model, const std::vector<Arc>& arcs,
                                          const Vector& parameters) {
  std::vector<Matrix> all;
  Shot shot;
  Vector reached;  // where the window before ended
  for (std::size_t a = 0; a < arcs.size(); ++a) {
    const Arc& arc = arcs[a];
    const bool goes_on =
        a + 1 < arcs.size() && arcs[a + 1].trial == arc.trial && arcs[a + 1].begins.front() == arc.end;
    const bool follows = a > 0 && arcs[a - 1].trial == arc.trial && arcs[a - 1].end == arc.begins.front();
    Matrix states(model.states(), static_cast<Eigen::Index>(arc.windows()));
    for (std::size_t w = 0; w < arc.windows(); ++w) {
      Vector state = model.MeasuredState(arc.trial, arc.begins[w]);
      if (!state.allFinite()) {
        if (w == 0 && !follows) return Fail("no state is known where an arc begins");
        for (Eigen::Index i = 0; i < state.size(); ++i) {
          if (!std::isfinite(state[i])) state[i] = reached[i];
        }
        state = Corrected(model, WindowOf(arc, w), parameters, state, shot);
      }
      states.col(static_cast<Eigen::Index>(w)) = state;
      if (arc.IsLast(w) && !goes_on) continue;
      if (model.MeasuredState(arc.trial, arc.EndOf(w)).allFinite()) continue;
      Window window = WindowOf(arc, w);
      window.joined = true;
      SINEW_TRY(model.Shoot(window, parameters, state, {}, false, shot));
      reached = shot.end;
    }
    all.push_back(std::move(states));
  }
  return all;
}

}  // namespace sinew::shooting
